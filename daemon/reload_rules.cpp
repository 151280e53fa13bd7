#include "daemon/reload_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>

namespace hapticd::daemon {
namespace {

/// Collects the keys that differ.
class Differences {
 public:
  void compare(bool same, const std::string& key) {
    if (same) return;
    lines_.push_back(fmt::format(
        "{} changed: disable first, stop hapticd and start it with the new config", key));
  }
  std::vector<std::string> take() { return std::move(lines_); }

 private:
  std::vector<std::string> lines_;
};

void compare_loop(const config::Loop& a, const config::Loop& b, Differences& found) {
  found.compare(a.rate_Hz == b.rate_Hz, "loop.rate_Hz");
  found.compare(a.priority == b.priority, "loop.priority");
  found.compare(a.cpu == b.cpu, "loop.cpu");
  found.compare(a.max_gap_ticks == b.max_gap_ticks, "loop.max_gap_ticks");
  found.compare(a.max_missed_per_s == b.max_missed_per_s, "loop.max_missed_per_s");
}

void compare_axis(const config::Axis& a, const config::Axis& b, const std::string& key,
                  Differences& found) {
  config::Encoder encoder = b.encoder;
  encoder.stuck_s = a.encoder.stuck_s;     // a watch of the guard, not a property of the axis
  config::Actuator actuator = b.actuator;  // and so is the motor's temperature
  actuator.continuous_force_N = a.actuator.continuous_force_N;
  actuator.continuous_torque_Nm = a.actuator.continuous_torque_Nm;
  actuator.thermal_time_s = a.actuator.thermal_time_s;
  found.compare(a.name == b.name, key + ".name");
  found.compare(a.kind == b.kind, key + ".kind");
  found.compare(a.encoder == encoder, key + ".encoder");
  found.compare(a.actuator == actuator, key + ".actuator");
  found.compare(a.homing == b.homing, key + ".homing");
  found.compare(a.can == b.can, key + ".can");
  // Their efforts would step under the hand: the fade of a swapped plan knows contact forces alone.
  found.compare(a.observer == b.observer, key + ".observer");
  found.compare(a.compensation == b.compensation, key + ".compensation");
}

bool same_stops(const std::optional<sim::StopOptions>& a,
                const std::optional<sim::StopOptions>& b) {
  if (!a || !b) return !a && !b;
  return a->min_m == b->min_m && a->max_m == b->max_m;
}

bool same_plant(const sim::AxisOptions& a, const sim::AxisOptions& b) {
  const auto all = [](const sim::AxisOptions& o) {
    return std::tie(o.mass_kg, o.damping_Ns_m, o.coulomb_N, o.delay_s, o.position_m, o.counts_per_m,
                    o.encoder_bits, o.noise_counts, o.dac_step_N, o.max_effort_N, o.relative,
                    o.index_m, o.homed_at_s);
  };
  return all(a) == all(b) && same_stops(a.stops, b.stops);
}

bool same_sensor(const std::optional<sim::ForceSensorOptions>& a,
                 const std::optional<sim::ForceSensorOptions>& b) {
  if (!a || !b) return !a && !b;
  return a->noise_N == b->noise_N;
}

/// The plant as it was compiled: what `sim` leaves out follows the model, so the file alone does
/// not tell. ramp_s is not held against the other: it follows the guard, which may change.
void compare_simulated(const sim::DeviceOptions& a, const sim::DeviceOptions& b,
                       const std::string& key, Differences& found) {
  const bool axes =
      std::equal(a.axes.begin(), a.axes.end(), b.axes.begin(), b.axes.end(), same_plant);
  found.compare(axes, key + ".sim.axes (or the model that a simulated axis takes its values from)");
  found.compare(same_sensor(a.force_sensor, b.force_sensor),
                key + ".sim.force_sensor (or the device's force_sensor, which it follows)");
}

void compare_sim(const config::Sim& a, const config::Sim& b, const std::string& key,
                 Differences& found) {
  found.compare(a.linkage == b.linkage, key + ".sim.linkage");
  found.compare(a.hand == b.hand, key + ".sim.hand");
  found.compare(a.substeps == b.substeps, key + ".sim.substeps");
  found.compare(a.seed == b.seed, key + ".sim.seed");
  found.compare(a.digital == b.digital, key + ".sim.digital");
  found.compare(a.failures == b.failures, key + ".sim.failures");
}

void compare_device(const config::Device& a, const config::Device& b, const std::string& key,
                    Differences& found) {
  found.compare(a.name == b.name, key + ".name");
  found.compare(a.driver == b.driver, key + ".driver");
  found.compare(a.can == b.can, key + ".can");
  found.compare(a.usb == b.usb, key + ".usb");
  found.compare(a.falcon == b.falcon, key + ".falcon");
  found.compare(a.report == b.report, key + ".report");
  found.compare(a.openffboard == b.openffboard, key + ".openffboard");
  found.compare(a.kinematics == b.kinematics, key + ".kinematics");
  found.compare(a.pose == b.pose, key + ".pose");
  found.compare(a.gravity == b.gravity, key + ".gravity");
  found.compare(a.contact == b.contact, key + ".contact");
  found.compare(a.workspace_scale == b.workspace_scale, key + ".workspace_scale");
  compare_sim(a.sim.value_or(config::Sim{}), b.sim.value_or(config::Sim{}), key, found);
  found.compare(a.axes.size() == b.axes.size(), key + ".axes (their number)");
  for (std::size_t i = 0; i < std::min(a.axes.size(), b.axes.size()); ++i) {
    compare_axis(a.axes[i], b.axes[i], fmt::format("{}.axes[{}]", key, i), found);
  }
}

}  // namespace

std::vector<std::string> reload_obstacles(const config::Compiled& running,
                                          const config::Compiled& fresh) {
  const config::Config& a = running.document.config;
  const config::Config& b = fresh.document.config;
  Differences found;
  compare_loop(a.loop, b.loop, found);
  found.compare(a.control.socket == b.control.socket, "control.socket");
  found.compare(a.devices.size() == b.devices.size(), "devices (their number)");
  for (std::size_t i = 0; i < std::min(a.devices.size(), b.devices.size()); ++i) {
    const std::string key = fmt::format("devices[{}]", i);
    compare_device(a.devices[i], b.devices[i], key, found);
    if (i < running.simulated.size() && i < fresh.simulated.size()) {
      compare_simulated(running.simulated[i], fresh.simulated[i], key, found);
    }
  }
  return found.take();
}

std::vector<std::string> latency_obstacles(const build::ProgramSpec& running,
                                           const build::ProgramSpec& fresh) {
  Differences found;
  for (std::size_t i = 0; i < std::min(running.axes.size(), fresh.axes.size()); ++i) {
    const bool same = running.axes[i].delay_ticks == fresh.axes[i].delay_ticks;
    found.compare(same, "the latency of " + running.axis_names[i] + ", in whole ticks,");
  }
  return found.take();
}

}  // namespace hapticd::daemon
