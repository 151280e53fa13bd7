#include "daemon/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

namespace hapticd::daemon {
namespace {

constexpr std::size_t kBufferBytes = 64 * 1024;
constexpr mode_t kMode = 0644;

}  // namespace

std::string errno_text(int reason) {
  return std::generic_category().message(reason);
}

OutputFile::OutputFile(int fd, std::string path) : fd_(fd), path_(std::move(path)) {
  buffer_.reserve(kBufferBytes);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      failed_(other.failed_),
      path_(std::move(other.path_)),
      written_(other.written_),
      buffer_(std::move(other.buffer_)) {}

OutputFile::~OutputFile() {
  if (fd_ < 0) return;
  try {
    (void)flush();
  } catch (...) {  // out of memory while wording an error that nobody reads
  }
  ::close(fd_);
}

Result<OutputFile> OutputFile::create(const std::string& path, IfExists if_exists) {
  const int existing = if_exists == IfExists::refuse ? O_EXCL : O_TRUNC;
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | existing, kMode);
  if (fd < 0) {
    const int reason = errno;
    const bool denied = reason == EACCES || reason == EPERM || reason == EROFS;
    return fail(denied ? ExitCode::no_permission : ExitCode::cannot_create,
                path + ": cannot be created: " + errno_text(reason));
  }
  return OutputFile(fd, path);
}

Result<void> OutputFile::write(const void* data, std::size_t size) {
  if (failed_ != 0) return give_up(failed_);
  const auto* bytes = static_cast<const std::byte*>(data);
  while (size > 0) {
    if (buffer_.size() == kBufferBytes) {
      if (auto flushed = flush(); !flushed) return flushed;
    }
    const std::size_t room = kBufferBytes - buffer_.size();
    const std::size_t part = size < room ? size : room;
    buffer_.insert(buffer_.end(), bytes, bytes + part);
    bytes += part;
    size -= part;
  }
  return {};
}

Result<void> OutputFile::flush() {
  if (failed_ != 0) return give_up(failed_);
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t got = ::write(fd_, buffer_.data() + done, buffer_.size() - done);
    if (got > 0) {
      done += static_cast<std::size_t>(got);
      written_ += static_cast<std::uint64_t>(got);
    } else if (got == 0 || errno != EINTR) {
      return give_up(got == 0 ? ENOSPC : errno);
    }
  }
  buffer_.clear();
  return {};
}

Result<void> OutputFile::close() {
  auto result = flush();
  // Some file systems tell only now that the disk is full. On Linux the descriptor is gone whatever
  // close() returns.
  if (fd_ >= 0 && ::close(std::exchange(fd_, -1)) != 0 && result && errno != EINTR)
    return give_up(errno);
  return result;
}

Result<void> OutputFile::give_up(int reason) {
  failed_ = reason;
  buffer_.clear();
  return fail(ExitCode::cannot_create, path_ + ": cannot be written: " + errno_text(reason));
}

Result<void> replace_file(const std::string& named, std::string_view text) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::file_status status = fs::status(named, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status))
    return fail(ExitCode::cannot_create, named + ": is not a regular file, and is left as it is");
  // A link stays one: what it leads to is replaced.
  const std::string path = fs::is_symlink(named, ignored) && fs::exists(status)
                               ? fs::canonical(named, ignored).string()
                               : named;
  const std::string draft = path + ".new";
  auto written =
      OutputFile::create(draft, IfExists::replace).and_then([&](OutputFile file) -> Result<void> {
        if (auto done = file.write(text); !done) return done;
        return file.close();
      });
  if (written && std::rename(draft.c_str(), path.c_str()) != 0)
    written = fail(ExitCode::cannot_create, path + ": cannot be written: " + errno_text(errno));
  if (!written) ::unlink(draft.c_str());
  return written;
}

}  // namespace hapticd::daemon
