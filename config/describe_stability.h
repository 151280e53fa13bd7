// What each key of `stability` and of a proof file is; part of config/describe.h.
#pragma once
#include "config/describe_coupling.h"
#include "config/key.h"
#include "config/schema_stability.h"

namespace hapticd::config {

template <class V>
void describe(V& v, HandRange& s) {
  v.optional(
      "mass_kg", s.mass_kg,
      {.about = "least and greatest, moved with the device", .min = 0, .max = 100, .unit = "kg"});
  v.optional("damping_Ns_m", s.damping_Ns_m,
             {.about = "least and greatest", .min = 0, .max = 1e5, .unit = "N s/m"});
  v.optional("stiffness_N_m", s.stiffness_N_m,
             {.about = "least and greatest, towards where the hand wants to be",
              .min = 0,
              .max = 1e6,
              .unit = "N/m"});
}

template <class V>
void describe(V& v, PaperModel& s) {
  v.optional("hold", s.hold, {.about = "how the zero-order hold is modelled"});
  v.optional("corner_rad_s", s.corner_rad_s,
             {.about = "of first_order (null: 2/period) and second_order (null: pi/period)",
              .min = 0,
              .max = 1e6,
              .above_min = true,
              .unit = "rad/s"});
  v.optional("damping_ratio", s.damping_ratio,
             {.about = "of second_order", .min = 0, .max = 10, .above_min = true});
  v.optional("weight_numerator", s.weight_numerator,
             {.about = "w1 of the index J: ascending powers of s",
              .min = -1e12,
              .max = 1e12,
              .min_items = 1,
              .max_items = 8});
  v.optional("weight_denominator", s.weight_denominator,
             {.about = "likewise; all its roots to the left but for one that may be 0",
              .min = -1e12,
              .max = 1e12,
              .min_items = 1,
              .max_items = 8});
}

template <class V>
void describe(V& v, Stability& s) {
  v.optional(
      "require", s.require,
      {.about =
           "what must be proved before forces come on. passive: with every passive hand; robust: "
           "that "
           "or, for the hands and devices as given, by 'proof'; none: nothing (see hapticd(8))"});
  v.optional("hand", s.hand,
             {.about = "whom robust answers are about, each on each device of one axis; null: "
                       "devices that nobody "
                       "holds"});
  v.optional(
      "proof", s.proof,
      {.about =
           "a file that hapticctl certify -o writes, checked again at every load; null: none"});
  v.optional("paper", s.paper, {.about = "what the norm of Eom, Suh and Yi goes by"});
}

template <class V>
void describe(V& v, DeviceProof& s) {
  v.required("device", s.device, {.about = "whose loop it is", .form = TextForm::name});
  v.required("P", s.P,
             {.about = "symmetric matrices by rows: one for all, or one for each device and hand",
              .min = -1e30,
              .max = 1e30,
              .min_items = 1,
              .max_items = kMaxCertificateOrder});
}

template <class V>
void describe(V& v, ProofFile& s) {
  v.required("devices", s.devices,
             {.about = "those with a proof", .min_items = 1, .max_items = kMaxDevices});
}

}  // namespace hapticd::config
