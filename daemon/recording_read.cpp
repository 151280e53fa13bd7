#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "daemon/file_descriptor.h"
#include "daemon/recording.h"

namespace hapticd::daemon {
namespace {

template <class T>
std::optional<T> parse(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Takes the text up to `separator` off `rest`; all of it where there is none.
std::string_view take(std::string_view& rest, char separator) {
  const std::size_t end = rest.find(separator);
  const std::string_view head = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return head;
}

/// Reads the header line by line. The first thing that is not as it should be stands in `error`;
/// nothing is believed before it was held against the size of the file, and nothing is copied but
/// what the file really holds.
class HeaderParser {
 public:
  explicit HeaderParser(std::string_view file) : file_(file), rest_(file) {}

  /// False: error() says why.
  bool parse_header(RecordingHeader& header) {
    return magic() && value("rate_Hz", header.rate_Hz) &&
           word("config_digest", header.config_digest) && value("config_bytes", config_bytes_) &&
           value("record_bytes", header.record_bytes) && fields(header.fields) &&
           value("header_bytes", header_bytes_) && end() && sound(header) &&
           config(header.config_text);
  }
  std::uint64_t header_bytes() const { return header_bytes_; }
  const std::string& error() const { return error_; }

 private:
  bool fail_with(const std::string& text) {
    error_ = "header line " + std::to_string(line_) + ": " + text;
    return false;
  }
  bool next_line(std::string_view& line) {
    ++line_;
    if (rest_.find('\n') == std::string_view::npos)
      return fail_with("the file ends within its header");
    line = take(rest_, '\n');
    return true;
  }
  bool magic() {
    std::string_view line;
    if (next_line(line) && line == "hapticd-recording 1") return true;
    constexpr std::string_view kMagic = "hapticd-recording ";
    if (line.substr(0, kMagic.size()) != kMagic) {
      error_ = "is not a hapticd recording: its first line is not 'hapticd-recording 1'";
      return false;
    }
    return fail_with("format version 1 is what this program reads, not '" +
                     std::string(line.substr(kMagic.size(), 20)) + "'");
  }
  bool keyed(std::string_view key, std::string_view& value) {
    std::string_view line;
    if (!next_line(line)) return false;
    if (take(line, ' ') != key) return fail_with("expected '" + std::string(key) + "'");
    value = line;
    return true;
  }
  template <class T>
  bool value(std::string_view key, T& into) {
    std::string_view text;
    if (!keyed(key, text)) return false;
    const std::optional<T> parsed = parse<T>(text);
    if (!parsed) return fail_with(std::string(key) + ": expected a number");
    into = *parsed;
    return true;
  }
  bool word(std::string_view key, std::string& into) {
    std::string_view text;
    if (!keyed(key, text)) return false;
    if (text.empty()) return fail_with(std::string(key) + ": expected a word");
    if (text != "-") into = text;
    return true;
  }
  bool fields(std::vector<Field>& into) {
    constexpr std::string_view kField = "field ";
    while (rest_.substr(0, kField.size()) == kField) {
      std::string_view line;
      if (!keyed("field", line)) return false;
      const std::string_view name = take(line, ' '), unit = take(line, ' '), type = take(line, ' ');
      const auto offset = parse<std::uint32_t>(line);
      if (!offset) return fail_with("expected 'field <name> <unit> <type> <offset>'");
      into.push_back({std::string(name), std::string(unit), std::string(type), *offset});
    }
    return true;
  }
  bool end() {
    std::string_view line;
    if (!next_line(line)) return false;
    return line == "end" || fail_with("expected 'end'");
  }
  bool config(std::string& into) {
    const std::uint64_t text_bytes = file_.size() - rest_.size();
    if (config_bytes_ > rest_.size()) return fail_with("the file ends within its config");
    if (header_bytes_ != (text_bytes + config_bytes_ + 7) / 8 * 8) {
      return fail_with("header_bytes does not fit: the header is " +
                       std::to_string((text_bytes + config_bytes_ + 7) / 8 * 8) + " bytes long");
    }
    if (header_bytes_ > file_.size()) return fail_with("the file ends within its header");
    into = rest_.substr(0, config_bytes_);
    return true;
  }
  bool sound(const RecordingHeader& header) {
    error_ = header_defect(header);
    if (!error_.empty()) error_ = "header: " + error_;
    return error_.empty();
  }

  std::string_view file_, rest_;
  std::uint64_t config_bytes_ = 0, header_bytes_ = 0;
  int line_ = 0;
  std::string error_;
};

tl::unexpected<Error> cannot_read(const std::string& path, int reason) {
  const bool denied = reason == EACCES || reason == EPERM;
  return fail(denied ? ExitCode::no_permission : ExitCode::no_input,
              path + ": cannot be read: " + errno_text(reason));
}

Result<std::vector<std::byte>> read_whole(const std::string& path) {
  // Non-blocking, for a named pipe without a writer would hold us here.
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat about {};
  if (!file.valid() || ::fstat(file.get(), &about) != 0) return cannot_read(path, errno);
  if (!S_ISREG(about.st_mode)) return fail(ExitCode::no_input, path + ": is not a regular file");
  std::vector<std::byte> bytes(static_cast<std::size_t>(about.st_size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(file.get(), bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return cannot_read(path, errno);
    if (got == 0) break;  // it was cut while being read
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

Result<Recording> parse_recording(const std::string& path, std::vector<std::byte> bytes) {
  Recording recording;
  HeaderParser parser({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!parser.parse_header(recording.header))
    return fail(ExitCode::bad_data, path + ": " + parser.error());
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(parser.header_bytes()));
  recording.torn_bytes = bytes.size() % recording.header.record_bytes;
  bytes.resize(bytes.size() - recording.torn_bytes);
  recording.data = std::move(bytes);
  return recording;
}

template <class T>
double widened(const std::byte* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

}  // namespace

Result<Recording> read_recording(const std::string& path) {
  try {
    auto bytes = read_whole(path);
    if (!bytes) return tl::unexpected(bytes.error());
    return parse_recording(path, std::move(*bytes));
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  return fail(ExitCode::try_again, path + ": does not fit into memory");
}

const Field* Recording::find(const std::string& name) const noexcept {
  for (const Field& field : header.fields) {
    if (field.name == name) return &field;
  }
  return nullptr;
}

double Recording::value(std::size_t i, const Field& field) const noexcept {
  const std::byte* at = data.data() + i * header.record_bytes + field.offset;
  if (field.type == "f64") return widened<double>(at);
  if (field.type == "i64") return widened<std::int64_t>(at);
  if (field.type == "i32") return widened<std::int32_t>(at);
  if (field.type == "u32") return widened<std::uint32_t>(at);
  if (field.type == "u16") return widened<std::uint16_t>(at);
  return widened<std::uint8_t>(at);
}

}  // namespace hapticd::daemon
