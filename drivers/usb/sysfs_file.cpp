#include "drivers/usb/sysfs_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <climits>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace hapticd::usb::sysfs {
namespace {

/// A page, the most that an attribute of text has.
constexpr std::size_t kMostText = 4096;
constexpr std::size_t kMostNames = 4096;

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

}  // namespace

std::vector<std::uint8_t> bytes_of(const std::string& file, std::size_t most) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return {};
  std::vector<std::uint8_t> bytes(most);
  std::size_t size = 0;
  while (size < most) {
    const ssize_t got = ::read(descriptor, bytes.data() + size, most - size);
    if (got <= 0) break;
    size += static_cast<std::size_t>(got);
  }
  ::close(descriptor);
  bytes.resize(size);
  return bytes;
}

std::vector<std::string> lines_of(const std::string& file) {
  std::vector<std::string> lines(1);
  for (const std::uint8_t byte : bytes_of(file, kMostText)) {
    if (byte == '\n')
      lines.emplace_back();
    else
      lines.back() += byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '?';
  }
  return lines;
}

std::string text_of(const std::string& file) {
  return trimmed(lines_of(file).front());
}

std::optional<std::uint32_t> number_in(const std::string& text, int base, std::uint32_t most) {
  std::uint32_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number, base);
  if (error != std::errc{} || stop != end || number > most) return {};
  return number;
}

std::optional<std::uint32_t> number_of(const std::string& file, int base, std::uint32_t most) {
  return number_in(text_of(file), base, most);
}

std::vector<std::string> names_in(const std::string& directory) {
  std::vector<std::string> names;
  std::error_code error;
  std::filesystem::directory_iterator entry(directory, error);
  for (; !error && entry != std::filesystem::directory_iterator{}; entry.increment(error)) {
    if (names.size() == kMostNames) break;
    names.push_back(entry->path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

std::string real_path(const std::string& path) {
  char* const found = ::realpath(path.c_str(), nullptr);
  if (found == nullptr) return {};
  std::string text(found);
  std::free(found);
  return text;
}

std::string name_of(const std::string& path) {
  return path.substr(path.find_last_of('/') + 1);
}

std::string parent_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? std::string{} : path.substr(0, slash);
}

}  // namespace hapticd::usb::sysfs
