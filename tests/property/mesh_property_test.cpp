// Meshes against searches over all of their triangles, at random points and along random walks.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/generators.h"
#include "tests/support/meshes.h"

namespace hapticd::control {
namespace {

using namespace test;

struct Sample {
  build::TriangleSoup soup;
  build::MeshData mesh;
  double size;  ///< m: all is within this of the origin
};

Sample sample(build::TriangleSoup soup) {
  double size = 0;
  for (const Vec3& vertex : soup.vertices) size = std::fmax(size, norm(vertex));
  auto mesh = build::make_mesh(soup);
  return {std::move(soup), std::move(*mesh), size};
}

build::TriangleSoup two_cubes() {
  build::TriangleSoup soup = box_soup({-0.05, -0.05, -0.05}, {-0.004, 0.05, 0.05});
  add(soup, box_soup({0.004, -0.05, -0.05}, {0.05, 0.05, 0.05}));
  return soup;
}

const Sample& any_mesh() {
  static const std::array<Sample, 6> samples{
      sample(cube_soup()),           sample(sphere_soup(20, 11)),
      sample(bumpy_soup(40, 21)),    sample(groove_soup(0.02, 0.1)),
      sample(plate_soup(0.1, 1e-3)), sample(two_cubes())};
  return samples[*rc::gen::inRange<std::size_t>(0, samples.size())];
}

Vec3 any_point(double size) {
  return {any_number(-size, size), any_number(-size, size), any_number(-size, size)};
}

/// Everywhere, and often right at a vertex, an edge or a face.
Vec3 any_point_of(const Sample& sample) {
  if (*rc::gen::inRange(0, 2) == 0) return any_point(1.2 * sample.size);
  const auto& t =
      sample.soup.triangles[*rc::gen::inRange<std::size_t>(0, sample.soup.triangles.size())];
  const double u = any_number(0, 1), v = *rc::gen::inRange(0, 2) == 0 ? 0 : any_number(0, 1 - u);
  const Vec3& a = sample.soup.vertices[t[0]];
  const Vec3 on = a + u * (sample.soup.vertices[t[1]] - a) + v * (sample.soup.vertices[t[2]] - a);
  return on + any_point(any_number(0, 0.1) * sample.size);
}

RC_GTEST_PROP(MeshProperty, TheNearestPointIsThatOfAllTriangles, ()) {
  const Sample& s = any_mesh();
  const Vec3 p = any_point_of(s);
  const SurfacePoint found = nearest_surface(s.mesh.view(), p, 10);
  const double least = distance_to(s.soup, p);
  RC_ASSERT(std::fabs(std::fabs(found.height) - least) < 1e-14);
  RC_ASSERT(std::fabs(norm(p - found.point) - least) < 1e-14);
  RC_ASSERT(std::fabs(norm(found.outward) - 1) < 1e-14);
}

RC_GTEST_PROP(MeshProperty, TheSideIsThatOfTheSolidAngle, ()) {
  const Sample& s = any_mesh();
  const Vec3 p = any_point_of(s);
  if (distance_to(s.soup, p) < 1e-9) RC_DISCARD("on the surface");
  RC_ASSERT((nearest_surface(s.mesh.view(), p, 10).height < 0) == (winding(s.soup, p) > 0.5));
}

RC_GTEST_PROP(MeshProperty, NothingIsNearerThanTheReach, ()) {
  const Sample& s = any_mesh();
  const Vec3 p = any_point_of(s);
  const double reach = any_number(0, 0.5) * s.size, least = distance_to(s.soup, p);
  if (std::fabs(reach - least) < 1e-14) RC_DISCARD("at the reach");
  RC_ASSERT((nearest_surface(s.mesh.view(), p, reach).triangle != kNoTriangle) == (least < reach));
}

/// Every way from outside to inside goes through the surface.
RC_GTEST_PROP(MeshProperty, AWayInCrossesTheSurface, ()) {
  const Sample& s = any_mesh();
  const auto below_any_face = [&](double depth) {
    const auto& t = s.mesh.triangles[*rc::gen::inRange<std::size_t>(0, s.mesh.triangles.size())];
    const double u = any_number(0, 1), v = any_number(0, 1 - u);
    return t.corner[0] + u * (t.corner[1] - t.corner[0]) + v * (t.corner[2] - t.corner[0]) -
           depth * t.normal;
  };
  const Vec3 a = below_any_face(any_number(-0.5, 0) * s.size);
  const Vec3 b = below_any_face(any_number(0, 0.01) * s.size);
  if (distance_to(s.soup, a) < 1e-9 || distance_to(s.soup, b) < 1e-9) RC_DISCARD("on it");
  if (winding(s.soup, a) > 0.5 || winding(s.soup, b) < 0.5) RC_DISCARD("no way in");
  const std::uint32_t crossed = first_crossing(s.mesh.view(), a, b);
  RC_ASSERT(crossed != kNoTriangle);
  // Up to there the way is free.
  const MeshTriangle& t = s.mesh.triangles[crossed];
  const double share = dot(t.normal, t.corner[0] - a) / dot(t.normal, b - a);
  const Vec3 before = a + any_number(0, 1) * share * (b - a);
  RC_ASSERT(winding(s.soup, before) < 0.5 || distance_to(s.soup, before) < 1e-9);
}

RC_GTEST_PROP(MeshProperty, AFreshContactIsPushedExactlyWhenItIsInside, ()) {
  const Sample& s = any_mesh();
  const Vec3 p = any_point_of(s);
  if (distance_to(s.soup, p) < 1e-9) RC_DISCARD("on the surface");
  MeshWalk walk;
  const Nearest found = nearest(s.mesh.view(), walk, p, p, 0);
  RC_ASSERT((found.depth > 0) == (winding(s.soup, p) > 0.5));
  if (found.depth > 0) RC_ASSERT(std::fabs(found.depth - distance_to(s.soup, p)) < 1e-14);
}

/// Along a walk from outside the proxy is free, and goes no farther from the contact than it was.
RC_GTEST_PROP(MeshProperty, TheProxyStaysFreeAndComesNearer, ()) {
  const Sample& s = any_mesh();
  const double ball = *rc::gen::inRange(0, 2) == 0 ? 0 : any_number(0.01, 0.2) * s.size;
  MeshProbe contact{.mesh = s.mesh.view(), .radius = ball};
  Vec3 x{1.5 * s.size + ball, 0, 0};
  contact.at(x);
  for (int i = 0; i < 100; ++i) {
    x += any_point(0.05 * s.size) - (0.03 * s.size / (norm(x) + 1e-3)) * x;
    const Vec3 from = contact.proxy;
    const double push = norm(contact.at(x));
    RC_ASSERT(push <= norm(x - from) * (1 + 1e-9) + 1e-15);
    const double clear = distance_to(s.soup, contact.proxy);
    RC_ASSERT(clear >= ball * (1 - 1e-8));
    RC_ASSERT(clear < 1e-12 || winding(s.soup, contact.proxy) < 0.5);
  }
}

/// A contact that is held is where no triangle around it is nearer.
RC_GTEST_PROP(MeshProperty, DescentEndsAtALocalMinimum, ()) {
  const Sample& s = any_mesh();
  const Mesh mesh = s.mesh.view();
  const Vec3 p = any_point_of(s);
  const auto start =
      *rc::gen::inRange<std::uint32_t>(0, static_cast<std::uint32_t>(mesh.triangles.size()));
  const SurfacePoint end = descend(mesh, start, p);
  RC_ASSERT(end.triangle != kNoTriangle);
  const double reached = norm(p - end.point);
  const auto [a, b, c] = mesh.triangles[start].corner;
  RC_ASSERT(reached <= distance_to(a, b, c, p) + 1e-15);
  for (int i = 0; i < 20; ++i) {
    // Points of the surface close to the end.
    const SurfacePoint other = nearest_surface(mesh, end.point + any_point(1e-6 * s.size), 1);
    if (norm(other.point - end.point) > 1e-4 * s.size) continue;
    RC_ASSERT(norm(p - other.point) >= reached - 1e-14);
  }
}

}  // namespace
}  // namespace hapticd::control
