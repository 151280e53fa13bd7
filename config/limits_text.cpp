#include "config/limits_text.h"

#include <cmath>

#include "config/number.h"

namespace hapticd::config {

std::string range_text(const Key& key) {
  const std::string min = format_exact(key.min);
  const std::string max = format_exact(key.max);
  std::string text;
  if (key.above_min) {
    text = "above " + min;
    if (std::isfinite(key.max)) text += ", at most " + max;
  } else if (key.min == key.max) {
    text = min;
  } else if (std::isfinite(key.min) && std::isfinite(key.max)) {
    text = "from " + min + " to " + max;
  } else if (std::isfinite(key.min)) {
    text = "at least " + min;
  } else if (std::isfinite(key.max)) {
    text = "at most " + max;
  }
  const std::string unit = key.unit;
  return unit.empty() ? text : text + (text.empty() ? "" : " ") + unit;
}

std::string count_text(const Key& key) {
  const bool has_max = key.max_items != Key{}.max_items;
  const std::string max = std::to_string(key.max_items);
  const std::string min = std::to_string(key.min_items);
  if (key.min_items > 0 && has_max) return min + " to " + max + " entries";
  if (key.min_items > 0) return "at least " + min + " entries";
  return has_max ? "at most " + max + " entries" : "";
}

bool in_range(double value, const Key& key) {
  const bool above = key.above_min ? value > key.min : value >= key.min;
  return above && value <= key.max;
}

}  // namespace hapticd::config
