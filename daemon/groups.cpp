#include "daemon/groups.h"

#include "control/design/check/tied_case.h"

namespace hapticd::daemon {

std::vector<Group> groups_of(const config::Compiled& compiled) {
  std::vector<Group> groups;
  const control::Plan& plan = compiled.program->plan();
  for (const check::Tied& devices : check::tied_devices(plan)) {
    const check::TiedCase given(plan, compiled.assumed, devices);
    if (given.model.coordinates.empty() || given.jointed) continue;
    bool known = true;
    for (const std::size_t d : devices)
      known = known && compiled.assumed[d].min_damping.size() == plan.devices[d].axes;
    groups.push_back({.devices = devices,
                      .model = given.model,
                      .damping = known ? check::damping_left(given, 1) : check::Matrix(),
                      .latency_s = given.latency,
                      .linear = given.scene.linear && given.needs.direct.isZero(0) &&
                                given.needs.problem.empty(),
                      .names = given.names()});
  }
  return groups;
}

std::string coordinate_name(const config::Compiled& compiled, std::size_t coordinate) {
  return compiled.program->spec().coordinate_names.at(coordinate);
}

}  // namespace hapticd::daemon
