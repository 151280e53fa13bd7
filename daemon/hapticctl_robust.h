// `certify`'s robust answer: is the sampled loop of one axis stable for every device of its box, every hand, every
// latency up to latency_s, the contact open or closed? And what Eom, Suh and Yi's own condition says of the same wall,
// which decides nothing.
#pragma once
#include <string>
#include <vector>

#include "config/compile.h"
#include "control/design/synthesis/transmitted.h"
#include "daemon/axis_loop.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {

using check::Matrix;

/// The wall of a device as the paper looks at it, with what it leaves open as the config says.
synthesis::WallGoal paper_goal(const AxisLoop& one, const config::PaperModel& model);

/// One for what may change from tick to tick, else for devices and hands that stay as they are; empty: none found.
/// `one.why` is empty.
std::vector<Matrix> find_proof(const AxisLoop& one);

/// As it is written; `about` is told in its heading.
std::string proof_text(const config::ProofFile& proof, const std::string& about);

struct RobustReport {
  /// One entry per device: answer ("proved ..", "sampled", "no"), worst case, what is tolerated; for a wall what the
  /// paper's norm says.
  Json json;
  config::ProofFile proof{};  ///< of the config's file as far as it holds, else found
};
RobustReport robust_report(const config::Compiled& compiled);
std::string robust_text(const Json& robust);

}  // namespace hapticd::daemon
