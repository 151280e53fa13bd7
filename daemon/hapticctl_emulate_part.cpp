#include "daemon/hapticctl_emulate_part.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace hapticd::daemon {
namespace {

constexpr std::array kKinds{"reset", "fail", "mute",  "speak", "unplug",
                            "plug",  "hang", "stall", "mark"};

/// The whole of it, not negative.
std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !(value >= 0 && value < 1e9)) return std::nullopt;
  return value;
}

}  // namespace

Result<Fault> parse_fault(const std::string& text, bool at_once) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::size_t at = std::min(text.rfind('@'), text.size());
  std::string_view when = std::string_view(text).substr(std::min(at + 1, text.size()));
  const bool percent = when.ends_with('%');
  when.remove_suffix(percent ? 1 : 0);
  const auto number = at < text.size() || !at_once ? number_in(when) : 0;
  Fault fault{.kind = text.substr(0, colon)};
  if (colon < at) fault.name = text.substr(colon + 1, at - colon - 1);
  if (!number || fault.name.empty() || std::ranges::find(kKinds, fault.kind) == kKinds.end())
    return fail(
        ExitCode::usage,
        "--fault: expected KIND:AXIS@SECONDS, such as reset:left.x@2.5, with reset, fail, mute "
        "or speak; or, of USB, KIND:DEVICE@SECONDS or @PER CENT% of firmware, with unplug, "
        "plug, reset, hang, mute, speak, stall or mark; found " +
            text);
  if (percent)
    fault.percent = *number;
  else
    fault.at_ns = std::llround(1e9 * *number);
  return fault;
}

tl::unexpected<Error> nothing_to_move(const std::string& device) {
  return fail(ExitCode::bad_data, "device " + device +
                                      ": nothing is known of what its motors move: give each axis "
                                      "a model, or the device a sim section");
}

}  // namespace hapticd::daemon
