#include "daemon/stability_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "daemon/axis_loop.h"

namespace hapticd::daemon {

bool Gate::proved() const noexcept {
  return std::all_of(devices.begin(), devices.end(),
                     [](const auto& device) { return device.proved; });
}

bool Gate::proved_robust() const noexcept {
  if (robust.empty()) return false;
  for (std::size_t i = 0; i < devices.size(); ++i)
    if (!devices[i].proved && !robust[i].proved) return false;
  return true;
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
  for (std::size_t i = 0; i < robust.size(); ++i)
    text += fmt::format("\n  {}: robust: {}", names[i], robust[i].why);
  if (!certificate_problem.empty()) text += "\n  " + certificate_problem;
  return text;
}

Gate decide(config::Require require, bool only_simulated, std::vector<check::PassiveAnswer> devices,
            std::vector<std::string> names, std::vector<Gate::Robust> robust) {
  Gate gate;
  gate.devices = std::move(devices);
  gate.names = std::move(names);
  gate.robust = std::move(robust);
  if (gate.proved()) {
    gate.answer = Gate::Answer::open;
    gate.verdict =
        "forces may be enabled: passive with every passive hand, proved for every device";
  } else if (gate.proved_robust()) {
    gate.answer = Gate::Answer::open;
    gate.verdict =
        "forces may be enabled: every device is proved passive, or stable for the devices and "
        "hands that the "
        "config gives";
  } else if (require == config::Require::robust) {
    gate.answer = Gate::Answer::closed;
    gate.verdict =
        "forces stay off: stability.require is robust and not every device is proved; hapticctl "
        "certify CONFIG -o "
        "FILE looks for a proof, stability: {proof: FILE} names it";
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

namespace {

/// Why an axis is proved or not.
Gate::Robust robust_of(const config::Compiled& compiled, const AxisLoop& one) {
  if (!one.why.empty()) return {false, "not proved: " + one.why};
  const std::vector<check::Matrix> P = proof_of(compiled, one.device);
  if (P.empty()) return {false, "not proved: stability.proof has nothing for this device"};
  if (const std::string unfit = check::unfit(one.loop, one.box, P); !unfit.empty())
    return {false, "not proved: " + unfit};
  const check::RobustAnswer answer = check::robust(one.loop, one.box, P);
  return {is_proof(answer),
          (is_proof(answer) ? "" : "not proved: ") + robust_words(answer) + ": " + answer.why};
}

std::vector<Gate::Robust> robust_of(const config::Compiled& compiled) {
  std::vector<Gate::Robust> robust;
  if (compiled.document.config.stability.require != config::Require::robust) return robust;
  for (const AxisLoop& one : axis_loops(compiled)) robust.push_back(robust_of(compiled, one));
  return robust;
}

}  // namespace

Gate stability_gate(const config::Compiled& compiled) {
  const auto& devices = compiled.document.config.devices;
  const bool only_simulated = std::all_of(
      devices.begin(), devices.end(),
      [](const config::Device& device) { return device.driver == config::Driver::sim; });
  Gate gate =
      decide(compiled.document.config.stability.require, only_simulated,
             check::passive(compiled.program->plan(), compiled.assumed, compiled.certificate.get()),
             compiled.program->spec().device_names, robust_of(compiled));
  gate.certificate_problem = compiled.certificate_problem;
  return gate;
}

}  // namespace hapticd::daemon
