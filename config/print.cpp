#include "config/print.h"

#include <variant>

#include "config/describe.h"
#include "config/effective_guard.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

std::string si(double value, const char* unit) {
  return format_number(value) + " " + unit;
}

template <class List, class Text>
std::string joined(const List& list, Text text) {
  std::string all;
  for (const auto& item : list) all += (all.empty() ? "" : ", ") + std::string(text(item));
  return all;
}

std::string loop_text(const Config& config) {
  const Loop& loop = config.loop;
  return "loop: " + si(loop.rate_Hz, "Hz") + ", priority " + std::to_string(loop.priority) +
         (loop.cpu ? ", on CPU " + std::to_string(*loop.cpu) : "") + "; a fault beyond a gap of " +
         std::to_string(loop.max_gap_ticks) + " ticks or " + std::to_string(loop.max_missed_per_s) +
         " missed ticks per second\n" +
         "forces come on: " + std::string(word_of(config.start.enable)) +
         "; demanded: " + std::string(word_of(config.stability.require)) + "\n";
}

std::string axis_text(const Axis& axis, const control::AxisPlan& plan, Direction direction) {
  const Encoder& encoder = axis.encoder;
  std::string text =
      "  axis " + axis.name + " along " + std::string(word_of(direction)) + ": " +
      si(encoder.counts_per_m, "counts/m") + (encoder.reversed ? ", reversed" : "") +
      (encoder.bits > 0 ? ", wraps every " + si(plan.modulus_raw / encoder.counts_per_m, "m")
                        : "") +
      ", actuator " + si(plan.max_effort, "N") + "\n";
  if (!axis.model) return text + "    no model: nothing can be proved\n";
  const AxisModel& model = *axis.model;
  return text + "    model: " + si(model.mass_kg, "kg") + " +- " +
         si(100 * model.mass_uncertainty, "%") + ", " + si(model.damping_Ns_m, "N s/m") + " +- " +
         si(100 * model.damping_uncertainty, "%") + "\n";
}

std::string device_text(const Compiled& compiled, std::size_t index) {
  const Config& config = compiled.document.config;
  const Device& device = config.devices[index];
  const control::DevicePlan& plan = compiled.program->plan().devices[index];
  const EffectiveGuard guard = effective_guard(config.guard, device);
  const check::DeviceAssumption& assumed = compiled.assumed[index];
  std::string text = "device " + device.name + " (" + std::string(word_of(device.driver)) +
                     "): contact " +
                     joined(device.kinematics.cartesian.directions, word_of<Direction>) + "\n";
  for (std::size_t i = 0; i < device.axes.size(); ++i) {
    text += axis_text(device.axes[i], compiled.program->plan().axes[plan.first_axis + i],
                      device.kinematics.cartesian.directions[i]);
  }
  text += "  guard: " + si(guard.max_force_N, "N") + ", " + si(guard.max_velocity_m_s, "m/s") +
          ", " + si(guard.max_slew_N_s, "N/s") + ", ramp " + si(guard.ramp_s, "s") + ", at most " +
          std::to_string(guard.max_stale_ticks) + " stale ticks\n";
  text += "  assumed: latency " + si(assumed.latency_s, "s");
  if (!assumed.min_damping.empty())
    text += ", damping at least " + joined(assumed.min_damping, format_number) + " N s/m";
  return text + "\n";
}

std::string object_text(const Config& config, const Plane& plane) {
  const std::string felt_by = plane.devices.empty()
                                  ? joined(config.devices, [](const Device& d) { return d.name; })
                                  : joined(plane.devices, [](const std::string& n) { return n; });
  return "plane " + plane.name + ": normal [" + joined(plane.normal, format_number) + "], offset " +
         si(plane.offset_m, "m") + ", " + si(plane.stiffness_N_m, "N/m") + ", " +
         si(plane.damping_Ns_m, "N s/m") + ", felt by " + felt_by + "\n";
}

std::string files_text(const Config& config) {
  const Telemetry& telemetry = config.telemetry;
  return "control socket: " + config.control.socket + "\n" + "flight recorder: " +
         (telemetry.flight_dir.empty()
              ? "none"
              : telemetry.flight_dir + ", " + si(telemetry.flight_s, "s") + " before a fault") +
         "\n" + "recording: " + telemetry.record.value_or("none") + "\n";
}

}  // namespace

std::string describe_plan(const Compiled& compiled) {
  const Config& config = compiled.document.config;
  std::string text =
      "config " + compiled.document.path + ", digest " + compiled.document.digest + "\n";
  text += loop_text(config);
  for (std::size_t i = 0; i < config.devices.size(); ++i) text += device_text(compiled, i);
  if (config.scene.empty()) text += "scene: empty\n";
  for (const SceneObject& object : config.scene) {
    text += std::visit([&](const auto& shape) { return object_text(config, shape); }, object);
  }
  return text + files_text(config);
}

}  // namespace hapticd::config
