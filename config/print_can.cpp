#include "config/print_can.h"

#include <cmath>

#include "config/describe.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

std::string percent(double share) {
  return format_number(std::round(1000 * share) / 10) + " %";
}
std::string us(double seconds) {
  return format_number(std::round(1e6 * seconds)) + " us";
}

}  // namespace

std::string drives_text(const Compiled& compiled, std::size_t device) {
  const auto& can = compiled.can[device];
  if (!can) return {};
  std::string text = "  drives: ";
  for (const can::DriveOptions& drive : can->drives)
    text += (&drive == &can->drives.front() ? "node " : ", node ") + std::to_string(drive.node) +
            " on " + drive.interface;
  return text + "; " + std::string(word_of(static_cast<CanTiming>(can->timing))) +
         ", samples at most " + us(can->worst_sample_age_s) + " old, watchdog " +
         format_number(can->watchdog_s) + " s\n";
}

std::string buses_text(const Compiled& compiled) {
  std::string text;
  for (const can::BusLoad& bus : compiled.buses) {
    text += "bus " + bus.interface + ": " + percent(bus.share) + " of its time at worst (at most " +
            percent(can::kMostLoad) + "), " + std::to_string(bus.axes) +
            (bus.axes == 1 ? " axis, " : " axes, ") + std::to_string(bus.axes_that_fit) +
            " fit; the fullest tick takes " + us(bus.busiest_s) + "\n";
  }
  return text;
}

}  // namespace hapticd::config
