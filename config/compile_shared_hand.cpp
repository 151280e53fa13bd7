// A hand that holds axes of several simulated devices. It is described at the contacts; the
// simulator knows axes. With v_contact = s v_axis and work the same on both sides its matrices
// become B s, s C and s D s.
#include <algorithm>

#include "config/compilation.h"
#include "config/coordinates.h"
#include "config/matrices.h"

namespace hapticd::config {
namespace {

constexpr const char* kPath = "sim.hand";

/// The axis that alone moves a coordinate, straight along it; nullptr: there is none.
const control::CartesianAxis* axis_of(const build::ProgramSpec& spec, std::uint32_t coordinate) {
  const auto found =
      std::find_if(spec.cartesian_axes.begin(), spec.cartesian_axes.end(),
                   [&](const control::CartesianAxis& a) { return a.coordinate == coordinate; });
  return found == spec.cartesian_axes.end() ? nullptr : &*found;
}

/// What the simulator does not put together with such a hand. Empty: nothing.
std::string hindrance(const Device& device, const sim::DeviceOptions& simulated) {
  if (device.driver != Driver::sim) return "is not simulated";
  if (simulated.linkage) return "is a linkage";
  if (device.sim && device.sim->hand != SimHand{}) return "has a hand of its own (sim.hand)";
  for (const sim::AxisOptions& axis : simulated.axes) {
    if (axis.coulomb_N > 0) return "has dry friction (sim.axes, coulomb_N)";
    if (axis.stops) return "has stops (sim.axes, stops_m)";
  }
  return {};
}

bool check_device(Compilation& compilation, std::size_t device) {
  const std::string why =
      hindrance(compilation.config.devices[device], compilation.simulated[device]);
  if (why.empty()) return true;
  compilation.refuse(
      std::string(kPath) + ".contacts",
      "device '" + compilation.config.devices[device].name + "' " + why +
          "; a shared hand holds linear axes of simulated Cartesian devices without");
  return false;
}

/// Axes with their scales s, in the order of the contacts; empty: reported.
std::vector<double> add_axes(Compilation& compilation, const SharedHand& hand,
                             sim::SharedHandOptions& options) {
  const std::string path = std::string(kPath) + ".contacts";
  std::vector<double> scales;
  for (const std::uint32_t coordinate : coordinates_named(compilation, hand.contacts, path)) {
    const std::size_t device = device_of(compilation, coordinate);
    if (!check_device(compilation, device)) return {};
    const control::CartesianAxis* axis = axis_of(compilation.spec, coordinate);
    if (axis == nullptr) {
      compilation.refuse(path, "no axis moves " + compilation.spec.coordinate_names[coordinate] +
                                   " alone; turn the device's pose so that axes are along world "
                                   "directions");
      return {};
    }
    const std::size_t own = axis->axis - compilation.spec.devices[device].first_axis;
    options.axes.push_back({.device = device, .axis = own});
    scales.push_back(axis->scale);
  }
  return scales;
}

std::vector<double> by_rows(const Eigen::MatrixXd& m) {
  return to_matrix(m).values;
}

void add_matrices(const LinearSystem& hand, const std::vector<double>& scales,
                  sim::SharedHandOptions& options) {
  const Eigen::Map<const Eigen::VectorXd> s(scales.data(),
                                            static_cast<Eigen::Index>(scales.size()));
  options.states = static_cast<std::size_t>(hand.A.rows());
  options.A = by_rows(hand.A);
  options.B = by_rows(hand.B * s.asDiagonal());
  options.C = by_rows(s.asDiagonal() * hand.C);
  options.D = by_rows(s.asDiagonal() * hand.D * s.asDiagonal());
}

void add_velocities(Compilation& compilation, const SharedHand& hand,
                    const std::vector<double>& scales, sim::SharedHandOptions& options) {
  if (hand.velocity_m_s.empty()) return;
  if (hand.velocity_m_s.size() != scales.size()) {
    compilation.refuse(std::string(kPath) + ".velocity_m_s",
                       "expected one number for each of the " + std::to_string(scales.size()) +
                           " coordinates, found " + std::to_string(hand.velocity_m_s.size()));
    return;
  }
  for (std::size_t i = 0; i < scales.size(); ++i)
    options.axes[i].velocity_m_s = hand.velocity_m_s[i] / scales[i];
}

}  // namespace

void compile_shared_hand(Compilation& compilation) {
  if (!compilation.config.sim.hand) return;
  const SharedHand& hand = *compilation.config.sim.hand;
  sim::SharedHandOptions options;
  const std::vector<double> scales = add_axes(compilation, hand, options);
  if (scales.empty()) return;
  const auto system = linear_system(compilation, hand.state_space, scales.size(),
                                    std::string(kPath) + ".state_space");
  if (!system) return;
  add_matrices(*system, scales, options);
  add_velocities(compilation, hand, scales, options);
  compilation.shared_hand = std::move(options);
}

}  // namespace hapticd::config
