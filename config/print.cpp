#include "config/print.h"

#include <variant>

#include "config/axis_values.h"
#include "config/describe.h"
#include "config/effective_guard.h"
#include "config/number.h"
#include "config/print_axis.h"
#include "config/print_can.h"
#include "config/print_usb.h"
#include "config/print_world.h"

namespace hapticd::config {
namespace {

template <class List, class Text>
std::string joined(const List& list, Text text) {
  std::string all;
  for (const auto& item : list) all += (all.empty() ? "" : ", ") + std::string(text(item));
  return all;
}

std::string loop_text(const Config& config) {
  const Loop& loop = config.loop;
  return "loop: " + with_unit(loop.rate_Hz, "Hz") + ", priority " + std::to_string(loop.priority) +
         (loop.cpu ? ", on CPU " + std::to_string(*loop.cpu) : "") + "; a fault beyond a gap of " +
         std::to_string(loop.max_gap_ticks) + " ticks or " + std::to_string(loop.max_missed_per_s) +
         " missed ticks per second\n" +
         "forces come on: " + std::string(word_of(config.start.enable)) +
         "; demanded: " + std::string(word_of(config.stability.require)) + "\n";
}

std::string kinematics_text(const Device& device) {
  if (const auto* cartesian = std::get_if<Cartesian>(&device.kinematics))
    return joined(cartesian->directions, word_of<Direction>);
  return std::visit(
      [](const auto& kind) { return std::string(kKindOf<std::decay_t<decltype(kind)>>); },
      device.kinematics);
}

/// Where it stands, if not at the origin.
std::string pose_text(const Device& device) {
  if (device.pose == Pose{} && device.workspace_scale == 1) return {};
  return "  stands at [" + joined(device.pose.position_m, format_number) + "] m, rotation [" +
         joined(device.pose.rotation_quaternion, format_number) + "], workspace scaled by " +
         format_number(device.workspace_scale) + "\n";
}

std::string guard_text(const EffectiveGuard& guard, bool rotary) {
  std::string text = "  guard: " + with_unit(guard.max_force_N, "N") + ", " +
                     (rotary ? with_unit(guard.max_velocity_rad_s, "rad/s")
                             : with_unit(guard.max_velocity_m_s, "m/s")) +
                     ", " + with_unit(guard.max_slew_N_s, "N/s") + ", ramp " +
                     with_unit(guard.ramp_s, "s") + ", at most " +
                     std::to_string(guard.max_stale_ticks) + " stale ticks" +
                     (guard.max_power_W ? ", " + with_unit(*guard.max_power_W, "W") : "") + "\n";
  if (guard.workspace) {
    text += "  workspace: [" + joined(guard.workspace->min_m, format_number) + "] to [" +
            joined(guard.workspace->max_m, format_number) + "] m\n";
  }
  if (guard.passivity_controller) {
    text += "  passivity controller: budget " +
            with_unit(guard.passivity_controller->budget_J, "J") + "\n";
  }
  return text;
}

std::string inputs_text(const Device& device) {
  std::string text;
  for (const EnableInput& input : device.enable_inputs) {
    text += "  input " + std::to_string(input.bit) + " is " + std::string(word_of(input.role)) +
            ": forces while " + (input.active ? "1" : "0") + "\n";
  }
  return text;
}

std::string assumed_text(const check::DeviceAssumption& assumed, bool rotary) {
  std::string text = "  assumed: latency " + with_unit(assumed.latency_s, "s");
  if (!assumed.min_damping.empty()) {
    text += ", damping at least " + joined(assumed.min_damping, format_number) + " " +
            damping_unit(rotary);
  }
  return text + "\n";
}

std::string device_text(const Compiled& compiled, std::size_t index) {
  const Config& config = compiled.document.config;
  const Device& device = config.devices[index];
  const control::Plan& plan = compiled.program->plan();
  const bool rotary = device.axes.front().kind == AxisKind::rotary;
  std::string text = "device " + device.name + " (" + std::string(word_of(device.driver)) +
                     "): contact " + kinematics_text(device) + "\n" + pose_text(device);
  const auto* cartesian = std::get_if<Cartesian>(&device.kinematics);
  for (std::size_t i = 0; i < device.axes.size(); ++i) {
    const std::string along =
        cartesian ? " along " + std::string(word_of(cartesian->directions[i])) : "";
    text += axis_text(plan, plan.devices[index].first_axis + i, device.axes[i], along);
  }
  return text + drives_text(compiled, index) + usb_text(compiled, index) +
         guard_text(effective_guard(config.guard, device), rotary) + inputs_text(device) +
         assumed_text(compiled.assumed[index], rotary);
}

std::string files_text(const Config& config) {
  const Telemetry& telemetry = config.telemetry;
  return "control socket: " + config.control.socket + "\n" + "flight recorder: " +
         (telemetry.flight_dir.empty()
              ? "none"
              : telemetry.flight_dir + ", " + with_unit(telemetry.flight_s, "s") +
                    " before a fault") +
         "\n" + "recording: " + telemetry.record.value_or("none") + "\n";
}

}  // namespace

std::string describe_plan(const Compiled& compiled) {
  const Config& config = compiled.document.config;
  std::string text =
      "config " + compiled.document.path + ", digest " + compiled.document.digest + "\n";
  text += loop_text(config);
  for (std::size_t i = 0; i < config.devices.size(); ++i) text += device_text(compiled, i);
  text += buses_text(compiled);
  return text + world_text(compiled) + files_text(config);
}

}  // namespace hapticd::config
