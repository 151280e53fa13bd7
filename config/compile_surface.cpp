// Surfaces: what they feel like, and the bodies that have simple formulae. A shape is made once,
// in world coordinates or in those of the frame that moves, and met by every contact that feels it.
#include <algorithm>
#include <cmath>

#include "config/describe.h"
#include "config/geometry.h"
#include "config/number.h"
#include "config/scene_compilation.h"

namespace hapticd::config {
namespace {

/// Below this share of the unit normal a contact does not feel a plane: rounding, not geometry.
constexpr double kLeastShare = 1e-9;

std::string words(const std::vector<std::size_t>& directions) {
  std::string text;
  for (const std::size_t direction : directions)
    text += (text.empty() ? "" : ", ") + std::string(word_of(static_cast<Direction>(direction)));
  return text;
}

/// Rigid is felt through the coupling alone: a direction without it would have no stiffness but the
/// picometre's that stands for rigid.
void check_rigid(SceneCompilation& scene, const ObjectPlace& place) {
  for (const std::size_t device : place.devices) {
    const control::DevicePlan& plan = scene.spec().devices[device];
    for (std::uint32_t i = 0; i < plan.coordinates; ++i) {
      const std::uint32_t coordinate = plan.first_coordinate + i;
      if (scene.coupled[coordinate]) continue;
      const std::string& name = scene.spec().coordinate_names[coordinate];
      scene.all.refuse(place.path + ".rigid",
                       "a rigid surface is felt through the coupling, and no block of it names " +
                           name + "; name " + name +
                           " in coupling.blocks, or give the surface a stiffness_N_m");
      return;
    }
  }
}

void check_friction(SceneCompilation& scene, const Friction& friction, const ObjectPlace& place) {
  if (friction.at_rest >= friction.dynamic) return;
  scene.all.refuse(place.path + ".friction.static",
                   "expected at least the dynamic coefficient, " + format_number(friction.dynamic) +
                       ", found " + format_number(friction.at_rest));
}

/// Two whose free side is inside must have room for the tool. `room`: half of their smallest width.
void check_room(SceneCompilation& scene, FreeSide free, double room, const ObjectPlace& place) {
  if (free == FreeSide::outside) return;
  for (const std::size_t device : place.devices) {
    const Device& tool = scene.places[device].device;
    if (tool.tool_radius_m < room) continue;
    scene.all.refuse(place.path + ".free",
                     "the tool of device '" + tool.name + "' with its radius of " +
                         format_number(tool.tool_radius_m) +
                         " m has no room inside; enlarge the object, or name in 'devices' only "
                         "those that have");
  }
}

control::Free side(FreeSide free) {
  return free == FreeSide::inside ? control::Free::inside : control::Free::outside;
}
Convex convex(FreeSide free) {
  return free == FreeSide::inside ? Convex::yes : Convex::no;
}

/// What all surfaces end with. `shape` is put into `array` only where its surface is sound.
template <class Shape>
void meet_surface(SceneCompilation& scene, const Surface& surface, const ObjectPlace& place,
                  control::ObjectKind kind, std::vector<Shape>& array, const Shape& shape,
                  Convex convex) {
  const auto feel = compile_surface(scene, surface, place);
  const std::uint32_t path = compile_motion(scene, surface.motion, place);
  if (!feel) return;
  meet(scene, place, {.kind = kind, .shape = put(array, shape), .path = path, .surface = *feel},
       convex);
}

// Planes.

/// A plane as one contact feels it that nothing else concerns: in world directions that it does not
/// have the contact stays where its device stands.
control::PlaneContact plane_contact(const Plane& plane, const Vec3& unit,
                                    const DevicePlace& place) {
  const std::vector<std::size_t>& directions = place.frame.directions;
  control::PlaneContact made{.first_coordinate = place.first_coordinate,
                             .coordinates = static_cast<std::uint16_t>(directions.size()),
                             .offset = plane.offset_m + place.device.tool_radius_m,
                             .stiffness = *plane.stiffness_N_m,
                             .damping = plane.damping_Ns_m};
  for (std::size_t i = 0; i < directions.size(); ++i) made.normal[i] = unit[directions[i]];
  for (std::size_t d = 0; d < 3; ++d) {
    const bool moves = std::find(directions.begin(), directions.end(), d) != directions.end();
    if (!moves) made.offset -= unit[d] * place.frame.position[d];
  }
  return made;
}

/// Can the contact move across the plane? Reports if not.
bool check_felt(SceneCompilation& scene, const Vec3& unit, std::size_t device,
                const ObjectPlace& place) {
  const std::vector<std::size_t>& directions = scene.places[device].frame.directions;
  const auto across = [&](std::size_t d) { return std::abs(unit[d]) > kLeastShare; };
  if (std::any_of(directions.begin(), directions.end(), across)) return true;
  scene.all.refuse(place.path + ".normal",
                   "device '" + scene.places[device].device.name + "' (directions " +
                       words(directions) +
                       ") moves along this plane and cannot feel it; turn the normal, or name in "
                       "'devices' only those that can");
  return false;
}

}  // namespace

std::optional<control::Surface> compile_surface(SceneCompilation& scene, const Surface& surface,
                                                const ObjectPlace& place) {
  if (surface.stiffness_N_m.has_value() == surface.rigid) {
    scene.all.refuse(place.path, std::string("expected stiffness_N_m or rigid: true, found ") +
                                     (surface.rigid ? "both; remove one" : "neither"));
    return {};
  }
  if (surface.rigid && surface.damping_Ns_m != 0) {
    scene.all.refuse(place.path + ".damping_Ns_m",
                     "a rigid surface does not move, so nothing in it is damped; put damping into "
                     "the coupling");
  }
  if (surface.rigid) check_rigid(scene, place);
  const Friction friction = surface.friction.value_or(Friction{});
  check_friction(scene, friction, place);
  return control::Surface{
      .compliance = surface.rigid ? control::kRigidCompliance : 1 / *surface.stiffness_N_m,
      .damping = surface.damping_Ns_m,
      .static_friction = friction.at_rest,
      .dynamic_friction = friction.dynamic};
}

void add(SceneCompilation& scene, const Plane& plane, const ObjectPlace& place) {
  const auto unit = unit_vector(scene.all, plane.normal, place.path + ".normal", "a normal");
  const auto feel = compile_surface(scene, plane, place);
  const std::uint32_t path = compile_motion(scene, plane.motion, place);
  if (!unit || !feel) return;
  const bool plain = !plane.friction && !plane.motion && !plane.rigid;
  ObjectPlace solved = place;  // those that need more than a PlaneContact
  solved.devices.clear();
  for (const std::size_t device : place.devices) {
    if (!plane.motion && !check_felt(scene, *unit, device, place)) continue;
    if (plain && !scene.grouped[device]) {
      scene.spec().planes.push_back(plane_contact(plane, *unit, scene.places[device]));
    } else {
      solved.devices.push_back(device);
    }
  }
  if (solved.devices.empty()) return;
  const std::uint32_t shape = put(scene.spec().free_planes, {*unit, plane.offset_m});
  meet(scene, solved, {.shape = shape, .path = path, .surface = *feel}, Convex::yes);
}

void add(SceneCompilation& scene, const Texture& texture, const ObjectPlace& place) {
  const auto normal = unit_vector(scene.all, texture.normal, place.path + ".normal", "a normal");
  const auto along = unit_vector(scene.all, texture.along, place.path + ".along", "a direction");
  if (!normal || !along) return;
  const Vec3 tangent = *along - dot(*along, *normal) * *normal;
  if (norm(tangent) < kLeastShare) {
    scene.all.refuse(place.path + ".along",
                     "expected a direction along the surface, found one along its normal");
    return;
  }
  const control::Relief shape{.normal = *normal,
                              .along = (1 / norm(tangent)) * tangent,
                              .offset = texture.offset_m,
                              .amplitude = texture.amplitude_m,
                              .wavelength = texture.wavelength_m,
                              .profile = texture.profile == Profile::groove
                                             ? control::Relief::Profile::groove
                                             : control::Relief::Profile::sinusoid};
  meet_surface(scene, texture, place, control::ObjectKind::relief, scene.spec().reliefs, shape,
               Convex::no);
}

void add(SceneCompilation& scene, const Box& box, const ObjectPlace& place) {
  const auto turn =
      unit_quaternion(scene.all, box.rotation_quaternion, place.path + ".rotation_quaternion");
  const control::Box shape{.frame = {to_mat3(rotation_of(turn)), to_vec3(box.center_m)},
                           .half = 0.5 * to_vec3(box.size_m),
                           .free = side(box.free)};
  const double smallest = *std::min_element(box.size_m.begin(), box.size_m.end());
  check_room(scene, box.free, 0.5 * smallest, place);
  meet_surface(scene, box, place, control::ObjectKind::box, scene.spec().boxes, shape,
               convex(box.free));
}

void add(SceneCompilation& scene, const Sphere& sphere, const ObjectPlace& place) {
  check_room(scene, sphere.free, sphere.radius_m, place);
  meet_surface(scene, sphere, place, control::ObjectKind::sphere, scene.spec().spheres,
               control::Sphere{to_vec3(sphere.center_m), sphere.radius_m, side(sphere.free)},
               convex(sphere.free));
}

void add(SceneCompilation& scene, const Cylinder& cylinder, const ObjectPlace& place) {
  const auto axis = unit_vector(scene.all, cylinder.axis, place.path + ".axis", "an axis");
  if (!axis) return;
  const double half = 0.5 * cylinder.length_m;
  check_room(scene, cylinder.free, std::min(cylinder.radius_m, half), place);
  meet_surface(scene, cylinder, place, control::ObjectKind::cylinder, scene.spec().cylinders,
               control::Cylinder{to_vec3(cylinder.center_m), *axis, cylinder.radius_m, half,
                                 side(cylinder.free)},
               convex(cylinder.free));
}

void add(SceneCompilation& scene, const Capsule& capsule, const ObjectPlace& place) {
  const auto axis = unit_vector(scene.all, capsule.axis, place.path + ".axis", "an axis");
  if (!axis) return;
  check_room(scene, capsule.free, capsule.radius_m, place);
  meet_surface(scene, capsule, place, control::ObjectKind::capsule, scene.spec().capsules,
               control::Capsule{to_vec3(capsule.center_m), *axis, capsule.radius_m,
                                0.5 * capsule.length_m, side(capsule.free)},
               convex(capsule.free));
}

}  // namespace hapticd::config
