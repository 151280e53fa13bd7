// What an identification found, for people, for machines, and as the files that are written.
#pragma once
#include <string>
#include <vector>

#include "config/schema_axis.h"
#include "control/identify/fit.h"
#include "control/identify/hand.h"
#include "daemon/hapticctl_identify_session.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {

/// Of one run, whatever was looked for.
struct IdentifyRun {
  const IdentifySetup& setup;
  const IdentifySession& session;
  const IdentifyOptions& options;
  std::string at;  ///< UTC
  /// Position per effort, or of a hand force per position.
  std::vector<identify::ResponsePoint> response;
  double held_took = 0;  ///< of the damping's half-width: what other joints may have taken
};

config::ModelFile model_file(const IdentifyRun& run, const identify::Fit& fit);
/// Keys as of a simulated hand, to put under `sim: {hand: ...}`.
std::string hand_file(const IdentifyRun& run, const identify::HandFit& fit);

std::string model_text(const IdentifyRun& run, const identify::Fit& fit);
std::string hand_text(const IdentifyRun& run, const identify::HandFit& fit);
Json model_json(const IdentifyRun& run, const identify::Fit& fit);
Json hand_json(const IdentifyRun& run, const identify::HandFit& fit);

}  // namespace hapticd::daemon
