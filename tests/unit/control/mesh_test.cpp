// A contact that walks over a mesh feels the surface that the mesh stands for, on the side where it
// came in.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <utility>

#include "tests/support/heap_guard.h"
#include "tests/support/meshes.h"

namespace hapticd::control {
namespace {

using namespace test;
using build::make_mesh;
using build::MeshData;
using build::TriangleSoup;

MeshData mesh_of(TriangleSoup soup) {
  auto mesh = make_mesh(std::move(soup));
  if (!mesh) throw std::runtime_error(mesh.error().text);
  return std::move(*mesh);
}

/// Of the whole trajectory, at 1 kN/m.
struct Felt {
  double rms_N = 0;  ///< against depth along the radius
  double peak_N = 0;
  double ideal_peak_N = 0;  ///< of the distance to the nearest point of all
  int missed = 0;
};

template <class Radius>
Felt follow(const MeshData& mesh, double ball, Radius&& radius) {
  Felt felt;
  MeshProbe contact{.mesh = mesh.view(), .radius = ball};
  double sum = 0;
  int contacts = 0;
  for (int i = 0; i < kProbes; ++i) {
    const Probe p = probe(i);
    const Vec3 out = direction(p.theta, p.phi);
    const Vec3 x = (radius(p.theta, p.phi) + ball - p.depth) * out;
    const Vec3 push = contact.at(x);
    felt.peak_N = std::fmax(felt.peak_N, 1000 * norm(push));
    const double depth = ball - nearest_surface(contact.mesh, x, 1).height;
    felt.ideal_peak_N = std::fmax(felt.ideal_peak_N, 1000 * depth);
    if (p.depth <= 0) continue;
    sum += squared_norm(1000 * (push - p.depth * out));
    ++contacts;
    felt.missed += p.depth > 0.5e-3 && norm(push) == 0 ? 1 : 0;
  }
  felt.rms_N = std::sqrt(sum / contacts);
  return felt;
}

constexpr auto round_surface = [](double, double) { return 0.05; };

/// The error that the facets themselves make against the sphere: closest point of all, no force
/// above the facets.
TEST(MeshContact, ForceErrorOnASphereIsThatOfItsFacets) {
  EXPECT_NEAR(follow(mesh_of(sphere_soup(32, 17)), 0, round_surface).rms_N, 0.279, 0.02 * 0.279);
  EXPECT_NEAR(follow(mesh_of(sphere_soup(100, 51)), 0, round_surface).rms_N, 0.044, 0.02 * 0.044);
  const MeshData fine = mesh_of(sphere_soup(316, 159));
  EXPECT_NEAR(follow(fine, 0, round_surface).rms_N, 0.0112, 0.02 * 0.0112);
  EXPECT_LT(follow(fine, 0.005, round_surface).rms_N, 0.0112);
}

TEST(MeshContact, ABumpySurfaceDoesNotHoldTheContactBack) {
  for (const auto& [nu, nv] : {std::pair{100U, 51U}, {200U, 101U}, {316U, 159U}}) {
    const MeshData mesh = mesh_of(bumpy_soup(nu, nv));
    for (const double ball : {0.0, 0.005}) {
      const Felt felt = follow(mesh, ball, bumpy_radius);
      EXPECT_LT(felt.peak_N, 1.05 * felt.ideal_peak_N) << mesh.triangles.size() << " " << ball;
      EXPECT_GT(felt.peak_N, 0.99 * felt.ideal_peak_N) << mesh.triangles.size() << " " << ball;
    }
  }
}

TEST(MeshContact, TrianglesOfATenthOfASquareMillimetreAreFelt) {
  const Felt felt = follow(mesh_of(sphere_soup(500, 251)), 0, round_surface);  // 250 000
  EXPECT_EQ(felt.missed, 0);
  EXPECT_NEAR(felt.peak_N, 2, 0.01);
}

TEST(MeshContact, TheUnitDoesNotMatter) {
  for (const double unit : {1e-3, 1e3}) {
    TriangleSoup soup = bumpy_soup(100, 51), scaled = soup;
    scale(scaled, unit);
    const MeshData mesh = mesh_of(soup), other = mesh_of(scaled);
    for (const double ball : {0.0, 0.005}) {
      MeshProbe a{.mesh = mesh.view(), .radius = ball},
          b{.mesh = other.view(), .radius = unit * ball};
      for (int i = 0; i < kProbes; i += 7) {
        const Probe p = probe(i);
        const Vec3 x = (bumpy_radius(p.theta, p.phi) + ball - p.depth) * direction(p.theta, p.phi);
        EXPECT_LT(norm((1 / unit) * b.at(unit * x) - a.at(x)), 1e-9) << i;
      }
    }
  }
}

TEST(MeshContact, AWallThinnerThanAStepHolds) {
  const MeshData mesh = mesh_of(plate_soup(0.1, 1e-4));
  for (const double ball : {0.0, 0.005}) {
    MeshProbe contact{.mesh = mesh.view(), .radius = ball};
    for (int i = 0; i < 100; ++i) {
      const double z = 0.002 + ball - 2e-4 * i + 3e-5;
      const Vec3 push = contact.at({0.011, 0.007, z});
      EXPECT_NEAR(push.z, std::fmax(1e-4 + ball - z, 0), 1e-12) << "at " << z;
      EXPECT_NEAR(push.x, 0, 1e-12);
    }
  }
}

TEST(MeshContact, AStartInsideIsPushedOutTheNearestWay) {
  const MeshData mesh = mesh_of(cube_soup());
  MeshProbe contact{.mesh = mesh.view()};
  const Vec3 push = contact.at({0.01, 0.04, -0.02});
  EXPECT_NEAR(push.y, 0.01, 1e-15);
  EXPECT_NEAR(std::hypot(push.x, push.z), 0, 1e-15);
}

TEST(MeshContact, ItSlidesAlongAConcaveCrease) {
  const MeshData mesh = mesh_of(groove_soup(0.02, 0.2));
  MeshProbe contact{.mesh = mesh.view()};
  contact.at({0.001, -0.05, 0.01});
  for (int i = 0; i < 200; ++i) {
    const double y = -0.05 + 5e-4 * i, z = -0.002;
    const Vec3 x{0.0005 * std::sin(0.1 * i), y, z};
    contact.at(x);
    EXPECT_LT(norm(contact.proxy - Vec3{0, y, 0}), 1e-12) << "the line of the crease is nearest";
  }
}

/// Its centre stays r sqrt(2) above the line where two walls at 45 degrees meet.
TEST(MeshContact, ABallInACreaseIsHeldByBothWalls) {
  const MeshData mesh = mesh_of(groove_soup(0.02, 0.2));
  const double ball = 0.005;
  MeshProbe contact{.mesh = mesh.view(), .radius = ball};
  contact.at({0.001, -0.05, 0.02});
  for (int i = 0; i < 200; ++i) {
    const double y = -0.05 + 5e-4 * i, z = ball * std::sqrt(2) - 0.003;
    contact.at({0.002 * std::sin(0.1 * i), y, z});
    EXPECT_LT(norm(contact.proxy - Vec3{0, y, ball * std::sqrt(2)}), 1e-11) << i;
  }
}

TEST(MeshContact, ABallAtAnOutwardEdgeRollsAroundIt) {
  const MeshData mesh = mesh_of(cube_soup());
  const double ball = 0.005;
  MeshProbe contact{.mesh = mesh.view(), .radius = ball};
  for (int i = 0; i <= 90; ++i) {
    const double angle = kPi / 180 * i;
    const Vec3 out{std::sin(angle), 0, std::cos(angle)}, edge{0.05, 0.01, 0.05};
    contact.at(edge + 1.2 * ball * out);
    const Vec3 push = contact.at(edge + 0.7 * ball * out);
    EXPECT_LT(norm(push - 0.3 * ball * out), 1e-14) << i;
  }
}

TEST(MeshContact, ABallTooBigForAGapStaysWhereItWasFree) {
  TriangleSoup soup = box_soup({-0.05, -0.05, 0}, {-0.003, 0.05, 0.05});
  add(soup, box_soup({0.003, -0.05, 0}, {0.05, 0.05, 0.05}));
  const MeshData mesh = mesh_of(soup);
  const double ball = 0.005;
  MeshProbe contact{.mesh = mesh.view(), .radius = ball};
  for (int i = 0; i < 400; ++i) {
    const double z = 0.06 - 1e-4 * i;
    contact.at({0, 0, z});
    EXPECT_GE(nearest_surface(mesh.view(), contact.proxy, 1).height, ball * (1 - 1e-6)) << z;
    EXPECT_GE(contact.proxy.z, 0.05 + 0.0039) << "the rims are sqrt(5^2 - 3^2) = 4 mm below";
  }
}

TEST(MeshContact, AJumpFarAwayIsFoundAgain) {
  const MeshData mesh = mesh_of(sphere_soup(316, 159));
  MeshProbe contact{.mesh = mesh.view()};
  contact.at({0.049, 0, 0});
  const Vec3 push = contact.at({-0.0495, 0.001, 0.001});
  EXPECT_LT(norm(push), 1e-3) << "by the near side, not back to where it was";
}

TEST(MeshContact, NoHeapIsTouched) {
  if (!HeapGuard::available()) GTEST_SKIP() << "this build cannot count heap calls";
  const MeshData mesh = mesh_of(bumpy_soup(100, 51));
  for (const double ball : {0.0, 0.005}) {
    MeshProbe contact{.mesh = mesh.view(), .radius = ball};
    const HeapGuard guard;
    for (int i = 0; i < kProbes; i += 10) {
      const Probe p = probe(i);
      contact.at((bumpy_radius(p.theta, p.phi) + ball - p.depth) * direction(p.theta, p.phi));
    }
    EXPECT_EQ(guard.calls(), 0);
  }
}

TEST(BoxTree, FindsAllThatIsNearAndVisitsLittleElse) {
  std::vector<build::Bounds> bounds;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 at{0.1 * (i % 10), 0.1 * (i / 10 % 10), 0.1 * (i / 100)};
    bounds.push_back({at, at + Vec3{0.01, 0.01, 0.01}});
  }
  const auto tree = build::make_box_tree(bounds, 2);
  std::vector<bool> seen(1000);
  int visits = 0;
  const Vec3 p{0.31, 0.52, 0.77};
  visit_near(tree.view(), p, 0.15, [&](std::uint32_t item) {
    seen[item] = true;
    ++visits;
  });
  for (std::size_t i = 0; i < 1000; ++i) {
    Vec3 out{};
    for (std::size_t k = 0; k < 3; ++k)
      out[k] = std::fmax(std::fmax(bounds[i].min[k] - p[k], p[k] - bounds[i].max[k]), 0);
    EXPECT_TRUE(seen[i] || norm(out) > 0.15) << i;
  }
  EXPECT_LT(visits, 100);
}

}  // namespace
}  // namespace hapticd::control
