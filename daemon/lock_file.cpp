#include "daemon/lock_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

namespace hapticd::daemon {
namespace {

/// What files of device locks are called, before the name.
const std::string kDeviceLock = "hapticd-device-";

/// The process id in a lock file, or words for not knowing it: the holder may not have written it
/// yet.
std::string holder(int fd) {
  char text[32] = {};
  const ssize_t got = ::pread(fd, text, sizeof(text) - 1, 0);
  const std::string digits(text, got > 0 ? std::min(std::strcspn(text, "\n"), sizeof(text)) : 0);
  const bool number =
      !digits.empty() && std::all_of(digits.begin(), digits.end(),
                                     [](unsigned char c) { return std::isdigit(c) != 0; });
  return number ? "pid " + digits : "pid not known";
}

/// Read-write if possible. O_NOFOLLOW: /run/lock is open to all, and a link there could point
/// anywhere.
int open_lock(const std::string& path) {
  const int flags = O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  int fd = ::open(path.c_str(), flags | O_RDWR | O_CREAT, 0644);
  if (fd < 0 && (errno == EACCES || errno == EROFS || errno == EPERM)) {
    const int first_error = errno;
    fd = ::open(path.c_str(), flags | O_RDONLY);
    if (fd < 0) errno = first_error;
  }
  return fd;
}

tl::unexpected<Error> cannot_lock(const std::string& path, const std::string& what, int error) {
  const bool right = error == EACCES || error == EPERM || error == EROFS;
  return fail(right ? ExitCode::no_permission : ExitCode::cannot_create,
              fmt::format("cannot lock {}: the lock file {} cannot be opened: {}", what, path,
                          std::strerror(error)));
}

}  // namespace

Result<LockFile> LockFile::acquire(const std::string& path, const std::string& what) {
  const int fd = open_lock(path);
  if (fd < 0) return cannot_lock(path, what, errno);
  LockFile lock(fd);
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return cannot_lock(path, what, errno);
    return fail(
        ExitCode::try_again,
        fmt::format(
            "another hapticd ({}) holds {} (lock file {}); stop it first, or use another one",
            holder(fd), what, path));
  }
  // Only a help for people: the lock holds whether or not the number can be written.
  const std::string pid = fmt::format("{}\n", ::getpid());
  if (::ftruncate(fd, 0) == 0) {
    [[maybe_unused]] const ssize_t written = ::pwrite(fd, pid.data(), pid.size(), 0);
  }
  return lock;
}

LockFile::LockFile(LockFile&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

LockFile& LockFile::operator=(LockFile&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

LockFile::~LockFile() {
  if (fd_ >= 0) ::close(fd_);
}

Result<std::vector<LockFile>> lock_device(const std::string& lock_name,
                                          const std::vector<std::string>& directories) {
  std::string file = lock_name;
  std::replace_if(
      file.begin(), file.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '.'; }, '_');
  std::vector<LockFile> locks;
  Error last{"no directory for lock files was given", ExitCode::cannot_create};
  for (const std::string& directory : directories) {
    auto lock = LockFile::acquire(directory + "/" + kDeviceLock + file + ".lock",
                                  "the device " + lock_name);
    if (lock) {
      locks.push_back(std::move(*lock));
    } else if (lock.error().code == ExitCode::try_again) {
      return tl::unexpected(lock.error());
    } else {
      last = lock.error();
    }
  }
  if (locks.empty()) return tl::unexpected(last);
  return locks;
}

namespace {

Result<void> lock_all(const std::vector<std::string>& names,
                      const std::vector<std::string>& directories, std::vector<LockFile>& locks) {
  for (const std::string& name : names) {
    auto more = lock_device(name, directories);
    if (!more) return tl::unexpected(more.error());
    std::ranges::move(*more, std::back_inserter(locks));
  }
  return {};
}

}  // namespace

Result<drivers::DeviceInfo> connect_locked(drivers::Device& device,
                                           const std::vector<std::string>& directories,
                                           std::vector<LockFile>& locks) {
  const std::vector<std::string> known = device.lock_names();
  std::vector<LockFile> held;
  if (auto locked = lock_all(known, directories, held); !locked)
    return tl::unexpected(locked.error());
  auto info = device.connect();
  if (!info) return info;
  if (known.empty()) {
    if (auto locked = lock_all(device.lock_names(), directories, held); !locked) {
      device.disconnect();
      return tl::unexpected(locked.error());
    }
  }
  std::ranges::move(held, std::back_inserter(locks));
  return info;
}

namespace {

/// Somebody else holds it, or it cannot be known.
bool may_be_locked(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (fd < 0) return errno != ENOENT;
  const bool free = ::flock(fd, LOCK_SH | LOCK_NB) == 0;
  ::close(fd);
  return !free;
}

}  // namespace

bool is_locked(const std::string& name_start, const std::vector<std::string>& directories) {
  for (const std::string& directory : directories) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
      if (!entry.path().filename().string().starts_with(kDeviceLock + name_start)) continue;
      if (may_be_locked(entry.path().string())) return true;
    }
    if (error && error != std::errc::no_such_file_or_directory) return true;
  }
  return false;
}

std::vector<std::string> device_lock_directories() {
  return {"/run/hapticd", "/run/lock"};
}

}  // namespace hapticd::daemon
