#include "daemon/ctl_check.h"

#include <cmath>
#include <cstdio>

#include "config/compile.h"
#include "config/print.h"
#include "daemon/protocol.h"
#include "daemon/stability_gate.h"

namespace hapticd::daemon {
namespace {

/// JSON knows no infinity: null where there is no bound.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json stability_json(const Gate& gate) {
  Json devices = Json::array();
  for (std::size_t i = 0; i < gate.devices.size(); ++i) {
    const check::PassiveAnswer& answer = gate.devices[i];
    devices.push_back({{"device", gate.names[i]},
                       {"proved", answer.proved},
                       {"why", answer.why},
                       {"damping_used", finite(answer.damping_used)},
                       {"stiffness_factor", finite(answer.stiffness_factor)},
                       {"longest_hold_s", finite(answer.longest_hold_s)}});
  }
  return {{"proved", gate.proved()},
          {"forces_may_be_enabled", gate.permits(false)},
          {"verdict", gate.verdict},
          {"devices", std::move(devices)}};
}

}  // namespace

ExitCode print_config_errors(const std::vector<config::ConfigError>& errors, bool json) {
  const ExitCode code = errors.empty() ? ExitCode::bad_data : errors.front().code;
  if (!json) {
    for (const auto& error : errors) std::fprintf(stderr, "%s\n", config::to_string(error).c_str());
    return code;
  }
  Json list = Json::array();
  for (const auto& error : errors) {
    list.push_back({{"file", error.file},
                    {"line", error.line},
                    {"column", error.column},
                    {"path", error.path},
                    {"message", error.message}});
  }
  std::puts(to_text({{"ok", false}, {"code", static_cast<int>(code)}, {"errors", std::move(list)}})
                .c_str());
  return code;
}

ExitCode check_config(const std::string& path, bool json) {
  const auto compiled = config::load(path);
  if (!compiled) return print_config_errors(compiled.error(), json);
  const Gate gate = stability_gate(*compiled);
  if (json) {
    std::puts(to_text({{"ok", true},
                       {"plan", Json::parse(config::plan_json(*compiled))},
                       {"stability", stability_json(gate)}})
                  .c_str());
  } else {
    std::printf("%s\nstability: %s\n", config::describe_plan(*compiled).c_str(),
                gate.explanation().c_str());
  }
  return gate.permits(false) ? ExitCode::ok : ExitCode::no;
}

}  // namespace hapticd::daemon
