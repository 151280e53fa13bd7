// What `hapticctl identify` needs of a config: which axis, its bounds, and the device in a state to be
// identified.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/compile.h"
#include "control/core/result.h"
#include "control/identify/excitation.h"
#include "control/identify/hold.h"
#include "control/plan.h"
#include "drivers/device.h"

namespace hapticd::daemon {

/// As on the command line; what is not named follows from the config.
struct IdentifyOptions {
  std::string device, axis;
  std::string output;
  identify::Method method = identify::Method::stepped;
  std::optional<double> force, travel, speed;  ///< N, m, m/s; of a rotary axis N m, rad, rad/s
  std::optional<double> from_Hz, to_Hz;
  std::optional<std::uint64_t> seed;  ///< of a simulated device
  bool hand = false;                  ///< of the hand that holds the axis, not of the axis
  bool clamped = false;               ///< the other axes are held by hand or clamp, not by force
  bool real_time = false;             ///< by the clock, whatever the driver
};

struct IdentifySetup {
  std::string name;  ///< "left.x"
  bool rotary = false;
  bool jointed = false;
  bool clamped = false;
  std::size_t axis = 0;                ///< of the device
  std::optional<std::size_t> channel;  ///< of the force sensor, along the axis
  identify::ExcitationOptions excitation;
  std::vector<identify::HoldOptions> holds;  ///< by axis; its own is not used
  std::vector<control::AxisPlan> axes;
  double period_s = 0;
  double latency_s = 0;  ///< that the config states
  double delay_s = 0;    ///< best known: as measured before, or as stated
  std::optional<double> simulated_delay_s;
  std::unique_ptr<drivers::Device> device;
  bool by_the_clock = false;
  std::vector<std::string> notes;  ///< what was changed or cannot be known, for people
};

/// Errors: usage (no such device or axis, bounds beyond the config's), bad_data (no force sensor).
Result<IdentifySetup> identify_setup(config::Compiled& compiled, const IdentifyOptions& options);

}  // namespace hapticd::daemon
