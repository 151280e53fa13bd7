// What each key of an axis is; part of config/describe.h.
#pragma once
#include "config/describe_model.h"
#include "config/key.h"
#include "config/key_forms.h"
#include "config/schema_axis.h"
#include "control/core/capacity.h"

namespace hapticd::config {

template <class V>
void describe(V& v, Encoder& s) {
  both(v, FormOf{"counts_per_m", s.counts_per_m, "counts/m"},
       FormOf{"counts_per_rev", s.counts_per_rev, "counts/revolution"},
       {.about = "encoder counts per metre or revolution of the axis; one of them is required",
        .min = 0,
        .max = 1e12,
        .above_min = true});
  v.optional("bits", s.bits, {.about = "the value wraps at 2^bits; 0: never", .min = 0, .max = 52});
  both(v, FormOf{"offset_m", s.offset_m, "m"}, FormOf{"offset_rad", s.offset_rad, "rad"},
       {.about = "position of the axis where the encoder reads 0; null: 0",
        .min = -100,
        .max = 100});
  v.optional("reversed", s.reversed, {.about = "the encoder counts down where the axis goes up"});
  v.optional("stuck_s", s.stuck_s,
             {.about = "the very same value for this long under at least a fifth of "
                       "guard.max_force_N (of a rotary axis: of its actuator.max_torque_Nm) is a "
                       "fault; null: not watched",
              .min = 0.001,
              .max = 60,
              .unit = "s"});
}

template <class V>
void describe(V& v, Actuator& s) {
  both(v, FormOf{"max_force_N", s.max_force_N, "N"},
       FormOf{"max_torque_Nm", s.max_torque_Nm, "N m"},
       {.about = "what the actuator can deliver; one of them is required",
        .min = 0,
        .max = 10'000,
        .above_min = true});
  both(v, FormOf{"continuous_force_N", s.continuous_force_N, "N"},
       FormOf{"continuous_torque_Nm", s.continuous_torque_Nm, "N m"},
       {.about = "what the motor bears for ever without growing too hot; null: not limited",
        .min = 0,
        .max = 10'000,
        .above_min = true});
  v.optional("thermal_time_s", s.thermal_time_s,
             {.about = "time constant of the motor's temperature",
              .min = 0.1,
              .max = 10'000,
              .unit = "s"});
}

template <class V>
void describe(V& v, Velocity& s) {
  v.optional("estimator", s.estimator, {.about = "how velocity is got from positions"});
  v.optional("cutoff_Hz", s.cutoff_Hz,
             {.about = "of low_pass, below half the rate", .min = 0.1, .max = 4000, .unit = "Hz"});
  v.optional(
      "window", s.window,
      {.about = "samples that least_squares takes, and foaw at most", .min = 2, .max = kMaxWindow});
  v.optional("degree", s.degree,
             {.about = "of the polynomial of least_squares, below window", .min = 1, .max = 5});
  v.optional("noise_counts", s.noise_counts,
             {.about = "half-width of the band that foaw takes for noise",
              .min = 0.001,
              .max = 1e6,
              .unit = "counts"});
  v.optional("bandwidth_rad_s", s.bandwidth_rad_s,
             {.about = "of alpha_beta_gamma", .min = 0.1, .max = 25'000, .unit = "rad/s"});
}

template <class V>
void describe(V& v, Observer& s) {
  v.optional("mode", s.mode,
             {.about = "what the disturbance observer rejects: nothing; the difference between "
                       "model and nominal figures; all but the measured hand; all, the hand "
                       "included"});
  v.optional("order", s.order, {.about = "of its filter: equal lags", .min = 1, .max = 2});
  v.optional("cutoff_Hz", s.cutoff_Hz,
             {.about = "of each lag, below half the rate", .min = 0.01, .max = 4000, .unit = "Hz"});
  both(v, FormOf{"nominal_mass_kg", s.nominal_mass_kg, "kg"},
       FormOf{"nominal_inertia_kgm2", s.nominal_inertia_kgm2, "kg m^2"},
       {.about = "what is to be felt; null: as the model says",
        .min = 0,
        .max = 1000,
        .above_min = true});
  both(v, FormOf{"nominal_damping_Ns_m", s.nominal_damping_Ns_m, "N s/m"},
       FormOf{"nominal_damping_Nms_rad", s.nominal_damping_Nms_rad, "N m s/rad"},
       {.about = "what is to be felt; null: as the model says", .min = 0, .max = 1e5});
  v.optional("extra_delay_ticks", s.extra_delay_ticks,
             {.about = "whole ticks from command to force, beyond the loop's own",
              .min = 0,
              .max = kMaxDelayTicks,
              .unit = "ticks"});
  v.optional("blend_s", s.blend_s,
             {.about = "its output fades in over this time", .min = 0, .max = 60, .unit = "s"});
  both(v, FormOf{"max_force_N", s.max_force_N, "N"},
       FormOf{"max_torque_Nm", s.max_torque_Nm, "N m"},
       {.about = "of its output; null: as the actuator's, of a contact as guard.max_force_N",
        .min = 0,
        .max = 10'000,
        .above_min = true});
  v.optional("i_know_it_cancels_the_hand", s.i_know_it_cancels_the_hand,
             {.about = "mode classic is refused without it"});
}

template <class V>
void describe(V& v, Compensation& s) {
  v.optional(
      "viscous_share", s.viscous_share,
      {.about = "share of the model's damping that the motor takes over", .min = 0, .max = 1});
  v.optional("coulomb_share", s.coulomb_share,
             {.about = "share of the model's dry friction that the motor takes over",
              .min = 0,
              .max = 0.8});
  both(v, FormOf{"smooth_m_s", s.smooth_m_s, "m/s"},
       FormOf{"smooth_rad_s", s.smooth_rad_s, "rad/s"},
       {.about = "speed from which on dry friction is compensated in full; null: half of the "
                 "damping that viscous_share leaves stays",
        .min = 0,
        .max = 1000,
        .above_min = true});
  both(v, FormOf{"gravity_N", s.gravity_N, "N"}, FormOf{"gravity_Nm", s.gravity_Nm, "N m"},
       {.about = "constant effort that holds the axis' weight; null: 0",
        .min = -10'000,
        .max = 10'000});
  v.optional("swing_Nm", s.swing_Nm,
             {.about = "rotary axis: beside it, this times cos(position + swing_phase_rad)",
              .min = -10'000,
              .max = 10'000,
              .unit = "N m"});
  v.optional("swing_phase_rad", s.swing_phase_rad,
             {.about = "see swing_Nm", .min = -10, .max = 10, .unit = "rad"});
}

template <class V>
void describe(V& v, Homing& s) {
  v.optional("by", s.by,
             {.about = "how the axis learns where it is; none: the encoder is absolute, or reads "
                       "0 at power-on"});
  both(v, FormOf{"position_m", s.position_m, "m"}, FormOf{"position_rad", s.position_rad, "rad"},
       {.about = "of the axis at its index or stop; null: 0", .min = -100, .max = 100});
  both(v, FormOf{"search_force_N", s.search_force_N, "N"},
       FormOf{"search_torque_Nm", s.search_torque_Nm, "N m"},
       {.about = "effort of the search, its sign towards the stop, at most a quarter of the "
                 "actuator's; null or 0: by hand, only by index",
        .min = -10'000,
        .max = 10'000});
  both(v, FormOf{"search_velocity_m_s", s.search_velocity_m_s, "m/s"},
       FormOf{"search_velocity_rad_s", s.search_velocity_rad_s, "rad/s"},
       {.about = "the search gives way above it; null: 0.05 m/s, 0.5 rad/s",
        .min = 0,
        .max = 100,
        .above_min = true});
  v.optional("still_s", s.still_s,
             {.about = "standing for so long under the full effort is a stop",
              .min = 0.01,
              .max = 10,
              .unit = "s"});
  v.optional(
      "timeout_s", s.timeout_s,
      {.about = "a search that takes longer is a fault", .min = 0.1, .max = 600, .unit = "s"});
}

template <class V>
void describe(V& v, Travel& s) {
  both(v, FormOf{"min_m", s.min_m, "m"}, FormOf{"min_rad", s.min_rad, "rad"},
       {.about = "lower end of the free range; one of them is required", .min = -100, .max = 100});
  both(v, FormOf{"max_m", s.max_m, "m"}, FormOf{"max_rad", s.max_rad, "rad"},
       {.about = "upper end of the free range; one of them is required", .min = -100, .max = 100});
  both(v, FormOf{"stiffness_N_m", s.stiffness_N_m, "N/m"},
       FormOf{"stiffness_Nm_rad", s.stiffness_Nm_rad, "N m/rad"},
       {.about = "of the springs at its ends; null: 0, no springs", .min = 0, .max = 1e7});
  both(v, FormOf{"margin_m", s.margin_m, "m"}, FormOf{"margin_rad", s.margin_rad, "rad"},
       {.about = "so far beyond an end is a fault; one of them is required",
        .min = 0,
        .max = 100,
        .above_min = true});
  both(v, FormOf{"max_force_N", s.max_force_N, "N"},
       FormOf{"max_torque_Nm", s.max_torque_Nm, "N m"},
       {.about = "the springs never push more; null: as the actuator",
        .min = 0,
        .max = 10'000,
        .above_min = true});
}

template <class V>
void describe(V& v, CanDrive& s) {
  v.required("node", s.node,
             {.about = "id of the drive: odrive 0 to 62, moteus 1 to 126, cia402 1 to 127",
              .min = 0,
              .max = 127});
  v.required("counts_per_turn", s.counts_per_turn,
             {.about = "encoder counts in one turn of the motor; with those per metre or "
                       "revolution of the axis it gives the torque for an effort",
              .min = 0,
              .max = 1e12,
              .above_min = true,
              .unit = "counts/turn"});
  v.optional("interface", s.interface, {.about = "of this drive; null: the device's"});
  v.optional("max_current_A", s.max_current_A,
             {.about = "odrive: current limit that it is told; null: as set in the drive",
              .min = 0,
              .max = 1000,
              .above_min = true,
              .unit = "A"});
  v.optional("max_velocity_turns_s", s.max_velocity_turns_s,
             {.about = "odrive: velocity limit that goes with max_current_A; near it the drive "
                       "weakens its torque; null: twice what the guard allows",
              .min = 0,
              .max = 10'000,
              .above_min = true,
              .unit = "turns/s"});
}

template <class V>
void describe(V& v, Axis& s) {
  v.required("name", s.name,
             {.about = "of the axis, unique in its device", .form = TextForm::name});
  v.optional("kind", s.kind,
             {.about = "how the axis moves; of keys with two units the one that fits is taken"});
  v.required("encoder", s.encoder, {.about = "position sensor"});
  v.required("actuator", s.actuator, {.about = "motor and amplifier"});
  v.optional(
      "model", s.model,
      {.about =
           "what is known of the axis' own dynamics; null: nothing, so nothing can be proved"});
  v.optional("velocity", s.velocity, {.about = "velocity estimate"});
  v.optional("observer", s.observer, {.about = "disturbance observer of the axis"});
  v.optional("compensation", s.compensation,
             {.about = "friction and weight that the motor takes over"});
  v.optional("homing", s.homing, {.about = "how the axis finds its zero"});
  v.optional("travel", s.travel, {.about = "where the axis may be; null: anywhere"});
  v.optional("can", s.can, {.about = "its drive, with a driver for CAN; null: none"});
}

}  // namespace hapticd::config
