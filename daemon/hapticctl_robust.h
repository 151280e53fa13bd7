// `certify`'s robust answer: is the sampled loop of one axis stable for every device of its box, every
// latency up to latency_s, the contact open or closed? And what Eom, Suh and Yi's own condition says of
// the same wall, which decides nothing.
#pragma once
#include "config/compile.h"
#include "control/design/check/loop_cases.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {

/// Of one device as the exact block looks at it.
struct AxisLoop {
  std::string device;
  std::string why;  ///< why there is none; empty: the rest holds
  check::SampledLoop loop{};
  check::LoopBox box{};
  bool wall = false;                         ///< one plane, rendered directly
  double stiffness = 0, damper = 0;          ///< of it, N/m and N s/m along the axis
  double mass = 0, damping = 0;              ///< of the device, the middle of the box
  double mass_share = 0, damping_share = 0;  ///< uncertainties
};
std::vector<AxisLoop> axis_loops(const config::Compiled& compiled);

/// One entry per device: answer ("robust: proved", ..), worst case, what is tolerated; for a wall what
/// the paper's norm says.
Json robust_json(const config::Compiled& compiled);
std::string robust_text(const Json& robust);

}  // namespace hapticd::daemon
