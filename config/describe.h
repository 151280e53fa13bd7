// What each key of a config is: name, needed or not, range, unit, meaning. One description per
// struct of schema.h; the reader, the JSON schema and the man page's key table are visitors of it.
// The default of a key is what its struct has.
//
// A visitor offers
//   template <class T> void required(const char* key, T& field, const Key& about);
//   template <class T> void optional(const char* key, T& field, const Key& about);
//
// A new kind of scene object: a struct in schema.h, its place in SceneObject, a describe() here,
// its kKindOf in key.h, and the lines in compile_scene.cpp that turn it into an array of the plan.
#pragma once
#include "config/key.h"
#include "config/schema.h"
#include "control/core/capacity.h"

namespace hapticd::config {

template <class V>
void describe(V& v, Loop& s) {
  v.optional("rate_Hz", s.rate_Hz,
             {.about = "ticks per second", .min = 100, .max = 8000, .unit = "Hz"});
  v.optional("priority", s.priority,
             {.about = "SCHED_FIFO priority of the servo thread", .min = 1, .max = 99});
  v.optional("cpu", s.cpu,
             {.about = "pin the servo thread to this CPU; null: any", .min = 0, .max = 1023});
  v.optional("max_gap_ticks", s.max_gap_ticks,
             {.about = "more missed ticks in a row are a fault",
              .min = 0,
              .max = 100'000,
              .unit = "ticks"});
  v.optional("max_missed_per_s", s.max_missed_per_s,
             {.about = "more missed ticks in one second are a fault", .min = 0, .max = 20'000});
}

template <class V>
void describe(V& v, Start& s) {
  v.optional(
      "enable", s.enable,
      {.about =
           "forces come on by 'hapticctl enable', or by themselves once all devices are ready"});
}

template <class V>
void describe(V& v, Encoder& s) {
  v.required("counts_per_m", s.counts_per_m,
             {.about = "encoder counts per metre of axis travel",
              .min = 0,
              .max = 1e12,
              .above_min = true,
              .unit = "counts/m"});
  v.optional("bits", s.bits, {.about = "the value wraps at 2^bits; 0: never", .min = 0, .max = 52});
  v.optional("offset_m", s.offset_m,
             {.about = "position of the axis where the encoder reads 0",
              .min = -100,
              .max = 100,
              .unit = "m"});
  v.optional("reversed", s.reversed, {.about = "the encoder counts down where the axis goes up"});
  v.optional("stuck_s", s.stuck_s,
             {.about = "the very same value for this long under at least a fifth of "
                       "guard.max_force_N is a fault; "
                       "null: not watched",
              .min = 0.001,
              .max = 60,
              .unit = "s"});
}

template <class V>
void describe(V& v, Actuator& s) {
  v.required("max_force_N", s.max_force_N,
             {.about = "what the actuator can deliver",
              .min = 0,
              .max = 10'000,
              .above_min = true,
              .unit = "N"});
}

template <class V>
void describe(V& v, AxisModel& s) {
  v.required("mass_kg", s.mass_kg,
             {.about = "moving mass, as identified",
              .min = 0,
              .max = 1000,
              .above_min = true,
              .unit = "kg"});
  v.required("damping_Ns_m", s.damping_Ns_m,
             {.about = "viscous damping, as identified", .min = 0, .max = 1e5, .unit = "N s/m"});
  v.optional("mass_uncertainty", s.mass_uncertainty,
             {.about = "share: the true mass lies within mass_kg (1 +- this)", .min = 0, .max = 1});
  v.optional(
      "damping_uncertainty", s.damping_uncertainty,
      {.about =
           "share: the true damping lies within damping_Ns_m (1 +- this); proofs use the least",
       .min = 0,
       .max = 1});
}

template <class V>
void describe(V& v, Velocity& s) {
  v.optional("estimator", s.estimator, {.about = "how velocity is got from positions"});
}

template <class V>
void describe(V& v, Observer& s) {
  v.optional("mode", s.mode, {.about = "disturbance observer"});
}

template <class V>
void describe(V& v, Axis& s) {
  v.required("name", s.name,
             {.about = "of the axis, unique in its device", .form = TextForm::name});
  v.optional("kind", s.kind, {.about = "how the axis moves"});
  v.required("encoder", s.encoder, {.about = "position sensor"});
  v.required("actuator", s.actuator, {.about = "motor and amplifier"});
  v.optional(
      "model", s.model,
      {.about =
           "what is known of the axis' own dynamics; null: nothing, so nothing can be proved"});
  v.optional("velocity", s.velocity, {.about = "velocity estimate"});
  v.optional("observer", s.observer, {.about = "compensation of disturbances"});
}

template <class V>
void describe(V& v, Cartesian& s) {
  v.required("directions", s.directions,
             {.about = "axis i moves the contact along the i-th of these world directions",
              .min_items = 1,
              .max_items = kMaxContactCoordinates});
}

template <class V>
void describe(V& v, Kinematics& s) {
  v.required("cartesian", s.cartesian,
             {.about = "every axis moves the contact along one world direction"});
}

template <class V>
void describe(V& v, SimAxis& s) {
  v.optional("mass_kg", s.mass_kg,
             {.about = "true mass; null: as the model says",
              .min = 0,
              .max = 1000,
              .above_min = true,
              .unit = "kg"});
  v.optional("damping_Ns_m", s.damping_Ns_m,
             {.about = "true viscous damping; null: as the model says",
              .min = 0,
              .max = 1e5,
              .unit = "N s/m"});
  v.optional("coulomb_N", s.coulomb_N,
             {.about = "true dry friction", .min = 0, .max = 1000, .unit = "N"});
  v.optional("delay_s", s.delay_s,
             {.about = "command to force", .min = 0, .max = 0.05, .unit = "s"});
  v.optional("position_m", s.position_m,
             {.about = "at start, at rest", .min = -100, .max = 100, .unit = "m"});
  v.optional(
      "noise_counts", s.noise_counts,
      {.about = "standard deviation of the encoder noise", .min = 0, .max = 1e6, .unit = "counts"});
  v.optional("dac_step_N", s.dac_step_N,
             {.about = "force is rounded to this; 0: exact", .min = 0, .max = 1000, .unit = "N"});
}

template <class V>
void describe(V& v, SimScriptStep& s) {
  v.required("at_s", s.at_s,
             {.about = "from this time on, counted from the end of the start ramp",
              .min = 0,
              .max = 1e6,
              .unit = "s"});
  v.optional("force_N", s.force_N,
             {.about = "held until the next step", .min = -10'000, .max = 10'000, .unit = "N"});
  v.optional("position_m", s.position_m,
             {.about = "where the hand's spring wants to be; linear between steps",
              .min = -100,
              .max = 100,
              .unit = "m"});
}

template <class V>
void describe(V& v, SimHand& s) {
  v.optional("mass_kg", s.mass_kg,
             {.about = "moves with the axis", .min = 0, .max = 1000, .unit = "kg"});
  v.optional(
      "stiffness_N_m", s.stiffness_N_m,
      {.about = "of the grip, to where the hand wants to be", .min = 0, .max = 1e6, .unit = "N/m"});
  v.optional("damping_Ns_m", s.damping_Ns_m,
             {.about = "of the grip", .min = 0, .max = 1e5, .unit = "N s/m"});
  v.optional("script", s.script,
             {.about = "what the hand does, in the order of time", .max_items = 10'000});
}

template <class V>
void describe(V& v, SimFailure& s) {
  v.required("kind", s.kind, {.about = "what goes wrong"});
  v.optional("axis", s.axis, {.about = "where; null: at the first axis", .form = TextForm::name});
  v.required("at_s", s.at_s,
             {.about = "when, counted from the first tick", .min = 0, .max = 1e6, .unit = "s"});
  v.optional("for_s", s.for_s, {.about = "for how long", .min = 0, .max = 1e6, .unit = "s"});
  v.optional("size_m", s.size_m, {.about = "of a jump", .min = -100, .max = 100, .unit = "m"});
}

template <class V>
void describe(V& v, Sim& s) {
  v.optional("axes", s.axes,
             {.about = "true plant of each axis; empty: all as their models say",
              .max_items = kMaxAxesPerDevice});
  v.optional("hand", s.hand, {.about = "the passive hand that holds every axis"});
  v.optional("substeps", s.substeps, {.about = "simulation steps per tick", .min = 1, .max = 1000});
  v.optional("seed", s.seed, {.about = "of the noise", .min = 0, .max = 4294967295.0});
  v.optional("failures", s.failures,
             {.about = "what goes wrong, for rehearsals", .max_items = 1000});
}

template <class V>
void describe(V& v, Guard& s) {
  v.optional(
      "max_force_N", s.max_force_N,
      {.about = "norm of the contact force; null: the device's smallest actuator.max_force_N",
       .min = 0,
       .max = 10'000,
       .above_min = true,
       .unit = "N"});
  v.optional("max_velocity_m_s", s.max_velocity_m_s,
             {.about = "of an axis, beyond it a fault; null: 1.5 m/s",
              .min = 0,
              .max = 100,
              .above_min = true,
              .unit = "m/s"});
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
}

template <class V>
void describe(V& v, Device& s) {
  v.required("name", s.name, {.about = "of the device, unique", .form = TextForm::name});
  v.required("driver", s.driver, {.about = "what speaks to the device"});
  v.optional(
      "sim", s.sim,
      {.about = "truth of a simulated device, only with driver: sim; null: it equals the model"});
  v.required("kinematics", s.kinematics,
             {.about = "how axes move the contact: a map with one key, the kind"});
  v.required("latency_s", s.latency_s,
             {.about = "worst time from sample to force that the proof assumes",
              .min = 0,
              .max = 0.1,
              .unit = "s"});
  v.required(
      "axes", s.axes,
      {.about = "what is measured and driven", .min_items = 1, .max_items = kMaxAxesPerDevice});
  v.optional("guard", s.guard,
             {.about = "limits of this device; each key overrides the one of the global guard"});
}

template <class V>
void describe(V& v, Plane& s) {
  v.required("name", s.name,
             {.about = "of the object, unique in the scene", .form = TextForm::name});
  v.optional("devices", s.devices,
             {.about = "which devices feel it; empty: all",
              .form = TextForm::name,
              .max_items = kMaxDevices});
  v.required("normal", s.normal,
             {.about = "towards the free side, in world directions x, y, z; any length but 0",
              .min = -1e6,
              .max = 1e6});
  v.optional("offset_m", s.offset_m,
             {.about = "distance of the surface from the origin, along the normal",
              .min = -100,
              .max = 100,
              .unit = "m"});
  v.required("stiffness_N_m", s.stiffness_N_m,
             {.about = "of the wall", .min = 0, .max = 1e7, .unit = "N/m"});
  v.optional("damping_Ns_m", s.damping_Ns_m,
             {.about = "of the wall, while it pushes", .min = 0, .max = 1e5, .unit = "N s/m"});
}

template <class V>
void describe(V& v, Stability& s) {
  v.optional(
      "require", s.require,
      {.about = "what must be proved before forces come on; none: nothing (see hapticd(8))"});
}

template <class V>
void describe(V& v, Control& s) {
  v.optional("socket", s.socket, {.about = "the socket that hapticctl talks to"});
}

template <class V>
void describe(V& v, Telemetry& s) {
  v.optional("flight_dir", s.flight_dir,
             {.about = "where the flight recorder writes; empty text: nowhere"});
  v.optional("flight_s", s.flight_s,
             {.about = "time before a fault that the flight recorder keeps",
              .min = 0.1,
              .max = 60,
              .unit = "s"});
  v.optional("record", s.record, {.about = "file that gets every record, in full; null: none"});
}

template <class V>
void describe(V& v, Config& s) {
  v.required("version", s.version, {.about = "of this format", .min = 1, .max = 1});
  v.optional("loop", s.loop, {.about = "the servo loop"});
  v.optional("start", s.start, {.about = "what happens at start"});
  v.required("devices", s.devices,
             {.about = "what is driven", .min_items = 1, .max_items = kMaxDevices});
  v.optional("scene", s.scene,
             {.about = "what can be touched; each entry is a map with one key, the kind",
              .max_items = kMaxObjects});
  v.optional("stability", s.stability, {.about = "what is demanded of the scene"});
  v.optional("guard", s.guard, {.about = "limits of every device"});
  v.optional("control", s.control, {.about = "how the daemon is talked to"});
  v.optional("telemetry", s.telemetry, {.about = "what is recorded"});
}

}  // namespace hapticd::config
