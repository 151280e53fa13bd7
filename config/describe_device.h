// What each key of a device is; part of config/describe.h.
#pragma once
#include "config/describe_axis.h"
#include "config/describe_sim.h"
#include "config/describe_usb.h"
#include "config/key.h"
#include "config/schema_device.h"
#include "control/core/capacity.h"

namespace hapticd::config {

template <class V>
void describe(V& v, Cartesian& s) {
  v.required("directions", s.directions,
             {.about = "axis i moves the contact along the i-th of these directions",
              .min_items = 1,
              .max_items = kMaxContactCoordinates});
}

template <class V>
void describe(V& v, FiveBar& s) {
  v.required("link_m", s.link_m,
             {.about = "length of each of the four links",
              .min = 0,
              .max = 10,
              .above_min = true,
              .unit = "m"});
  v.required("base_m", s.base_m,
             {.about = "distance of the two motors, at -base_m/2 and base_m/2 on x; below four "
                       "times link_m",
              .min = 0,
              .max = 10,
              .unit = "m"});
}

template <class V>
void describe(V& v, Delta& s) {
  const auto length = [&](const char* name, double& field, const char* about, bool positive) {
    v.optional(name, field,
               {.about = about,
                .min = positive ? 0.0 : -10.0,
                .max = 10,
                .above_min = positive,
                .unit = "m"});
  };
  length("a_m", s.a_m, "driven arm", true);
  length("b_m", s.b_m, "parallelogram, its long sides", true);
  length("c_m", s.c_m, "tip to the joint of the parallelogram, outwards", false);
  length("d_m", s.d_m, "arm to parallelogram", false);
  length("e_m", s.e_m, "parallelogram to tip", false);
  length("f_m", s.f_m, "tip to the joint of the parallelogram, sideways", false);
  length("r_m", s.r_m, "base to the motor's axis, outwards", false);
  length("s_m", s.s_m, "base to the motor's axis, sideways", false);
  v.optional(
      "legs_deg", s.legs_deg,
      {.about = "where the three legs stand around z", .min = -360, .max = 360, .unit = "degrees"});
  v.optional("home_m", s.home_m,
             {.about = "a tip position inside the workspace: the solution nearest to it is taken",
              .min = -10,
              .max = 10,
              .unit = "m"});
}

template <class V>
void describe(V& v, SerialJoint& s) {
  v.optional("theta_rad", s.theta_rad,
             {.about = "angle about z of the joint before", .min = -10, .max = 10, .unit = "rad"});
  v.optional("d_m", s.d_m, {.about = "offset along that z", .min = -10, .max = 10, .unit = "m"});
  v.optional("a_m", s.a_m, {.about = "length along the new x", .min = -10, .max = 10, .unit = "m"});
  v.optional("alpha_rad", s.alpha_rad,
             {.about = "twist about the new x", .min = -10, .max = 10, .unit = "rad"});
  v.optional("prismatic", s.prismatic,
             {.about = "the axis adds to d_m, not to theta_rad; it is then linear"});
  v.optional("mass_kg", s.mass_kg,
             {.about = "of the link behind the joint, for gravity compensation",
              .min = 0,
              .max = 1000,
              .unit = "kg"});
  v.optional("center_m", s.center_m,
             {.about = "its centre of mass, in the frame behind the joint",
              .min = -10,
              .max = 10,
              .unit = "m"});
}

template <class V>
void describe(V& v, Serial& s) {
  v.required("joints", s.joints,
             {.about = "from the base to the tip, one for each axis: standard "
                       "Denavit-Hartenberg figures",
              .min_items = 1,
              .max_items = kMaxJoints});
}

template <class V>
void describe(V& v, Pose& s) {
  v.optional(
      "position_m", s.position_m,
      {.about = "of the device's origin in the world", .min = -100, .max = 100, .unit = "m"});
  v.optional("rotation_quaternion", s.rotation_quaternion,
             {.about = "from the device's frame to the world's: w, x, y, z, of length 1",
              .min = -2,
              .max = 2});
}

template <class V>
void describe(V& v, ContactModel& s) {
  v.required("mass_kg", s.mass_kg,
             {.about = "what the tip weighs along this direction",
              .min = 0,
              .max = 1000,
              .above_min = true,
              .unit = "kg"});
  v.required("damping_Ns_m", s.damping_Ns_m,
             {.about = "viscous damping along it", .min = 0, .max = 1e5, .unit = "N s/m"});
}

template <class V>
void describe(V& v, ContactCoordinate& s) {
  v.required("model", s.model, {.about = "of the device along this direction"});
  v.required("observer", s.observer, {.about = "disturbance observer along it"});
}

template <class V>
void describe(V& v, Contact& s) {
  v.optional("x", s.x, {.about = "along world x; null: no observer"});
  v.optional("y", s.y, {.about = "along world y; null: no observer"});
  v.optional("z", s.z, {.about = "along world z; null: no observer"});
}

template <class V>
void describe(V& v, Gravity& s) {
  v.optional(
      "tip_mass_kg", s.tip_mass_kg,
      {.about = "mass at the tip that the motors hold", .min = 0, .max = 1000, .unit = "kg"});
  v.optional("acceleration_m_s2", s.acceleration_m_s2,
             {.about = "of gravity, in world directions x, y, z",
              .min = -100,
              .max = 100,
              .unit = "m/s^2"});
}

template <class V>
void describe(V& v, ForceSensor& s) {
  v.required("directions", s.directions,
             {.about = "analogue input i measures the hand's force along the i-th of these, in "
                       "the device's frame",
              .min_items = 1,
              .max_items = kMaxContactCoordinates});
}

template <class V>
void describe(V& v, EnableInput& s) {
  v.required("bit", s.bit, {.about = "which digital input", .min = 0, .max = 31});
  v.optional("active", s.active, {.about = "its value where forces may be on"});
  v.optional("role", s.role,
             {.about = "let go, a dead_man fades forces out and in again; an estop is a fault"});
}

template <class V>
void describe(V& v, WorkspaceBox& s) {
  v.required("min_m", s.min_m,
             {.about = "least world x, y, z of the contact", .min = -100, .max = 100, .unit = "m"});
  v.required("max_m", s.max_m,
             {.about = "largest world x, y, z", .min = -100, .max = 100, .unit = "m"});
}

template <class V>
void describe(V& v, PassivityController& s) {
  v.optional("budget_J", s.budget_J,
             {.about = "energy that the scene may give out beyond what it has taken in",
              .min = 0,
              .max = 10,
              .above_min = true,
              .unit = "J"});
  v.optional(
      "damping_share", s.damping_share,
      {.about = "share of the device's own damping that counts as paid in", .min = 0, .max = 0.95});
  v.optional("leak_s", s.leak_s,
             {.about = "time constant by which saved energy is forgotten; null: never",
              .min = 0.01,
              .max = 10'000,
              .unit = "s"});
}

template <class V>
void describe(V& v, Guard& s) {
  v.optional("max_force_N", s.max_force_N,
             {.about = "norm of the contact force at the hand; null: the device's smallest "
                       "actuator.max_force_N; devices with a linkage need it",
              .min = 0,
              .max = 10'000,
              .above_min = true,
              .unit = "N"});
  v.optional("max_velocity_m_s", s.max_velocity_m_s,
             {.about = "of a linear axis, beyond it a fault; null: 1.5 m/s",
              .min = 0,
              .max = 100,
              .above_min = true,
              .unit = "m/s"});
  v.optional("max_velocity_rad_s", s.max_velocity_rad_s,
             {.about = "of a rotary axis, beyond it a fault; null: 10 rad/s",
              .min = 0,
              .max = 1000,
              .above_min = true,
              .unit = "rad/s"});
  v.optional("max_slew_N_s", s.max_slew_N_s,
             {.about = "change of the contact force; null: max_force_N in 5 ms",
              .min = 0,
              .max = 1e9,
              .above_min = true,
              .unit = "N/s"});
  v.optional("ramp_s", s.ramp_s,
             {.about = "forces fade in and out in this time; null: 0.5 s",
              .min = 0,
              .max = 60,
              .unit = "s"});
  v.optional("max_stale_ticks", s.max_stale_ticks,
             {.about = "more ticks in a row without a new sample are a fault; null: 3",
              .min = 0,
              .max = 1000,
              .unit = "ticks"});
  v.optional("max_power_W", s.max_power_W,
             {.about = "mechanical power of all motors of a device; null: not limited",
              .min = 0,
              .max = 1e5,
              .above_min = true,
              .unit = "W"});
  v.optional("workspace", s.workspace,
             {.about = "box that the contact may be in, else a fault; null: anywhere"});
  v.optional("passivity_controller", s.passivity_controller,
             {.about = "takes force away where the scene gives out energy; null: none"});
}

template <class V>
void describe(V& v, CanBus& s) {
  v.required("interface", s.interface, {.about = "the CAN interface, such as can0"});
  v.required("watchdog_s", s.watchdog_s,
             {.about = "a drive that hears no command for so long goes off by itself: longer than "
                       "the ticks of guard.max_stale_ticks and one more, at most 50 ms; read back "
                       "from the drive, or proved by silence, before it is armed",
              .min = 0,
              .max = 0.05,
              .above_min = true,
              .unit = "s"});
  v.optional("timing", s.timing,
             {.about = "when drives measure: asked for in each tick (any driver), on their own "
                       "clock (odrive), with each command (moteus); null: free_running, "
                       "reply_to_command, and for cia402 in_phase, by SYNC"});
  v.optional("bitrate_Hz", s.bitrate_Hz,
             {.about = "of the interface", .min = 10'000, .max = 1e6, .unit = "Hz"});
  v.optional("data_bitrate_Hz", s.data_bitrate_Hz,
             {.about = "moteus: of the data of FD frames", .min = 1e5, .max = 1e7, .unit = "Hz"});
  v.optional("turnaround_s", s.turnaround_s,
             {.about = "a drive begins to answer so long after a question, at most",
              .min = 0,
              .max = 0.1,
              .unit = "s"});
  v.optional("drive_delay_s", s.drive_delay_s,
             {.about = "a torque acts so long after its frame came, at most",
              .min = 0,
              .max = 0.1,
              .unit = "s"});
  v.optional("estimates_every_s", s.estimates_every_s,
             {.about = "odrive, free_running: time between its positions, "
                       "encoder_msg_rate_ms of the drive",
              .min = 0.001,
              .max = 1,
              .unit = "s"});
  v.optional("heartbeat_every_s", s.heartbeat_every_s,
             {.about = "time between heartbeats of a drive: odrive as set in it "
                       "(heartbeat_msg_rate_ms), cia402 is told",
              .min = 0.001,
              .max = 1,
              .unit = "s"});
  v.optional("host_id", s.host_id,
             {.about = "of hapticd on the bus: moteus 0 to 127; cia402 1 to 127, 0 stands for 127",
              .min = 0,
              .max = 127});
  v.optional("prefix", s.prefix,
             {.about = "moteus: can.prefix of the servos", .min = 0, .max = 8191});
  v.optional("ignore_position_bounds", s.ignore_position_bounds,
             {.about = "moteus: torque beyond servopos.position_min and position_max too, which "
                       "are very narrow as delivered"});
}

template <class V>
void describe(V& v, Device& s) {
  v.required("name", s.name, {.about = "of the device, unique", .form = TextForm::name});
  v.required("driver", s.driver, {.about = "what speaks to the device"});
  v.optional(
      "sim", s.sim,
      {.about = "truth of a simulated device, or of one that `hapticctl emulate` stands in for; "
                "null: it equals the model"});
  v.optional("can", s.can, {.about = "the bus, with a driver for CAN; null: none"});
  v.optional("usb", s.usb,
             {.about = "which device on USB, and its times; hid_report needs it, null: a falcon or "
                       "openffboard with the defaults"});
  v.optional("falcon", s.falcon, {.about = "of a falcon; null: the defaults"});
  v.optional("report", s.report, {.about = "of a hid_report, which needs it: what its bytes are"});
  v.optional("openffboard", s.openffboard, {.about = "of an openffboard, which needs it"});
  v.required("kinematics", s.kinematics,
             {.about = "how axes move the contact: a map with one key, the kind"});
  v.optional("pose", s.pose, {.about = "where the device stands in the world"});
  v.optional("workspace_scale", s.workspace_scale,
             {.about = "the contact moves this much in the world where the hand moves 1",
              .min = 0.001,
              .max = 1000});
  v.optional("tool_radius_m", s.tool_radius_m,
             {.about = "in the world: the tool is a ball of this radius; 0: a point",
              .min = 0,
              .max = 10,
              .unit = "m"});
  v.required("latency_s", s.latency_s,
             {.about = "worst time from sample to force that the proof assumes",
              .min = 0,
              .max = 0.1,
              .unit = "s"});
  v.required(
      "axes", s.axes,
      {.about = "what is measured and driven", .min_items = 1, .max_items = kMaxAxesPerDevice});
  v.optional("contact", s.contact,
             {.about = "observers along world directions, instead of those of axes"});
  v.optional("gravity", s.gravity,
             {.about = "weight of tip and links that the motors hold; null: none"});
  v.optional("force_sensor", s.force_sensor,
             {.about = "what measures the hand's force; null: nothing"});
  v.optional("enable_inputs", s.enable_inputs,
             {.about = "digital inputs that forces depend on", .max_items = 32});
  v.optional("guard", s.guard,
             {.about = "limits of this device; each key overrides the one of the global guard"});
}

}  // namespace hapticd::config
