// Guides and fields.
#include <limits>

#include "config/describe.h"
#include "config/geometry.h"
#include "config/number.h"
#include "config/scene_compilation.h"

namespace hapticd::config {
namespace {

using control::ObjectKind;

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

control::Surface pull(const Guide& guide) {
  return {.compliance = 1 / guide.stiffness_N_m, .damping = guide.damping_Ns_m};
}
double range(const Guide& guide) {
  return guide.range_m.value_or(kEverywhere);
}
control::Region region(const Field& field) {
  return {.centre = to_vec3(field.center_m), .radius = field.radius_m.value_or(kEverywhere)};
}

/// A pull that ends somewhere is no convex potential.
Convex convex(const Guide& guide) {
  return guide.range_m ? Convex::no : Convex::yes;
}

/// A corner that is where the one before is has no direction from there.
bool check_corners(Compilation& compilation, const CurveGuide& guide, const std::string& path) {
  const auto& points = guide.points_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool first = i == 0;
    if (first ? !guide.closed || points.front() != points.back() : points[i] != points[i - 1])
      continue;
    compilation.refuse(indexed(path + ".points_m", first ? points.size() - 1 : i),
                       first ? "the curve is closed, so it goes back to its first corner by "
                               "itself; remove this one"
                             : "this corner is where the one before is; remove one of them");
    return false;
  }
  return true;
}

}  // namespace

void add(SceneCompilation& scene, const PointGuide& guide, const ObjectPlace& place) {
  const auto shape =
      put(scene.spec().point_guides, {.at = to_vec3(guide.center_m), .range = range(guide)});
  meet(scene, place, {.kind = ObjectKind::point, .shape = shape, .surface = pull(guide)},
       convex(guide));
}

void add(SceneCompilation& scene, const LineGuide& guide, const ObjectPlace& place) {
  const auto axis = unit_vector(scene.all, guide.axis, place.path + ".axis", "an axis");
  if (!axis) return;
  const auto shape =
      put(scene.spec().line_guides, {.centre = to_vec3(guide.center_m),
                                     .axis = *axis,
                                     .half = 0.5 * guide.length_m.value_or(kEverywhere),
                                     .range = range(guide)});
  meet(scene, place, {.kind = ObjectKind::line, .shape = shape, .surface = pull(guide)},
       convex(guide));
}

void add(SceneCompilation& scene, const CurveGuide& guide, const ObjectPlace& place) {
  if (!check_corners(scene.all, guide, place.path)) return;
  std::vector<Vec3>& points = scene.spec().curve_points;
  const std::size_t first = points.size();
  for (const auto& point : guide.points_m) points.push_back(to_vec3(point));
  if (guide.closed) points.push_back(to_vec3(guide.points_m.front()));
  const auto shape =
      put(scene.spec().curve_guides, {.first = static_cast<std::uint32_t>(first),
                                      .count = static_cast<std::uint32_t>(points.size() - first),
                                      .range = range(guide)});
  meet(scene, place, {.kind = ObjectKind::curve, .shape = shape, .surface = pull(guide)},
       guide.points_m.size() == 2 ? convex(guide) : Convex::no);
}

void add(SceneCompilation& scene, const Viscous& field, const ObjectPlace& place) {
  const auto shape =
      put(scene.spec().viscous_fields, {.region = region(field), .damping = field.damping_Ns_m});
  meet(scene, place, {.kind = ObjectKind::viscous, .shape = shape}, Convex::yes);
}

void add(SceneCompilation& scene, const Constant& field, const ObjectPlace& place) {
  const auto shape =
      put(scene.spec().constant_fields, {.region = region(field), .force = to_vec3(field.force_N)});
  meet(scene, place, {.kind = ObjectKind::constant, .shape = shape},
       field.radius_m ? Convex::no : Convex::yes);
}

void add(SceneCompilation& scene, const Detents& field, const ObjectPlace& place) {
  const auto along = unit_vector(scene.all, field.along, place.path + ".along", "a direction");
  if (!along) return;
  const auto shape = put(scene.spec().detents, {.along = *along,
                                                .offset = field.offset_m,
                                                .spacing = field.spacing_m,
                                                .max_force = field.max_force_N,
                                                .count = static_cast<std::uint32_t>(field.count)});
  meet(scene, place, {.kind = ObjectKind::detents, .shape = shape}, Convex::no);
}

void add(SceneCompilation& scene, const Magnet& field, const ObjectPlace& place) {
  const auto shape = put(scene.spec().magnets, {.centre = to_vec3(field.center_m),
                                                .radius = field.radius_m,
                                                .range = field.range_m,
                                                .max_force = field.max_force_N});
  meet(scene, place, {.kind = ObjectKind::magnet, .shape = shape}, Convex::no);
}

void add(SceneCompilation& scene, const Vibration& field, const ObjectPlace& place) {
  const double half_rate_Hz = 0.5 * scene.all.config.loop.rate_Hz;
  if (field.frequency_Hz >= half_rate_Hz) {
    scene.all.refuse(place.path + ".frequency_Hz",
                     "expected less than half the rate of the loop, " +
                         format_number(half_rate_Hz) + " Hz, found " +
                         format_number(field.frequency_Hz) + " Hz");
  }
  const auto shape = put(scene.spec().vibrations, {.region = region(field),
                                                   .force = to_vec3(field.force_N),
                                                   .frequency = field.frequency_Hz,
                                                   .phase = field.phase_rad});
  meet(scene, place, {.kind = ObjectKind::vibration, .shape = shape}, Convex::yes);
}

}  // namespace hapticd::config
