// What the stability check may assume of each device, and what the plan does not say of it: names of
// objects, and velocities that are not backward differences, which no theorem of
// control/design/check/stability.h knows. All other premises are checked there, on the plan.
#include <algorithm>
#include <string>

#include "config/compilation.h"
#include "config/coordinates.h"
#include "config/describe.h"
#include "config/device_groups.h"

namespace hapticd::config {
namespace {

/// Is a coordinate of this device without a coupling?
bool is_direct(const build::ProgramSpec& spec, const DevicePlace& place) {
  const auto holds = [&](const build::CouplingBlock& block, std::size_t coordinate) {
    return std::find(block.coordinates.begin(), block.coordinates.end(), coordinate) !=
           block.coordinates.end();
  };
  for (std::size_t i = 0; i < place.frame.directions.size(); ++i) {
    const auto held = [&](const auto& block) { return holds(block, place.coordinate(i)); };
    if (std::none_of(spec.coupling.begin(), spec.coupling.end(), held)) return true;
  }
  return false;
}

/// Does damping act on the contact of this device by the velocity of its axes? Behind a coupling it
/// is the proxy's backward difference.
bool feels_damping(const build::ProgramSpec& spec, const DevicePlace& place) {
  const auto plane_damps = [&](const control::PlaneContact& p) {
    return p.first_coordinate == place.first_coordinate && p.damping > 0;
  };
  const auto object_damps = [&](const control::Encounter& e) {
    if (e.contact != place.index) return false;
    return e.kind == control::ObjectKind::viscous ? spec.viscous_fields[e.shape].damping > 0
                                                  : e.surface.damping > 0;
  };
  return std::any_of(spec.planes.begin(), spec.planes.end(), plane_damps) ||
         (is_direct(spec, place) &&
          std::any_of(spec.encounters.begin(), spec.encounters.end(), object_damps));
}

/// A device all of whose axes have a model: the least damping of each.
std::vector<double> min_damping(const DevicePlace& place) {
  std::vector<double> damping;
  for (const AxisValues& axis : place.axes) {
    if (!axis.model) return {};
    damping.push_back(axis.model->least_damping());
  }
  return damping;
}

/// Axes whose velocity is estimated otherwise and matters to a force.
std::string estimator_obstacle(const build::ProgramSpec& spec, const DevicePlace& place) {
  const bool damped = feels_damping(spec, place);
  for (std::size_t i = 0; i < place.axes.size(); ++i) {
    const Axis& axis = place.device.axes[i];
    const bool matters =
        damped || place.axes[i].friction.viscous > 0 || place.axes[i].friction.coulomb > 0;
    if (axis.velocity.estimator == Estimator::backward_difference || !matters) continue;
    return "axis " + axis.name + ": damping by the velocity of " +
           std::string(word_of(axis.velocity.estimator)) +
           " is beyond the closed form, which holds for the backward difference";
  }
  return {};
}

std::vector<std::string> obstacles(const build::ProgramSpec& spec, const DevicePlace& place) {
  std::vector<std::string> found;
  if (std::string text = estimator_obstacle(spec, place); !text.empty())
    found.push_back(std::move(text));
  return found;
}

/// Objects that give energy of their own.
std::vector<check::ObjectNote> active(const FeltObjects& felt) {
  std::vector<check::ObjectNote> found;
  for (const std::string& label : felt.moving)
    found.push_back({label, "moves: what it gives is booked, not bounded beforehand"});
  for (const std::string& label : felt.swinging)
    found.push_back({label, "drives the hand: what it gives is booked, not bounded beforehand"});
  return found;
}

bool has_mass(const build::Network& network) {
  return std::any_of(network.nodes.begin(), network.nodes.end(),
                     [](const build::NetworkNode& node) { return node.mass > 0; });
}

/// Do the devices of a group touch masses? They keep energy that only convex objects are sure to
/// leave alone.
bool touches_masses(const Compilation& compilation, std::size_t group,
                    const std::vector<std::size_t>& groups) {
  const auto of_group = [&](const build::Network& network) {
    for (const build::NetworkElement& element : network.elements) {
      for (const build::NetworkEnd& end : {element.a, element.b}) {
        if (end.at == build::NetworkEnd::At::coordinate)
          return groups[device_of(compilation, end.index)] == group;
      }
    }
    return false;
  };
  const auto& networks = compilation.spec.networks;
  return std::any_of(networks.begin(), networks.end(), [&](const build::Network& network) {
    return has_mass(network) && of_group(network);
  });
}

}  // namespace

void compile_assumptions(Compilation& compilation, const std::vector<DevicePlace>& places) {
  if (!compilation.errors.empty()) return;
  const std::vector<std::size_t> groups = device_groups(compilation);
  for (const DevicePlace& place : places) {
    const FeltObjects& felt = compilation.felt[place.index];
    compilation.assumed.push_back(
        {.name = place.device.name,
         .latency_s = place.device.latency_s,
         .latency_varies = compilation.can[place.index] || compilation.usb[place.index],
         .min_damping = min_damping(place),
         .obstacles = obstacles(compilation.spec, place),
         .active = active(felt),
         .nonconvex = felt.nonconvex,
         .heavy_network = touches_masses(compilation, groups[place.index], groups)});
  }
}

}  // namespace hapticd::config
