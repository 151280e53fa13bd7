// A file, or a text, to a Document.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include "config/compile.h"
#include "config/places.h"
#include "config/reader.h"
#include "config/yaml_tree.h"

namespace hapticd::config {
namespace {

/// FNV-1a, 64 bits (Fowler, Noll, Vo): tells texts apart, and is no protection against forgery.
std::string digest_of(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3U;
  }
  constexpr std::string_view digits = "0123456789abcdef";
  std::string written(16, '0');
  for (std::size_t i = 16; i-- > 0; hash >>= 4U) written[i] = digits[hash & 15U];
  return written;
}

tl::unexpected<std::vector<ConfigError>> unreadable(const std::string& path, ExitCode code,
                                                    std::string message) {
  return tl::unexpected(
      std::vector{ConfigError{.file = path, .message = std::move(message), .code = code}});
}

tl::unexpected<std::vector<ConfigError>> system_error(const std::string& path, int number) {
  const std::string reason = std::strerror(number);
  if (number == EACCES || number == EPERM) {
    return unreadable(path, ExitCode::no_permission,
                      "cannot read the config: " + reason + "; who may read it, shows ls -l");
  }
  return unreadable(path, ExitCode::no_input, "cannot read the config: " + reason);
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

/// The text of a file; of one that is too long, just enough to see that. Pipes are read as well.
Checked<std::string> text_of(const std::string& path) {
  const OpenFile file(path);
  struct stat status {};
  if (file.descriptor() < 0 || ::fstat(file.descriptor(), &status) != 0)
    return system_error(path, errno);
  if (S_ISDIR(status.st_mode)) {
    return unreadable(path, ExitCode::no_input,
                      "expected a config file, found a directory; name the file in it");
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

void sort_by_place(std::vector<ConfigError>& errors) {
  std::stable_sort(errors.begin(), errors.end(), [](const ConfigError& a, const ConfigError& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
}

}  // namespace

Checked<Document> read_text(std::string text, const std::string& path) {
  YamlText yaml = parse_yaml(text, path);
  if (!yaml.sound) return tl::unexpected(std::move(yaml.errors));
  Reading reading(path);
  reading.errors = std::move(yaml.errors);
  Document document{.path = path, .text = std::move(text)};
  read_value(reading, yaml.root, "", Key{}, document.config);
  if (!reading.errors.empty()) {
    sort_by_place(reading.errors);
    return tl::unexpected(std::move(reading.errors));
  }
  document.digest = digest_of(document.text);
  document.places = std::make_shared<const Places>(std::move(reading.places));
  return document;
}

Checked<Document> read_file(const std::string& path) {
  return text_of(path).and_then([&](std::string text) { return read_text(std::move(text), path); });
}

}  // namespace hapticd::config
