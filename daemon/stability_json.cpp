#include "daemon/stability_json.h"

#include <cmath>
#include <utility>

namespace hapticd::daemon {
namespace {

/// JSON knows no infinity.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

Json answer_json(const std::string& device, const check::PassiveAnswer& answer) {
  Json uncertified = Json::array();
  for (const check::ObjectNote& note : answer.uncertified)
    uncertified.push_back({{"object", note.object}, {"reason", note.reason}});
  return {{"device", device},
          {"proved", answer.proved},
          {"theorem", name_of(answer.theorem)},
          {"why", answer.why},
          {"damping_used", finite(answer.damping_used)},
          {"stiffness_factor", finite(answer.stiffness_factor)},
          {"longest_hold_s", finite(answer.longest_hold_s)},
          {"missed_ticks", answer.missed_ticks},
          {"worst_pose", text_or_null(answer.worst_pose)},
          {"uncertified", std::move(uncertified)},
          {"uncovered", answer.uncovered}};
}

}  // namespace

Json stability_json(const Gate& gate) {
  Json devices = Json::array();
  for (std::size_t i = 0; i < gate.devices.size(); ++i)
    devices.push_back(answer_json(gate.names[i], gate.devices[i]));
  Json robust = Json::array();
  for (std::size_t i = 0; i < gate.robust.size(); ++i)
    robust.push_back({{"device", gate.names[i]},
                      {"proved", gate.robust[i].proved},
                      {"why", gate.robust[i].why}});
  return {{"proved", gate.proved()},
          {"robust", std::move(robust)},
          {"forces_may_be_enabled", gate.permits(false)},
          {"verdict", gate.verdict},
          {"certificate_problem", text_or_null(gate.certificate_problem)},
          {"devices", std::move(devices)}};
}

}  // namespace hapticd::daemon
