// A recording by names: which axes, contacts and devices it has, and what a field was in a record.
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "daemon/recording.h"

namespace hapticd::daemon {

class RecordingView {
 public:
  explicit RecordingView(const Recording& recording) : recording_(recording) {
    for (const Field& field : recording.header.fields) fields_.emplace(field.name, &field);
  }

  std::size_t size() const noexcept { return recording_.size(); }
  double rate_Hz() const noexcept { return recording_.header.rate_Hz; }

  /// nullptr: it was not recorded.
  const Field* field(const std::string& name) const {
    const auto found = fields_.find(name);
    return found == fields_.end() ? nullptr : found->second;
  }
  std::optional<double> at(std::size_t i, const std::string& name) const {
    const Field* known = field(name);
    return known == nullptr ? std::nullopt : std::optional(recording_.value(i, *known));
  }
  double value(std::size_t i, const Field& field) const noexcept {
    return recording_.value(i, field);
  }
  /// A whole number; 0 where it was not recorded or is none.
  std::int64_t whole(std::size_t i, const Field* field) const noexcept {
    const double value = field == nullptr ? 0 : recording_.value(i, *field);
    return std::abs(value) < 9e18 ? static_cast<std::int64_t>(value) : 0;
  }

  /// Of all fields "<owner><suffix>" the owners, in the order of the file, which is that of the
  /// plan.
  std::vector<std::string> owners(std::string_view suffix) const {
    std::vector<std::string> names;
    for (const Field& field : recording_.header.fields) {
      if (field.name.size() > suffix.size() && std::string_view(field.name).ends_with(suffix))
        names.push_back(field.name.substr(0, field.name.size() - suffix.size()));
    }
    return names;
  }
  std::vector<std::string> axes() const { return owners(".q"); }
  std::vector<std::string> coordinates() const { return owners(".position"); }
  std::vector<std::string> devices() const { return owners(".armed"); }

 private:
  const Recording& recording_;
  std::unordered_map<std::string_view, const Field*> fields_;
};

/// "left.x" is of "left".
inline bool belongs(std::string_view part, std::string_view device) {
  return part.size() > device.size() && part.starts_with(device) && part[device.size()] == '.';
}

}  // namespace hapticd::daemon
