#include "daemon/file_names.h"

#include <unistd.h>

#include <array>
#include <ctime>
#include <filesystem>

namespace hapticd::daemon {
namespace {

bool exists(const std::string& path) {
  return ::access(path.c_str(), F_OK) == 0;
}

}  // namespace

std::string utc_stamp() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &utc);
  return {text.data(), length};
}

Result<RecordingWriter> create_unique(const std::string& stem, const std::string& suffix,
                                      const RecordingHeader& header) {
  constexpr int kTries = 100;  // names of one second
  std::string path = stem + suffix;
  for (int i = 2; i < kTries && exists(path); ++i) path = stem + "-" + std::to_string(i) + suffix;
  return RecordingWriter::create(path, header, IfExists::refuse);
}

Result<RecordingWriter> create_beside(const std::string& path, const RecordingHeader& header) {
  if (!exists(path)) return RecordingWriter::create(path, header, IfExists::refuse);
  const std::string suffix = std::filesystem::path(path).extension();
  const std::string stem = path.substr(0, path.size() - suffix.size());
  return create_unique(stem + "-" + utc_stamp(), suffix, header);
}

}  // namespace hapticd::daemon
