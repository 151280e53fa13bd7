// What each key of the surfaces in a scene is; part of config/describe.h. Guides, fields and
// networks stand in describe_field.h.
#pragma once
#include "config/key.h"
#include "config/schema_scene.h"
#include "control/core/capacity.h"

namespace hapticd::config {

/// Farthest place of the world [m], and largest length of a thing in it.
inline constexpr double kFarthest_m = 1e4;

// Keys that many kinds have.

template <class V>
void describe_name(V& v, std::string& name) {
  v.required("name", name, {.about = "of the object, unique in the scene", .form = TextForm::name});
}

template <class V>
void describe_object(V& v, Object& s) {
  describe_name(v, s.name);
  v.optional("devices", s.devices,
             {.about = "which devices feel it; empty: all",
              .form = TextForm::name,
              .max_items = kMaxDevices});
}

template <class V>
void describe_place(V& v, const char* key, std::array<double, 3>& place, const char* about) {
  v.optional(key, place, {.about = about, .min = -kFarthest_m, .max = kFarthest_m, .unit = "m"});
}

template <class V>
void describe_direction(V& v, const char* key, std::array<double, 3>& direction,
                        const char* about) {
  v.required(key, direction, {.about = about, .min = -1e6, .max = 1e6});
}

template <class V>
void describe_length(V& v, const char* key, double& length, const char* about) {
  v.required(key, length,
             {.about = about, .min = 0, .max = kFarthest_m, .above_min = true, .unit = "m"});
}

template <class V>
void describe_rotation(V& v, std::array<double, 4>& rotation) {
  v.optional("rotation_quaternion", rotation,
             {.about = "how it is turned: w, x, y, z, of length 1", .min = -2, .max = 2});
}

template <class V>
void describe_free(V& v, FreeSide& free) {
  v.optional("free", free, {.about = "on which side the tool may be"});
}

template <class V>
void describe(V& v, Friction& s) {
  v.required(
      "static", s.at_rest,
      {.about = "friction coefficient up to which a contact at rest holds", .min = 0, .max = 10});
  v.required("dynamic", s.dynamic,
             {.about = "friction coefficient of a contact that slides; at most the static one",
              .min = 0,
              .max = 10});
}

template <class V>
void describe(V& v, MotionWaypoint& s) {
  v.required("at_s", s.at_s,
             {.about = "when, counted from the first tick; the first at 0, each later than the one "
                       "before",
              .min = 0,
              .max = 1e6,
              .unit = "s"});
  describe_place(v, "position_m", s.position_m, "of the object's frame, in the world");
  describe_rotation(v, s.rotation_quaternion);
}

template <class V>
void describe(V& v, Motion& s) {
  v.required("waypoints", s.waypoints,
             {.about = "of the object's frame, straight in between and turned along the shortest "
                       "arc",
              .min_items = 1,
              .max_items = 10'000});
  v.optional("repeat", s.repeat,
             {.about = "begin anew at the time of the last waypoint, which has to be where the "
                       "first is"});
}

template <class V>
void describe_surface(V& v, Surface& s) {
  describe_object(v, s);
  v.optional("stiffness_N_m", s.stiffness_N_m,
             {.about = "of the surface; this or rigid",
              .min = 0,
              .max = 1e7,
              .above_min = true,
              .unit = "N/m"});
  v.optional("rigid", s.rigid,
             {.about = "the surface does not give way: what is felt is the coupling, which has to "
                       "name all coordinates of the contact"});
  v.optional("damping_Ns_m", s.damping_Ns_m,
             {.about = "along the normal, while it pushes; not with rigid",
              .min = 0,
              .max = 1e5,
              .unit = "N s/m"});
  v.optional("friction", s.friction, {.about = "along the surface; null: none"});
  v.optional("motion", s.motion,
             {.about = "the object moves: its other keys are then in its own frame; null: it "
                       "stays"});
}

template <class V>
void describe(V& v, Plane& s) {
  describe_surface(v, s);
  describe_direction(v, "normal", s.normal,
                     "towards the free side, in world directions x, y, z; any length but 0");
  v.optional("offset_m", s.offset_m,
             {.about = "distance of the surface from the origin, along the normal",
              .min = -kFarthest_m,
              .max = kFarthest_m,
              .unit = "m"});
}

template <class V>
void describe(V& v, Texture& s) {
  describe_surface(v, s);
  describe_direction(v, "normal", s.normal,
                     "of the plane, towards the free side; any length but 0");
  v.optional("offset_m", s.offset_m,
             {.about = "distance of the plane from the origin, along the normal",
              .min = -kFarthest_m,
              .max = kFarthest_m,
              .unit = "m"});
  describe_direction(v, "along", s.along,
                     "the direction in which the height changes; its part in the plane counts");
  v.optional("profile", s.profile, {.about = "hills and valleys, or grooves in a flat"});
  describe_length(v, "amplitude_m", s.amplitude_m, "height of hills and depth of valleys");
  describe_length(v, "wavelength_m", s.wavelength_m, "from one valley to the next");
}

template <class V>
void describe(V& v, Box& s) {
  describe_surface(v, s);
  describe_place(v, "center_m", s.center_m, "of its centre");
  v.required("size_m", s.size_m,
             {.about = "lengths of its sides",
              .min = 0,
              .max = kFarthest_m,
              .above_min = true,
              .unit = "m"});
  describe_rotation(v, s.rotation_quaternion);
  describe_free(v, s.free);
}

template <class V>
void describe(V& v, Sphere& s) {
  describe_surface(v, s);
  describe_place(v, "center_m", s.center_m, "of its centre");
  describe_length(v, "radius_m", s.radius_m, "of the sphere");
  describe_free(v, s.free);
}

/// `length`: what is said of length_m.
template <class V>
void describe_round(V& v, Round& s, const char* length) {
  describe_surface(v, s);
  describe_place(v, "center_m", s.center_m, "of its centre");
  describe_direction(v, "axis", s.axis, "its direction; any length but 0");
  describe_length(v, "radius_m", s.radius_m, "across the axis");
  describe_length(v, "length_m", s.length_m, length);
  describe_free(v, s.free);
}
template <class V>
void describe(V& v, Cylinder& s) {
  describe_round(v, s, "from one flat end to the other");
}
template <class V>
void describe(V& v, Capsule& s) {
  describe_round(v, s, "between the centres of its round ends");
}

template <class V>
void describe(V& v, Mesh& s) {
  describe_surface(v, s);
  v.required("file", s.file,
             {.about = "STL, OBJ or PLY: closed triangles, counter-clockwise from outside"});
  v.optional("scale", s.scale,
             {.about = "metres for one unit of the file; 0.001 for millimetres",
              .min = 0,
              .max = 1e6,
              .above_min = true});
  describe_place(v, "position_m", s.position_m, "of the file's origin");
  describe_rotation(v, s.rotation_quaternion);
  v.optional("max_triangles", s.max_triangles,
             {.about = "a file with more is refused before memory is taken for it",
              .min = 1,
              .max = 50'000'000});
}

}  // namespace hapticd::config
