#include "daemon/cost_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "control/build/bounds.h"
#include "control/scene/ask.h"

namespace hapticd::daemon {
namespace {

using control::ContactPlan;
using control::Encounter;
using control::ObjectKind;

constexpr double kBeyond_m = 1;             ///< how far away is far
constexpr std::size_t kMaxVertices = 1000;  ///< of a mesh that are tried
constexpr int kHalvings = 60;

Vec3 unit(std::size_t direction) {
  Vec3 v;
  v[direction] = 1;
  return v;
}

/// Of the directions that the contact has, the one that goes least along `avoid`.
Vec3 across(const ContactPlan& contact, const Vec3& avoid) {
  std::size_t best = contact.direction[0];
  for (std::size_t i = 1; i < contact.coordinates; ++i) {
    if (std::abs(avoid[contact.direction[i]]) < std::abs(avoid[best])) best = contact.direction[i];
  }
  return unit(best);
}

/// A free point and one that is not: between them is the surface.
struct Span {
  Vec3 free, deep;
};

/// A body with a middle: where that is, how far it reaches from there, its axis if it has one.
struct Solid {
  Vec3 centre{};
  double extent = 0;
  Vec3 axis{};
  control::Free free = control::Free::outside;
};

std::optional<Solid> solid(const control::Plan& plan, const Encounter& e) {
  switch (e.kind) {
    case ObjectKind::box: {
      const control::Box& s = plan.boxes[e.shape];
      return Solid{s.frame.at, norm(s.half), {}, s.free};
    }
    case ObjectKind::sphere: {
      const control::Sphere& s = plan.spheres[e.shape];
      return Solid{s.centre, s.radius, {}, s.free};
    }
    case ObjectKind::cylinder: {
      const control::Cylinder& s = plan.cylinders[e.shape];
      return Solid{s.centre, s.radius + s.half, s.axis, s.free};
    }
    case ObjectKind::capsule: {
      const control::Capsule& s = plan.capsules[e.shape];
      return Solid{s.centre, s.radius + s.half, s.axis, s.free};
    }
    default:
      return std::nullopt;
  }
}

/// Normal and offset of a plane, or of the mean plane of a relief.
std::optional<control::Plane> flat(const control::Plan& plan, const Encounter& e) {
  if (e.kind == ObjectKind::plane) return plan.free_planes[e.shape];
  if (e.kind == ObjectKind::relief)
    return control::Plane{plan.reliefs[e.shape].normal, plan.reliefs[e.shape].offset};
  return std::nullopt;
}

/// An encounter with its object at time 0, seen from the world.
class Object {
 public:
  Object(const control::Plan& plan, const Encounter& encounter)
      : plan_(plan), encounter_(encounter), contact_(plan.contacts[encounter.contact]) {
    if (encounter.path != control::kNoPath)
      pose_ = control::pose_at(plan.paths[encounter.path], plan.waypoints, 0);
  }

  Vec3 world(const Vec3& local) const { return to_world(pose_, local); }
  Vec3 reach(const Vec3& local) const { return reached(contact_, world(local)); }
  const ContactPlan& contact() const { return contact_; }

  /// Depth and normal in world directions; `from`: a point that is free.
  control::Nearest ask(control::State& state, const Vec3& at, const Vec3& from) const {
    if (encounter_.kind == ObjectKind::mesh) state.walks[encounter_.walk] = {};
    auto found = control::nearest_free(plan_, state, encounter_, false, to_local(pose_, at),
                                       to_local(pose_, from), contact_.radius);
    found.normal = pose_.turn * found.normal;
    return found;
  }

  /// Pairs of places, any of which may do.
  std::vector<Span> spans() const {
    if (const auto plane = flat(plan_, encounter_)) return across_plane(*plane);
    if (const auto body = solid(plan_, encounter_)) return {from_middle(*body)};
    if (encounter_.kind == ObjectKind::mesh) return at_vertices(plan_.meshes[encounter_.shape]);
    return {};
  }

 private:
  std::vector<Span> across_plane(const control::Plane& plane) const {
    const Vec3 normal = pose_.turn * plane.normal;
    const double offset = plane.offset + dot(normal, pose_.at);
    const Vec3 start = reached(contact_, {});
    const Vec3 along = reached(contact_, normal) - start;
    const double share = dot(normal, along);
    if (!(share > 0)) return {};
    const Vec3 on_surface = start + ((offset - dot(normal, start)) / share) * along;
    const Vec3 away = (kBeyond_m / norm(along)) * along;
    return {{on_surface + away, on_surface - away}};
  }

  Span from_middle(const Solid& body) const {
    const Vec3 middle = reach(body.centre);
    const double out = body.extent + contact_.radius + 10 * kTouchDepth_m;
    const Vec3 outer = middle + out * across(contact_, pose_.turn * body.axis);
    return body.free == control::Free::outside ? Span{outer, middle} : Span{middle, outer};
  }

  std::vector<Span> at_vertices(const control::Mesh& mesh) const {
    std::vector<Span> spans;
    const std::size_t stride = mesh.triangles.size() / kMaxVertices + 1;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += stride) {
      const control::MeshTriangle& triangle = mesh.triangles[i];
      const Vec3& normal = mesh.vertex_normals[triangle.vertex[0]];
      const double above = contact_.radius + 2 * kTouchDepth_m;
      spans.push_back({reach(triangle.corner[0] + above * normal),
                       reach(triangle.corner[0] - 2 * kTouchDepth_m * normal)});
    }
    return spans;
  }

  const control::Plan& plan_;
  const Encounter& encounter_;
  const ContactPlan& contact_;
  Frame pose_{};
};

Stand stand(const ContactPlan& contact, const Vec3& at, const Vec3& normal, double depth) {
  return {at, across(contact, normal), 0.5 * depth};
}

/// The place between the two that is kTouchDepth_m deep, by halving; half as deep as `deep` where
/// that is not deeper.
std::optional<Stand> bury(const Object& object, control::State& state, Span span) {
  const double most = object.ask(state, span.deep, span.free).depth;
  if (!(most > 0) || object.ask(state, span.free, span.free).depth > 0) return std::nullopt;
  const Vec3 outside = span.free;
  const double depth = std::min(kTouchDepth_m, 0.5 * most);
  for (int i = 0; i < kHalvings; ++i) {
    const Vec3 middle = 0.5 * (span.free + span.deep);
    (object.ask(state, middle, outside).depth > depth ? span.deep : span.free) = middle;
  }
  return stand(object.contact(), span.deep, object.ask(state, span.deep, outside).normal, depth);
}

struct Anchor {
  Vec3 at, axis;
  double range;
};

Anchor anchor(const control::Plan& plan, const Encounter& e) {
  if (e.kind == ObjectKind::point)
    return {plan.point_guides[e.shape].at, {}, plan.point_guides[e.shape].range};
  if (e.kind == ObjectKind::line) {
    const control::LineGuide& line = plan.line_guides[e.shape];
    return {line.centre, line.axis, line.range};
  }
  const control::CurveGuide& curve = plan.curve_guides[e.shape];
  const Vec3 a = plan.curve_points[curve.first], b = plan.curve_points[curve.first + 1];
  return {0.5 * (a + b), (1 / norm(b - a)) * (b - a), curve.range};
}

std::optional<Stand> beside_guide(const Object& object, const control::Plan& plan,
                                  control::State& state, const Encounter& e) {
  const Anchor guide = anchor(plan, e);
  const Vec3 side = across(object.contact(), guide.axis);
  const double away = std::min(kTouchDepth_m, 0.5 * guide.range);
  const Vec3 at = object.reach(guide.at) + away * side;
  if (!(object.ask(state, at, at).depth > 0)) return std::nullopt;
  return stand(object.contact(), at, side, away);
}

/// Where a field is felt; and how far from `centre` it ends.
struct Influence {
  Vec3 at, centre;
  double radius;
};

Influence influence(const control::Plan& plan, const Encounter& e, const Vec3& side) {
  const auto ball = [](const control::Region& region) {
    return Influence{region.centre, region.centre, region.radius};
  };
  switch (e.kind) {
    case ObjectKind::viscous:
      return ball(plan.viscous_fields[e.shape].region);
    case ObjectKind::constant:
      return ball(plan.constant_fields[e.shape].region);
    case ObjectKind::vibration:
      return ball(plan.vibrations[e.shape].region);
    case ObjectKind::magnet: {
      const control::Magnet& m = plan.magnets[e.shape];
      return {m.centre + (m.radius + 0.5 * m.range) * side, m.centre, m.radius + m.range};
    }
    default: {
      const control::Detents& d = plan.detents[e.shape];
      return {(d.offset + 0.25 * d.spacing) * d.along, {}, build::kBoundless};
    }
  }
}

std::optional<Stand> in_field(const Object& object, const control::Plan& plan, const Encounter& e) {
  const Vec3 side = across(object.contact(), {});
  const Influence field = influence(plan, e, side);
  const Vec3 at = object.reach(field.at);
  if (!(norm(at - field.centre) < field.radius)) return std::nullopt;
  return Stand{at, side, 0.5 * std::min(kTouchDepth_m, field.radius)};
}

}  // namespace

Vec3 reached(const ContactPlan& contact, const Vec3& at) {
  Vec3 result = contact.fixed;
  for (std::size_t i = 0; i < contact.coordinates; ++i)
    result[contact.direction[i]] = at[contact.direction[i]];
  return result;
}

std::optional<Stand> touching_stand(build::Program& program, const Encounter& encounter) {
  const Object object(program.plan(), encounter);
  if (control::is_field(encounter.kind)) return in_field(object, program.plan(), encounter);
  if (control::is_guide(encounter.kind))
    return beside_guide(object, program.plan(), program.state(), encounter);
  for (const Span& span : object.spans()) {
    if (auto found = bury(object, program.state(), span)) return found;
  }
  return std::nullopt;
}

std::optional<Stand> distant_stand(const build::Program& program, const Encounter& encounter) {
  const Object object(program.plan(), encounter);
  const ContactPlan& contact = object.contact();
  const Vec3 side = across(contact, {});
  if (const auto bounds = build::bounds_of(program.spec(), encounter)) {
    const Vec3 half = 0.5 * (bounds->max - bounds->min);
    const double away = norm(half) + contact.radius + kBeyond_m;
    return Stand{reached(contact, bounds->min + half) + away * side, side};
  }
  const std::vector<Span> spans = object.spans();
  if (spans.empty()) return std::nullopt;
  return Stand{spans.front().free, side};
}

control::ContactPlan contact_of(const control::PlaneContact& plane) {
  return {.first_coordinate = plane.first_coordinate,
          .coordinates = plane.coordinates,
          .direction = {0, 1, 2}};
}

Stand touching_stand(const control::PlaneContact& plane) {
  Vec3 normal;
  for (std::size_t i = 0; i < plane.coordinates; ++i) normal[i] = plane.normal[i];
  const Vec3 at = ((plane.offset - kTouchDepth_m) / squared_norm(normal)) * normal;
  return stand(contact_of(plane), at, normal, kTouchDepth_m);
}

}  // namespace hapticd::daemon
