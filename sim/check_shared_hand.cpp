#include "sim/check_shared_hand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "control/core/capacity.h"
#include "sim/check_options.h"
#include "sim/check_value.h"

namespace hapticd::sim {
namespace {

constexpr std::size_t kMaxStates = 64;

std::string held_problem(const HeldAxis& held, std::span<const DeviceOptions> devices) {
  if (held.device >= devices.size()) {
    return expected("device", "one of " + std::to_string(devices.size()) + ", counted from 0",
                    static_cast<double>(held.device));
  }
  const DeviceOptions& device = devices[held.device];
  if (held.axis >= device.axes.size()) {
    return expected("axis", "an axis of device " + device.name, static_cast<double>(held.axis));
  }
  return first_not_finite(std::array{Field{"velocity_m_s", held.velocity_m_s}});
}

std::string axes_problem(const SharedHandOptions& hand, std::span<const DeviceOptions> devices) {
  if (hand.axes.empty()) return expected("axes", "at least one", 0);
  for (auto held = hand.axes.begin(); held != hand.axes.end(); ++held) {
    const std::string problem = held_problem(*held, devices);
    if (!problem.empty()) return problem;
    const auto same = [&](const HeldAxis& other) {
      return other.device == held->device && other.axis == held->axis;
    };
    if (std::any_of(hand.axes.begin(), held, same)) {
      return "axes: expected each once, found axis " + std::to_string(held->axis) + " of device " +
             devices[held->device].name + " twice";
    }
  }
  return {};
}

std::string matrix_problem(std::string_view name, const std::vector<double>& values,
                           std::size_t rows, std::size_t columns) {
  if (values.size() != rows * columns) {
    return expected(name, std::to_string(rows) + " x " + std::to_string(columns) + " numbers",
                    static_cast<double>(values.size()));
  }
  for (const double value : values)
    if (!std::isfinite(value)) return expected(name, "numbers", value);
  return {};
}

std::string matrices_problem(const SharedHandOptions& hand) {
  const std::size_t n = hand.states, m = hand.axes.size();
  if (n > kMaxStates) return expected("states", "at most 64", static_cast<double>(n));
  std::string problem = matrix_problem("A", hand.A, n, n);
  if (problem.empty()) problem = matrix_problem("B", hand.B, n, m);
  if (problem.empty()) problem = matrix_problem("C", hand.C, m, n);
  if (problem.empty()) problem = matrix_problem("D", hand.D, m, m);
  return problem;
}

std::string axis_problem(const AxisOptions& axis) {
  if (axis.coulomb_N > 0) return expected("coulomb_N", "0 where a hand is shared", axis.coulomb_N);
  if (axis.stops) return "stops: expected none where a hand is shared, found some";
  return {};
}

// `first` is a device of the same hand: they move together, so time is cut alike.
std::string device_problem(const DeviceOptions& device, const DeviceOptions& first) {
  if (device.linkage) return "linkage: expected none where a hand is shared, found one";
  std::string problem = first_problem(device);
  if (!problem.empty()) return problem;
  const HandOptions& own = device.hand;
  if (own.mass_kg > 0 || own.stiffness_N_m > 0 || own.damping_Ns_m > 0 || !own.script.empty())
    return "hand: expected none of its own where a hand is shared, found one";
  if (device.period_s != first.period_s) {
    return expected("period_s", "that of device " + first.name + ", " + text(first.period_s),
                    device.period_s);
  }
  if (device.substeps != first.substeps) {
    return expected("substeps",
                    "those of device " + first.name + ", " + std::to_string(first.substeps),
                    device.substeps);
  }
  for (std::size_t i = 0; i < device.axes.size(); ++i) {
    problem = axis_problem(device.axes[i]);
    if (!problem.empty()) return "axis " + std::to_string(i) + ": " + problem;
  }
  return {};
}

}  // namespace

std::string shared_hand_problem(const SharedHandOptions& hand,
                                std::span<const DeviceOptions> devices) {
  std::string problem = axes_problem(hand, devices);
  if (problem.empty()) problem = matrices_problem(hand);
  if (!problem.empty()) return problem;
  const DeviceOptions& first = devices[hand.axes[0].device];
  std::vector<std::size_t> seen;
  std::size_t axes = 0;
  for (const HeldAxis& held : hand.axes) {
    if (std::find(seen.begin(), seen.end(), held.device) != seen.end()) continue;
    seen.push_back(held.device);
    const DeviceOptions& device = devices[held.device];
    problem = device_problem(device, first);
    if (!problem.empty()) return "device " + device.name + ": " + problem;
    axes += device.axes.size();
  }
  if (axes <= kMaxAxes) return {};
  return expected("axes", "at most " + std::to_string(kMaxAxes) + " of all devices held together",
                  static_cast<double>(axes));
}

}  // namespace hapticd::sim
