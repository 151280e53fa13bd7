// `hapticctl cost CONFIG`: nanoseconds and share of the period, part by part.
#pragma once
#include <string>

#include "control/core/result.h"
#include "daemon/cost.h"
#include "daemon/protocol.h"

namespace hapticd::daemon {

/// The machine that measures, as it is now.
struct Machine {
  std::string processor, kernel, load;
};
Machine this_machine();

std::string cost_text(const CostReport& report, const Machine& machine);
Json cost_json(const CostReport& report, const Machine& machine);

/// Compiles, measures and prints; whatever it costs, the answer is ok.
ExitCode run_cost(const std::string& config_path, const CostOptions& options, bool json);

}  // namespace hapticd::daemon
