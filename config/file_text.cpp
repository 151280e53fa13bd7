#include "config/file_text.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "config/text_check.h"
#include "config/yaml_tree.h"

namespace hapticd::config {
namespace {

tl::unexpected<std::vector<ConfigError>> unreadable(const std::string& path, ExitCode code,
                                                    std::string message) {
  return tl::unexpected(
      std::vector{ConfigError{.file = path, .message = std::move(message), .code = code}});
}

tl::unexpected<std::vector<ConfigError>> system_error(const std::string& path, int number) {
  const std::string reason = std::strerror(number);
  if (number == EACCES || number == EPERM) {
    return unreadable(path, ExitCode::no_permission,
                      "cannot read this file: " + reason + "; who may read it, shows ls -l");
  }
  return unreadable(path, ExitCode::no_input, "cannot read this file: " + reason);
}

/// Closes on every way out.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

}  // namespace

Checked<std::string> file_text(const std::string& path) {
  const OpenFile file(path);
  struct stat status {};
  if (file.descriptor() < 0 || ::fstat(file.descriptor(), &status) != 0)
    return system_error(path, errno);
  if (S_ISDIR(status.st_mode)) {
    return unreadable(path, ExitCode::no_input,
                      "expected a file, found a directory; name the file in it");
  }
  std::string text;
  std::array<char, 16384> block{};
  while (text.size() <= kMaxTextBytes) {
    const ssize_t count = ::read(file.descriptor(), block.data(), block.size());
    if (count == 0) break;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return system_error(path, errno);
    text.append(block.data(), static_cast<std::size_t>(count));
  }
  return text;
}

}  // namespace hapticd::config
