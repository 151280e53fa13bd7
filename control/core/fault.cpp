#include "control/core/fault.h"

#include <array>
#include <cstddef>

namespace hapticd {
namespace {

constexpr std::array kFaults = {
    FaultEntry{Fault::none, "none", "no fault", "", "", ""},
    FaultEntry{Fault::estop, "estop", "emergency stop was asked for", "operator",
               "make the place safe, then `hapticctl enable`", ""},
    FaultEntry{Fault::overrun, "overrun",
               "the loop missed more ticks in a row than loop.max_gap_ticks", "daemon",
               "see which phase was late in `hapticctl status`; free the CPU or raise the limit",
               "ticks"},
    FaultEntry{Fault::missed_rate, "missed_rate",
               "the loop missed more ticks within one second than loop.max_missed_per_s", "daemon",
               "see which phase was late in `hapticctl status`; free the CPU or lower loop.rate_Hz",
               "ticks"},
    FaultEntry{
        Fault::cpu_time, "cpu_time",
        "the servo thread used up its real-time CPU budget without sleeping (SIGXCPU)", "kernel",
        "lower loop.rate_Hz or simplify the scene; the limit is LimitRTTIME of the unit", ""},
    FaultEntry{Fault::suspended, "suspended", "the machine was suspended and resumed", "daemon",
               "check the devices, then `hapticctl enable`; mask sleep.target on a haptic host",
               "s"},
    FaultEntry{Fault::clock_jump, "clock_jump", "the monotonic clock ran backwards", "daemon",
               "check the clock source of this machine, then `hapticctl enable`", "s"},
    FaultEntry{Fault::device, "device", "a device reported that it cannot go on", "driver",
               "read the driver's message, mend the device, then `hapticctl enable`", ""},
    FaultEntry{Fault::disarmed, "disarmed", "a device left its armed state while forces were on",
               "driver", "check its power, watchdog and e-stop, then `hapticctl enable`", ""},
    FaultEntry{Fault::sample_missing, "sample_missing",
               "an axis gave no fresh sample for more ticks than guard.max_stale_ticks", "guard",
               "check cable, bus load and the device's rate, then `hapticctl enable`", "ticks"},
    FaultEntry{Fault::input_not_finite, "input_not_finite",
               "an axis reported a value that is not a number", "guard",
               "check the device's encoder and the driver, then `hapticctl enable`", ""},
    FaultEntry{Fault::encoder_jump, "encoder_jump",
               "an axis moved further in one tick than ten times guard.max_velocity allows",
               "guard", "check encoder cable, counts and bits of the axis, then `hapticctl enable`",
               ""},
    FaultEntry{Fault::encoder_stuck, "encoder_stuck",
               "an axis under force gave exactly the same value for longer than encoder.stuck_s",
               "guard", "check the encoder, or raise encoder.stuck_s, then `hapticctl enable`",
               "s"},
    FaultEntry{Fault::velocity, "velocity", "an axis moved faster than guard.max_velocity", "guard",
               "let the device come to rest, then `hapticctl enable`", ""},
    FaultEntry{Fault::output_not_finite, "output_not_finite",
               "a computed force was not a number: a defect of hapticd", "guard",
               "keep the flight recording and report it", ""},
    FaultEntry{
        Fault::kinematics, "kinematics", "no pose of the device fits the angles of its joints",
        "guard",
        "check encoder offsets, homing and the lengths in kinematics, then `hapticctl enable`", ""},
    FaultEntry{Fault::homing, "homing",
               "an axis did not find its reference in homing.timeout_s, or lost it", "guard",
               "see that the axis moves freely to its reference, then `hapticctl enable`", "s"},
    FaultEntry{Fault::travel, "travel",
               "an axis went beyond the end of its travel by more than travel.margin", "guard",
               "move the axis back by hand and check homing, then `hapticctl enable`", ""},
    FaultEntry{Fault::workspace, "workspace", "a contact left the box guard.workspace", "guard",
               "move the device back into the box, then `hapticctl enable`", "m"},
};
static_assert(kFaults.size() == static_cast<std::size_t>(Fault::count_));

constexpr std::array kLimits = {
    LimitEntry{Limit::ramp, "ramp", "forces are being faded in or out",
               "nothing: it ends by itself"},
    LimitEntry{Limit::force, "force", "the contact force was cut at guard.max_force_N",
               "press less, or raise the limit if device and user allow it"},
    LimitEntry{Limit::slew, "slew", "the force changed slower than computed, at guard.max_slew_N_s",
               "soften the scene, or raise the limit"},
    LimitEntry{Limit::actuator, "actuator", "an effort was cut at what the actuator can deliver",
               "lower guard.max_force_N so that the device is never asked for more than it has"},
    LimitEntry{Limit::sample_held, "sample_held",
               "an axis gave no fresh sample and the last one was held",
               "watch the count in `hapticctl status`; check bus load and cable"},
    LimitEntry{Limit::reseeded, "reseeded",
               "velocity was started anew after missed ticks or samples, and is zero for one tick",
               "watch the count of missed ticks in `hapticctl status`"},
    LimitEntry{Limit::stale, "stale",
               "forces were faded out because an axis gave no fresh sample for several ticks",
               "check bus load, cable and the device's rate"},
    LimitEntry{
        Limit::singular, "singular",
        "forces were faded out because the linkage is near a pose in which it cannot make them",
        "keep away from the edge of the workspace"},
    LimitEntry{Limit::power, "power",
               "efforts were cut so that the motors give no more than guard.max_power_W",
               "soften the scene, or raise the limit if device and user allow it"},
    LimitEntry{Limit::temperature, "temperature",
               "an effort was cut so that its motor does not overheat (actuator.thermal)",
               "press less for a while"},
    LimitEntry{Limit::travel, "travel", "an axis is pushed back from the end of its travel",
               "move the device back"},
    LimitEntry{Limit::compensation, "compensation",
               "a disturbance observer asked for more than its limit",
               "check the model of the axis, or raise the observer's limit"},
    LimitEntry{Limit::passivity, "passivity",
               "the passivity controller weakened the force because the scene gave out energy",
               "soften the scene: it is not passive on this device"},
};

}  // namespace

std::span<const FaultEntry> fault_table() noexcept {
  return kFaults;
}
std::span<const LimitEntry> limit_table() noexcept {
  return kLimits;
}

const FaultEntry& entry(Fault code) noexcept {
  const auto index = static_cast<std::size_t>(code);
  return kFaults[index < kFaults.size() ? index : 0];
}

}  // namespace hapticd
