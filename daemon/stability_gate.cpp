#include "daemon/stability_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hapticd::daemon {

bool Gate::proved() const noexcept {
  return std::all_of(devices.begin(), devices.end(),
                     [](const auto& device) { return device.proved; });
}

std::string Gate::explanation() const {
  std::string text = verdict;
  for (std::size_t i = 0; i < devices.size();) {
    // Devices that are tied share one answer.
    std::string who = names[i];
    std::size_t next = i + 1;
    for (; next < devices.size() && devices[next].why == devices[i].why; ++next)
      who += ", " + names[next];
    text += fmt::format("\n  {}: {}: {}", who, devices[i].proved ? "passive, proved" : "not proved",
                        devices[i].why);
    i = next;
  }
  if (!certificate_problem.empty()) text += "\n  " + certificate_problem;
  return text;
}

Gate decide(config::Require require, bool only_simulated, std::vector<check::PassiveAnswer> devices,
            std::vector<std::string> names) {
  Gate gate;
  gate.devices = std::move(devices);
  gate.names = std::move(names);
  if (gate.proved()) {
    gate.answer = Gate::Answer::open;
    gate.verdict =
        "forces may be enabled: passive with every passive hand, proved for every device";
  } else if (require == config::Require::passive) {
    gate.answer = Gate::Answer::closed;
    gate.verdict =
        "forces stay off: stability.require is passive and not every device is proved; soften the "
        "scene as said "
        "below, or set stability.require: none if you take the risk";
  } else if (only_simulated) {
    gate.answer = Gate::Answer::open;
    gate.verdict =
        "forces may be enabled: nothing is proved, but stability.require is none and every device "
        "is simulated";
  } else {
    gate.answer = Gate::Answer::needs_unproven;
    gate.verdict =
        "forces stay off: stability.require is none and not every device is proved; on real "
        "devices that takes "
        "`hapticctl enable --unproven`";
  }
  return gate;
}

Gate stability_gate(const config::Compiled& compiled) {
  const auto& devices = compiled.document.config.devices;
  const bool only_simulated = std::all_of(
      devices.begin(), devices.end(),
      [](const config::Device& device) { return device.driver == config::Driver::sim; });
  Gate gate =
      decide(compiled.document.config.stability.require, only_simulated,
             check::passive(compiled.program->plan(), compiled.assumed, compiled.certificate.get()),
             compiled.program->spec().device_names);
  gate.certificate_problem = compiled.certificate_problem;
  return gate;
}

}  // namespace hapticd::daemon
