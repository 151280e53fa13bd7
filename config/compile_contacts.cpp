// Contacts as the scene sees them, and which of them are tied together.
#include <algorithm>
#include <numeric>

#include "config/compilation.h"
#include "config/coordinates.h"
#include "config/device_groups.h"
#include "control/build/scene.h"

namespace hapticd::config {
namespace {

control::ContactPlan contact_plan(const control::DevicePlan& device, const DevicePlace& place) {
  control::ContactPlan made;
  made.device = place.index;
  made.first_coordinate = device.first_coordinate;
  made.coordinates = device.coordinates;
  made.radius = place.device.tool_radius_m;
  made.max_force = device.max_force;
  for (std::size_t d = 0; d < 3; ++d) made.fixed[d] = place.frame.position[d];
  for (std::size_t i = 0; i < place.frame.directions.size(); ++i) {
    const std::size_t direction = place.frame.directions[i];
    made.direction[i] = static_cast<std::uint8_t>(direction);
    made.fixed[direction] = 0;
  }
  return made;
}

/// Devices whose coordinates one block or one network names.
std::vector<std::vector<std::size_t>> ties(const Compilation& compilation) {
  std::vector<std::vector<std::size_t>> all;
  for (const build::CouplingBlock& block : compilation.spec.coupling) {
    all.emplace_back();
    for (const std::uint32_t coordinate : block.coordinates)
      all.back().push_back(device_of(compilation, coordinate));
  }
  for (const build::Network& network : compilation.spec.networks) {
    all.emplace_back();
    for (const build::NetworkElement& element : network.elements) {
      for (const build::NetworkEnd& end : {element.a, element.b}) {
        if (end.at == build::NetworkEnd::At::coordinate)
          all.back().push_back(device_of(compilation, end.index));
      }
    }
  }
  return all;
}

}  // namespace

std::vector<std::size_t> device_groups(const Compilation& compilation) {
  std::vector<std::size_t> group(compilation.spec.devices.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (const std::vector<std::size_t>& tied : ties(compilation)) {
    for (const std::size_t device : tied) {
      const std::size_t joined = group[tied.front()];
      std::replace(group.begin(), group.end(), std::size_t{group[device]}, joined);
    }
  }
  return group;
}

void compile_contacts(Compilation& compilation, const std::vector<DevicePlace>& places) {
  build::ProgramSpec& spec = compilation.spec;
  if (spec.encounters.empty() && spec.coupling.empty() && spec.networks.empty()) return;
  for (const DevicePlace& place : places)
    spec.contacts.push_back(contact_plan(spec.devices[place.index], place));
  const std::string problem = build::problem(build::groups_spec(spec));
  if (!problem.empty()) compilation.refuse("coupling", problem);
}

}  // namespace hapticd::config
