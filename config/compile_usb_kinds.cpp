// What a Falcon and an OpenFFBoard are told, and what they cannot do.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "config/compile_usb.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

void check_rotary(const UsbPlace& place, const std::string& what) {
  for (std::size_t i = 0; i < place.device.axes.size(); ++i) {
    if (place.device.axes[i].rotary) continue;
    place.refuse_axis(i, "kind",
                      "expected rotary: " + what + " has motors that turn, found linear");
  }
}

void check_firmware(const UsbPlace& place, const Falcon& falcon) {
  if (falcon.firmware && falcon.firmware->empty())
    place.refuse("falcon.firmware",
                 "expected a path, found an empty text; null: the Falcon has its firmware");
  if (falcon.sha256 && !falcon.firmware)
    place.refuse("falcon.sha256", "of what? Name the file, too: falcon.firmware");
}

/// Its encoders count from where they were at power-on, until the grip was pulled out and pushed in.
void check_zero(const UsbPlace& place) {
  const auto& axes = place.device.device.axes;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].homing.by != HomingMethod::none) continue;
    place.refuse_axis(i, "homing",
                      "a Falcon does not know where it is at power-on, but says when it does: "
                      "expected homing: {by: device}");
  }
}

/// The sign of counts_per_Nm is for arms that turn up as they count up.
void check_turns(const UsbPlace& place) {
  const auto& axes = place.device.device.axes;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!axes[i].encoder.reversed) continue;
    place.refuse_axis(i, "encoder.reversed",
                      "the arms of a Falcon count up as they turn up, and its motors would push "
                      "the wrong way: remove this key");
  }
}

}  // namespace

usb::FalconOptions compile_falcon(const UsbPlace& place) {
  constexpr std::size_t kAxes = 3;
  const Falcon falcon = place.device.device.falcon.value_or(Falcon{});
  check_firmware(place, falcon);
  if (place.device.axes.size() != kAxes) {
    place.refuse("axes", "a Falcon has 3 axes, found " + std::to_string(place.device.axes.size()));
    return {};
  }
  if (!std::holds_alternative<Delta>(place.device.device.kinematics))
    check_rotary(place, "a Falcon");
  check_zero(place);
  check_turns(place);
  if (falcon.counts_per_Nm == 0) {
    place.refuse("falcon.counts_per_Nm", "expected any number but 0");
    return {};
  }
  for (std::size_t i = 0; i < place.device.axes.size(); ++i)
    check_effort(place, i, falcon.max_command / std::abs(falcon.counts_per_Nm),
                 "falcon.max_command at falcon.counts_per_Nm");
  std::string sha256 = falcon.sha256.value_or("");
  std::ranges::transform(sha256, sha256.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return {.firmware = falcon.firmware.value_or(""),
          .sha256 = std::move(sha256),
          .upload_tries = falcon.upload_tries,
          .counts_per_Nm = falcon.counts_per_Nm,
          .max_command = falcon.max_command,
          .flush_on_bracket = falcon.flush_on_bracket};
}

usb::OpenFfboardOptions compile_openffboard(const UsbPlace& place) {
  constexpr std::size_t kMostAxes = 2;
  const OpenFfboard& board = *place.device.device.openffboard;
  const std::size_t axes = place.device.axes.size();
  if (axes > kMostAxes) {
    place.refuse("axes", "an OpenFFBoard has 1 or 2 axes, found " + std::to_string(axes));
    return {};
  }
  check_rotary(place, "an OpenFFBoard");
  for (std::size_t i = 0; i < axes; ++i) {
    check_effort(place, i, board.full_torque_Nm, "openffboard.full_torque_Nm");
    const int bits = place.device.device.axes[i].encoder.bits;
    if (bits == 0) continue;
    place.refuse_axis(i, "encoder.bits",
                      "expected 0: the board sends a position within its range, which does not "
                      "begin anew; found " +
                          std::to_string(bits));
  }
  return {.full_torque_Nm = board.full_torque_Nm, .dead_man_s = board.dead_man_s};
}

}  // namespace hapticd::config
