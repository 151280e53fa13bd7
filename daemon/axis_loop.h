// The sampled loop of one axis, read from a compiled config: the wall that is rendered directly, or a coupling and
// networks, with its observer and estimator, for every device of the model's box, every hand of `stability.hand`, every
// latency up to latency_s, the contact open or closed; and what a proof says of it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "config/compile.h"
#include "control/design/check/robust.h"

namespace hapticd::daemon {

/// Of one device as the exact block looks at it.
struct AxisLoop {
  std::string device;
  std::string why;  ///< why there is none; empty: the rest holds
  check::SampledLoop loop{};
  check::LoopBox box{};
  bool wall = false;                         ///< one plane, rendered directly
  std::optional<check::System> velocity{};   ///< the estimator that its damper sees
  double stiffness = 0, damper = 0;          ///< of it, N/m and N s/m along the axis
  double mass = 0, damping = 0;              ///< of the device, the middle of the box
  double mass_share = 0, damping_share = 0;  ///< uncertainties
};
std::vector<AxisLoop> axis_loops(const config::Compiled& compiled);

struct AxisAnswer {
  check::RobustAnswer robust;
  bool open_too = false;  ///< proved for an open contact as for a closed one
  bool proved() const noexcept { return robust.kind >= check::Robust::proved_constant; }
};
/// Boxes that a proof may be about, the larger first: with a hand's spring the contact may open.
std::vector<check::LoopBox> boxes_to_prove(const AxisLoop& one);
/// `one.why` is empty. `P`: as in check::robust; whatever they are, proved is only what they prove.
AxisAnswer robust_answer(const AxisLoop& one, const std::vector<check::Matrix>& P);
/// "proved while the contact stays closed", "sampled", "no".
std::string words_of(const AxisAnswer& answer);

/// What the config's proof file has for a device; empty: nothing.
std::vector<check::Matrix> proof_of(const config::Compiled& compiled, const std::string& device);

}  // namespace hapticd::daemon
