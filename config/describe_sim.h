// What each key of a simulated device is; part of config/describe.h.
#pragma once
#include "config/describe_axis.h"
#include "config/describe_coupling.h"
#include "config/key.h"
#include "config/schema_sim.h"
#include "control/core/capacity.h"

namespace hapticd::config {

template <class V>
void describe(V& v, SimAxis& s) {
  both(v, FormOf{"mass_kg", s.mass_kg, "kg"}, FormOf{"inertia_kgm2", s.inertia_kgm2, "kg m^2"},
       {.about = "true mass or inertia; null: as the model says",
        .min = 0,
        .max = 1000,
        .above_min = true});
  both(v, FormOf{"damping_Ns_m", s.damping_Ns_m, "N s/m"},
       FormOf{"damping_Nms_rad", s.damping_Nms_rad, "N m s/rad"},
       {.about = "true viscous damping; null: as the model says", .min = 0, .max = 1e5});
  both(v, FormOf{"coulomb_N", s.coulomb_N, "N"}, FormOf{"coulomb_Nm", s.coulomb_Nm, "N m"},
       {.about = "true dry friction; null: 0", .min = 0, .max = 1000});
  v.optional("delay_s", s.delay_s,
             {.about = "command to force", .min = 0, .max = 0.05, .unit = "s"});
  both(v, FormOf{"position_m", s.position_m, "m"}, FormOf{"position_rad", s.position_rad, "rad"},
       {.about = "at start, at rest; null: 0", .min = -100, .max = 100});
  v.optional(
      "noise_counts", s.noise_counts,
      {.about = "standard deviation of the encoder noise", .min = 0, .max = 1e6, .unit = "counts"});
  both(v, FormOf{"dac_step_N", s.dac_step_N, "N"}, FormOf{"dac_step_Nm", s.dac_step_Nm, "N m"},
       {.about = "effort is rounded to this; null or 0: exact", .min = 0, .max = 1000});
  v.optional("relative", s.relative, {.about = "the encoder reads 0 where the axis starts"});
  both(v, FormOf{"index_m", s.index_m, "m"}, FormOf{"index_rad", s.index_rad, "rad"},
       {.about = "position of the encoder's index pulse; null: it has none",
        .min = -100,
        .max = 100});
  both(v, FormOf{"stops_m", s.stops_m, "m"}, FormOf{"stops_rad", s.stops_rad, "rad"},
       {.about = "mechanical ends, lower and upper; null: it moves freely",
        .min = -100,
        .max = 100});
  v.optional("homed_at_s", s.homed_at_s,
             {.about = "from this time on the device says that its zero is known",
              .min = 0,
              .max = 1e6,
              .unit = "s"});
}

template <class V>
void describe(V& v, SimLinkage& s) {
  v.optional(
      "inner_link_kg", s.inner_link_kg,
      {.about = "five_bar: uniform rods from base to elbow", .min = 0, .max = 1000, .unit = "kg"});
  v.optional(
      "outer_link_kg", s.outer_link_kg,
      {.about = "five_bar: uniform rods from elbow to tip", .min = 0, .max = 1000, .unit = "kg"});
  v.optional("tip_kg", s.tip_kg, {.about = "mass at the tip", .min = 0, .max = 1000, .unit = "kg"});
  v.optional("gravity_m_s2", s.gravity_m_s2,
             {.about = "device frame", .min = -100, .max = 100, .unit = "m/s^2"});
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
             {.about = "moves with every axis, or with the tip of a linkage",
              .min = 0,
              .max = 1000,
              .unit = "kg"});
  v.optional(
      "stiffness_N_m", s.stiffness_N_m,
      {.about = "of the grip, to where the hand wants to be", .min = 0, .max = 1e6, .unit = "N/m"});
  v.optional("damping_Ns_m", s.damping_Ns_m,
             {.about = "of the grip", .min = 0, .max = 1e5, .unit = "N s/m"});
  v.optional("direction", s.direction,
             {.about = "device frame: of the script, at the tip of a linkage; any length but 0",
              .min = -1e6,
              .max = 1e6});
  v.optional("script", s.script,
             {.about = "what the hand does, in the order of time", .max_items = 10'000});
}

template <class V>
void describe(V& v, SimForceSensor& s) {
  v.optional("noise_N", s.noise_N,
             {.about = "standard deviation", .min = 0, .max = 1000, .unit = "N"});
}

template <class V>
void describe(V& v, SimDigitalStep& s) {
  v.required("at_s", s.at_s,
             {.about = "when, counted from the first tick", .min = 0, .max = 1e6, .unit = "s"});
  v.required("bits", s.bits,
             {.about = "all inputs from then on, one bit each", .min = 0, .max = 4294967295.0});
}

template <class V>
void describe(V& v, SimFailure& s) {
  v.required("kind", s.kind, {.about = "what goes wrong"});
  v.optional("axis", s.axis, {.about = "where; null: at the first axis", .form = TextForm::name});
  v.required("at_s", s.at_s,
             {.about = "when, counted from the first tick", .min = 0, .max = 1e6, .unit = "s"});
  v.optional("for_s", s.for_s, {.about = "for how long", .min = 0, .max = 1e6, .unit = "s"});
  both(v, FormOf{"size_m", s.size_m, "m"}, FormOf{"size_rad", s.size_rad, "rad"},
       {.about = "of a jump; null: 0", .min = -100, .max = 100});
}

template <class V>
void describe(V& v, Sim& s) {
  v.optional("axes", s.axes,
             {.about = "true plant of each axis; empty: all as their models say",
              .max_items = kMaxAxesPerDevice});
  v.optional("linkage", s.linkage, {.about = "what moves beside the axes of a linkage"});
  v.optional("hand", s.hand, {.about = "the passive hand that holds every axis, or the tip"});
  v.optional("force_sensor", s.force_sensor,
             {.about = "between hand and device; null: exact, if the device has one"});
  v.optional("substeps", s.substeps, {.about = "simulation steps per tick", .min = 1, .max = 1000});
  v.optional("seed", s.seed, {.about = "of the noise", .min = 0, .max = 4294967295.0});
  v.optional("digital", s.digital,
             {.about = "digital inputs, in the order of time; before the first all are 0",
              .max_items = 1000});
  v.optional("failures", s.failures,
             {.about = "what goes wrong, for rehearsals", .max_items = 1000});
}

template <class V>
void describe(V& v, SharedHand& s) {
  describe_contacts(v, s.contacts);
  v.required("state_space", s.state_space,
             {.about = "in continuous time, velocities in m/s to the forces in N against them"});
  v.optional("velocity_m_s", s.velocity_m_s,
             {.about = "of each of its coordinates at the start; empty: at rest",
              .min = -100,
              .max = 100,
              .unit = "m/s",
              .max_items = kMaxCoordinates});
}

template <class V>
void describe(V& v, Simulation& s) {
  v.optional("hand", s.hand,
             {.about = "holds contacts of several Cartesian devices, beside their own hands; null: "
                       "none"});
}

}  // namespace hapticd::config
