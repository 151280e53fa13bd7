// Where in the file each value stood, so that errors found long after reading still name a line.
#pragma once
#include <map>
#include <string>

namespace hapticd::config {

/// A place in a text, from 1; columns count bytes. 0: unknown.
struct Mark {
  int line = 0;
  int column = 0;
};

class Places {
 public:
  /// `path` as in errors: "devices[0].axes[1].encoder.bits".
  void add(const std::string& path, Mark mark) { marks_.insert_or_assign(path, mark); }
  /// Of the value, or of the nearest one around it that the file has.
  Mark find(std::string path) const {
    for (;;) {
      if (const auto found = marks_.find(path); found != marks_.end()) return found->second;
      const auto end = path.find_last_of(".[");
      if (path.empty()) return {};
      path.resize(end == std::string::npos ? 0 : end);
    }
  }

 private:
  std::map<std::string, Mark> marks_;
};

}  // namespace hapticd::config
