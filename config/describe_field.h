// What each key of guides, fields and networks in a scene is; part of config/describe.h.
#pragma once
#include "config/describe_scene.h"

namespace hapticd::config {

/// Nodes of one network: what is folded from it grows with their square.
inline constexpr std::size_t kMaxNodes = 128;

template <class V>
void describe_guide(V& v, Guide& s) {
  describe_object(v, s);
  v.required("stiffness_N_m", s.stiffness_N_m,
             {.about = "of the pull", .min = 0, .max = 1e7, .above_min = true, .unit = "N/m"});
  v.optional("damping_Ns_m", s.damping_Ns_m,
             {.about = "of the pull, along it", .min = 0, .max = 1e5, .unit = "N s/m"});
  v.optional("range_m", s.range_m,
             {.about = "farther away there is no pull; null: it has no end",
              .min = 0,
              .max = kFarthest_m,
              .above_min = true,
              .unit = "m"});
}

template <class V>
void describe(V& v, PointGuide& s) {
  describe_guide(v, s);
  describe_place(v, "center_m", s.center_m, "the point that the contact is pulled to");
}

template <class V>
void describe(V& v, LineGuide& s) {
  describe_guide(v, s);
  describe_place(v, "center_m", s.center_m, "a point of the line; its middle if it has ends");
  describe_direction(v, "axis", s.axis, "direction of the line; any length but 0");
  v.optional("length_m", s.length_m,
             {.about = "from end to end; null: endless",
              .min = 0,
              .max = kFarthest_m,
              .above_min = true,
              .unit = "m"});
}

template <class V>
void describe(V& v, CurveGuide& s) {
  describe_guide(v, s);
  v.required("points_m", s.points_m,
             {.about = "corners of the curve, in their order; [x, y, z] each",
              .min = -kFarthest_m,
              .max = kFarthest_m,
              .unit = "m",
              .min_items = 2,
              .max_items = 20'000});
  v.optional("closed", s.closed, {.about = "the last corner is joined with the first"});
}

template <class V>
void describe_field(V& v, Field& s) {
  describe_object(v, s);
  describe_place(v, "center_m", s.center_m, "of the ball in which it acts");
  v.optional("radius_m", s.radius_m,
             {.about = "of that ball; null: it acts everywhere",
              .min = 0,
              .max = kFarthest_m,
              .above_min = true,
              .unit = "m"});
}

template <class V>
void describe_force(V& v, std::array<double, 3>& force, const char* about) {
  v.required("force_N", force, {.about = about, .min = -1e4, .max = 1e4, .unit = "N"});
}

template <class V>
void describe(V& v, Viscous& s) {
  describe_field(v, s);
  v.required("damping_Ns_m", s.damping_Ns_m,
             {.about = "force against the velocity", .min = 0, .max = 1e5, .unit = "N s/m"});
}

template <class V>
void describe(V& v, Constant& s) {
  describe_field(v, s);
  describe_force(v, s.force_N,
                 "on the contact, in world directions x, y, z; fades towards the "
                 "edge of the ball");
}

template <class V>
void describe(V& v, Vibration& s) {
  describe_field(v, s);
  describe_force(v, s.force_N, "amplitude, in world directions x, y, z");
  v.required("frequency_Hz", s.frequency_Hz,
             {.about = "below half the rate of the loop",
              .min = 0,
              .max = 4000,
              .above_min = true,
              .unit = "Hz"});
  v.optional("phase_rad", s.phase_rad,
             {.about = "of the sine at the first tick", .min = -10, .max = 10, .unit = "rad"});
}

template <class V>
void describe_max_force(V& v, double& force) {
  v.required("max_force_N", force,
             {.about = "its strongest pull", .min = 0, .max = 1e4, .unit = "N"});
}

template <class V>
void describe(V& v, Detents& s) {
  describe_object(v, s);
  describe_direction(v, "along", s.along, "direction in which rest places follow each other");
  v.optional("offset_m", s.offset_m,
             {.about = "the first rest place, from the origin along that direction",
              .min = -kFarthest_m,
              .max = kFarthest_m,
              .unit = "m"});
  describe_length(v, "spacing_m", s.spacing_m, "from one rest place to the next");
  describe_max_force(v, s.max_force_N);
  v.optional("count", s.count,
             {.about = "rest places, from the first on; 0: without end on both sides",
              .min = 0,
              .max = 1'000'000});
}

template <class V>
void describe(V& v, Magnet& s) {
  describe_object(v, s);
  describe_place(v, "center_m", s.center_m, "of the ball that attracts");
  v.optional("radius_m", s.radius_m,
             {.about = "of that ball, on whose surface the contact is held; 0: a point",
              .min = 0,
              .max = kFarthest_m,
              .unit = "m"});
  describe_length(v, "range_m", s.range_m, "farther from its surface there is no pull");
  describe_max_force(v, s.max_force_N);
}

template <class V>
void describe(V& v, NetworkNode& s) {
  v.required("name", s.name,
             {.about = "of the node, unique in the network", .form = TextForm::name});
  v.optional(
      "mass_kg", s.mass_kg,
      {.about = "0: a joint, held by a spring or damper", .min = 0, .max = 1e6, .unit = "kg"});
  v.optional(
      "position_m", s.position_m,
      {.about = "at the start, at rest", .min = -kFarthest_m, .max = kFarthest_m, .unit = "m"});
  v.optional("load_N", s.load_N,
             {.about = "constant force on it", .min = -1e4, .max = 1e4, .unit = "N"});
}

template <class V>
void describe(V& v, NetworkElement& s) {
  v.required("between", s.between,
             {.about = "its two ends: a device's coordinate (left.x), a node's name, or ground",
              .form = TextForm::coordinate});
  v.optional("stiffness_N_m", s.stiffness_N_m,
             {.about = "of its spring", .min = 0, .max = 1e7, .unit = "N/m"});
  v.optional("damping_Ns_m", s.damping_Ns_m,
             {.about = "of its damper", .min = 0, .max = 1e5, .unit = "N s/m"});
  v.optional("rest_m", s.rest_m,
             {.about = "first end less second end where the spring is slack",
              .min = -kFarthest_m,
              .max = kFarthest_m,
              .unit = "m"});
}

template <class V>
void describe(V& v, Network& s) {
  describe_name(v, s.name);
  v.optional("nodes", s.nodes, {.about = "masses and joints", .max_items = kMaxNodes});
  v.required("elements", s.elements,
             {.about = "springs and dampers", .min_items = 1, .max_items = 10'000});
}

}  // namespace hapticd::config
