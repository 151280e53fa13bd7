// What each key of an axis' model, and of the file that identify writes, is; part of
// config/describe.h.
#pragma once
#include "config/key.h"
#include "config/key_forms.h"
#include "config/schema_axis.h"

namespace hapticd::config {

/// What a model in a config and a model file have in common.
template <class V>
void describe_figures(V& v, AxisModel& s) {
  both(v, FormOf{"mass_kg", s.mass_kg, "kg"}, FormOf{"inertia_kgm2", s.inertia_kgm2, "kg m^2"},
       {.about = "moving mass or inertia, as identified; one of them is required",
        .min = 0,
        .max = 1000,
        .above_min = true});
  both(v, FormOf{"damping_Ns_m", s.damping_Ns_m, "N s/m"},
       FormOf{"damping_Nms_rad", s.damping_Nms_rad, "N m s/rad"},
       {.about = "viscous damping, as identified; one of them is required", .min = 0, .max = 1e5});
  both(v, FormOf{"coulomb_N", s.coulomb_N, "N"}, FormOf{"coulomb_Nm", s.coulomb_Nm, "N m"},
       {.about = "dry friction, as identified; null: 0", .min = 0, .max = 1000});
  v.optional(
      "mass_uncertainty", s.mass_uncertainty,
      {.about = "share: the true mass or inertia lies within (1 +- this)", .min = 0, .max = 1});
  v.optional("damping_uncertainty", s.damping_uncertainty,
             {.about = "share: the true damping lies within (1 +- this); proofs use the least",
              .min = 0,
              .max = 1});
}

template <class V>
void describe(V& v, AxisModel& s) {
  v.optional("file", s.file,
             {.about = "a file that has the other keys instead, as hapticctl identify writes it; "
                       "null: they stand here"});
  describe_figures(v, s);
}

template <class V>
void describe(V& v, Measurement& s) {
  v.required("device", s.device, {.about = "that was measured", .form = TextForm::name});
  v.required("axis", s.axis, {.about = "of that device", .form = TextForm::name});
  v.required("at", s.at, {.about = "when, UTC"});
  v.required("method", s.method, {.about = "how the axis was moved"});
  v.required("rate_Hz", s.rate_Hz, {.about = "of the loop", .min = 100, .max = 8000, .unit = "Hz"});
  v.required("duration_s", s.duration_s, {.about = "of the motion", .min = 0, .unit = "s"});
  v.required("from_Hz", s.from_Hz, {.about = "lowest frequency", .min = 0, .unit = "Hz"});
  v.required("to_Hz", s.to_Hz, {.about = "highest frequency", .min = 0, .unit = "Hz"});
  v.required("least_coherence", s.least_coherence,
             {.about = "between force and position, at the worst frequency", .min = 0, .max = 1});
  both(v, FormOf{"max_force_N", s.max_force_N, "N"},
       FormOf{"max_torque_Nm", s.max_torque_Nm, "N m"},
       {.about = "bound of the excitation", .min = 0});
  v.required("confidence", s.confidence, {.about = "of every interval", .min = 0.5, .max = 1});
  v.required("delay_s", s.delay_s,
             {.about = "from sample to force; latency_s has to cover it",
              .min = 0,
              .max = 1,
              .unit = "s"});
  v.required("delay_uncertainty_s", s.delay_uncertainty_s,
             {.about = "half-width of its interval", .min = 0, .max = 1, .unit = "s"});
  v.optional(
      "coulomb_uncertainty", s.coulomb_uncertainty,
      {.about = "share: dry friction lies within (1 +- this); null: none was found", .min = 0});
  v.required("residual_counts", s.residual_counts,
             {.about = "motion that the model does not explain, root mean square",
              .min = 0,
              .unit = "counts"});
}

template <class V>
void describe(V& v, ModelFile& s) {
  describe_figures(v, s.model);
  v.optional("measured", s.measured, {.about = "where the figures come from; null: not measured"});
}

}  // namespace hapticd::config
