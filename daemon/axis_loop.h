// The sampled loop of one axis, read from a compiled config: the wall that is rendered directly, or a coupling and
// networks, with its observer and estimator, for every device of the model's box, every hand of `stability.hand`, every
// latency up to latency_s. The contact with a wall is open, closed, or gives way by any share: a loop that is stable
// while it stays closed may still throw a device off the wall further each time. So a wall needs a hand with a spring,
// whom the open loop brings back, for a proof.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "config/compile.h"
#include "control/core/result.h"
#include "control/design/check/robust.h"

namespace hapticd::daemon {

/// Of one device as the exact block looks at it.
struct AxisLoop {
  std::string device;
  std::string why;  ///< why there is none; empty: the rest holds
  check::SampledLoop loop{};
  check::LoopBox box{};
  bool wall = false;                        ///< one plane, rendered directly
  std::optional<check::System> velocity{};  ///< the estimator that its damper sees
  double stiffness = 0, damper = 0;         ///< of it, N/m and N s/m along the axis
  double scale =
      1;  ///< what the axis feels of 1 N/m of the config's wall: slant and scale of the workspace, squared
  double mass = 0, damping = 0;              ///< of the device, the middle of the box
  double mass_share = 0, damping_share = 0;  ///< uncertainties
};
std::vector<AxisLoop> axis_loops(const config::Compiled& compiled);
/// For what looks at one device alone. Errors: bad_data (several devices, or no loop is known).
Result<AxisLoop> only_loop(const config::Compiled& compiled);
/// Of a plane that is rendered directly.
Result<AxisLoop> only_wall(const config::Compiled& compiled);

/// Is a robust answer a proof, for all of its box?
inline bool is_proof(const check::RobustAnswer& answer) noexcept {
  return answer.kind >= check::Robust::proved_constant;
}
/// "proved, whatever changes from tick to tick", "sampled", "no".
std::string robust_words(const check::RobustAnswer& answer);

/// What the config's proof file has for a device; empty: nothing.
std::vector<check::Matrix> proof_of(const config::Compiled& compiled, const std::string& device);

}  // namespace hapticd::daemon
