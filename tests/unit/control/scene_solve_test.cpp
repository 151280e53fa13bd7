// Coupling and bodies solved together, against closed forms.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/support/scene_fixture.h"

namespace hapticd::test {
namespace {

using control::Free;
using control::ObjectKind;

void expect_near(const Vec3& found, const Vec3& wanted, double tolerance) {
  EXPECT_NEAR(found.x, wanted.x, tolerance);
  EXPECT_NEAR(found.y, wanted.y, tolerance);
  EXPECT_NEAR(found.z, wanted.z, tolerance);
}

Vec3 unit(const Vec3& v) {
  return (1 / norm(v)) * v;
}

build::ProgramSpec with_plane(const Vec3& normal, double offset, const control::Surface& surface) {
  build::ProgramSpec spec = scene_spec();
  add_object(spec, spec.free_planes, ObjectKind::plane, control::Plane{normal, offset}, surface);
  return spec;
}

TEST(SceneSolve, WithoutCouplingABodyPushesByItsDepthAlone) {
  const Vec3 n = unit({1, 2, -2});
  SceneRig plane(with_plane(n, 0.01, surface(1234)));
  plane.start({0.2, 0, 0});
  const Vec3 x{-0.003, 0.004, 0.001};
  expect_near(plane.at(x), 1234 * (0.01 - dot(n, x)) * n, 1e-12);

  build::ProgramSpec spec = scene_spec();
  add_object(spec, spec.spheres, ObjectKind::sphere,
             control::Sphere{{0.1, 0, 0}, 0.05, Free::outside}, surface(2000));
  SceneRig sphere(std::move(spec));
  const Vec3 at = Vec3{0.1, 0, 0} + 0.047 * n;
  expect_near(sphere.at(at), 2000 * 0.003 * n, 1e-11);
}

TEST(SceneSolve, ARigidPlaneThroughASpringIsTheSpringsOwnForce) {
  const Vec3 n = unit({2, -1, 2});
  build::ProgramSpec spec = with_plane(n, 0, rigid());
  spec.coupling = {spring_damper(0, {900, 900, 900})};
  SceneRig rig(std::move(spec));
  rig.start({0.02, 0, 0.02});
  const Vec3 x{-0.004, 0.001, -0.002};
  expect_near(rig.at(x), 900 * (0 - dot(n, x)) * n, 1e-8);  // rigid gives a picometre at 10 N
  expect_near(rig.proxy(), x - dot(n, x) * n, 1e-11);
}

TEST(SceneSolve, ASoftPlaneBehindASpringIsBothInSeries) {
  const Vec3 n{0, 0, 1};
  build::ProgramSpec spec = with_plane(n, 0, surface(500));
  spec.coupling = {spring_damper(0, {2000, 2000, 2000})};
  SceneRig rig(std::move(spec));
  rig.start({0, 0, 0.01});
  expect_near(rig.at({0.003, 0, -0.005}), {0, 0, 0.005 / (1 / 500.0 + 1 / 2000.0)}, 1e-12);
}

TEST(SceneSolve, AnUnevenSpringMovesTheProxyAlongTheWall) {
  // min 1/2 |x - y|_K over n.y >= 0: force n (gap / n'K^-1 n), the proxy slides by K^-1.
  const Vec3 n = unit({1, 1, 0});
  build::ProgramSpec spec = with_plane(n, 0, rigid());
  spec.coupling = {spring_damper(0, {100, 10000, 1000})};
  SceneRig rig(std::move(spec));
  rig.start({0.01, 0.01, 0});
  const Vec3 x{-0.002, 0.0005, 0.001};
  const double give = n.x * n.x / 100 + n.y * n.y / 10000;
  const double push = -dot(n, x) / give;
  expect_near(rig.at(x), push * n, 1e-8);
  expect_near(rig.proxy(), x + push * Vec3{n.x / 100, n.y / 10000, 0}, 1e-12);
}

TEST(SceneSolve, DamperOfTheCouplingActsOnTheChangeOfItsStretch) {
  build::ProgramSpec spec = with_plane({1, 0, 0}, 0, rigid());
  spec.coupling = {spring_damper(0, {600, 600, 600}, {0.3, 0.3, 0.3})};
  SceneRig rig(std::move(spec));
  rig.start({0.001, 0, 0});
  double last = 0;  // stretch of the last tick
  for (const double x : {0.0005, -0.0001, -0.0004, -0.0006, -0.0006, -0.0002}) {
    const double free = x - last * 0.3e3 / (600 + 0.3e3);  // where the proxy would be
    const double proxy = std::max(0.0, free);
    const double stretch = x - proxy;
    const double force = 600 * stretch + 0.3 * (stretch - last) / 1e-3;
    EXPECT_NEAR(rig.at({x, 0, 0}).x, -force, 1e-8);
    EXPECT_NEAR(rig.proxy().x, proxy, 1e-12);
    last = stretch;
  }
}

TEST(SceneSolve, DamperOfAWallCountsFromTheSurfaceAndNeverPulls) {
  // k p + (b/T) min(q, p), q how far the proxy sank; behind a spring K: solved for the proxy.
  const double k = 800, b = 2, spring = 1500, rate = 1e3;
  build::ProgramSpec spec = with_plane({1, 0, 0}, 0, surface(k, b));
  spec.coupling = {spring_damper(0, {spring, spring, spring})};
  SceneRig rig(std::move(spec));
  rig.start({0.002, 0, 0});
  double proxy = 0.002;
  for (const double x : {0.001, -0.001, -0.003, -0.003, -0.002, 0.001, 0.003}) {
    const double entered = std::min(proxy, 0.0);
    // spring (y - x) = -k y + b rate (entered - y) where that pushes
    double y = (spring * x + b * rate * entered) / (spring + k + b * rate);
    if (-k * y + b * rate * (entered - y) < 0 || y > 0) y = x;
    EXPECT_NEAR(rig.at({x, 0, 0}).x, spring * (y - x), 1e-10) << x;
    EXPECT_NEAR(rig.proxy().x, y, 1e-14);
    proxy = y;
  }
}

/// Two or three rigid planes through the origin, all touched: the proxy is the K-nearest point of
/// their common line or point.
struct Crease {
  std::vector<Vec3> normals;
  Vec3 stiffness;
};

class Creases : public testing::TestWithParam<Crease> {};

TEST_P(Creases, AreSolvedAtOnceHoweverSharp) {
  build::ProgramSpec spec = scene_spec();
  const auto& [normals, stiffness] = GetParam();
  Vec3 x;
  for (const Vec3& n : normals) {
    add_object(spec, spec.free_planes, ObjectKind::plane, control::Plane{n, 0}, rigid());
    x -= 0.01 * n;
  }
  spec.coupling = {spring_damper(0, stiffness)};
  SceneRig rig(std::move(spec));
  rig.start(-x);
  const Vec3 found = rig.at(x);
  // min 1/2 |y - x|_K with N'y = 0: f = N l, (N' K^-1 N) l = -N'x.
  const auto count = static_cast<Eigen::Index>(normals.size());
  Eigen::MatrixXd n(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vec3& normal = normals[static_cast<std::size_t>(i)];
    n.col(i) << normal.x, normal.y, normal.z;
  }
  const Eigen::Vector3d k(stiffness.x, stiffness.y, stiffness.z), at(x.x, x.y, x.z);
  const Eigen::MatrixXd give = n.transpose() * k.cwiseInverse().asDiagonal() * n;
  const Eigen::VectorXd push = give.ldlt().solve(-n.transpose() * at);
  ASSERT_GT(push.minCoeff(), 0);
  const Eigen::Vector3d force = n * push;
  expect_near(found, {force.x(), force.y(), force.z()}, 1e-8 * force.norm());
}

INSTANTIATE_TEST_SUITE_P(
    Scene, Creases,
    testing::Values(Crease{{{1, 0, 0}, {0, 1, 0}}, {800, 800, 800}},
                    Crease{{{1, 0, 0}, unit({-0.8, 0.6, 0})}, {800, 800, 800}},
                    Crease{{{1, 0, 0}, unit({-0.97, 0.243, 0})}, {800, 800, 800}},
                    Crease{{{1, 0, 0}, {0, 1, 0}, unit({0, 0.1, 1})}, {500, 500, 500}},
                    Crease{{unit({1, 0, 1}), unit({-1, 0, 1})}, {200, 9000, 3000}}));

TEST(SceneSolve, AnUnevenSpringFindsTheNearestPointOfASphereInItsOwnMetric) {
  build::ProgramSpec spec = scene_spec();
  const double radius = 0.05;
  add_object(spec, spec.spheres, ObjectKind::sphere, control::Sphere{{}, radius, Free::outside},
             rigid());
  const Vec3 k{400, 1500, 3000};
  spec.coupling = {spring_damper(0, k)};
  SceneRig rig(std::move(spec));
  rig.start({0.03, 0.03, 0.04});
  const Vec3 x{0.025, 0.028, 0.032};
  rig.at(x);
  // K (z - x) = l z, |z| = R: bisection for l > 0 in long double.
  const auto z_of = [&](long double l) {
    return std::array<long double, 3>{k.x * x.x / (k.x - l), k.y * x.y / (k.y - l),
                                      k.z * x.z / (k.z - l)};
  };
  long double low = 0, high = 399.9L;
  for (int i = 0; i < 200; ++i) {
    const long double middle = (low + high) / 2;
    const auto z = z_of(middle);
    (z[0] * z[0] + z[1] * z[1] + z[2] * z[2] > radius * radius ? high : low) = middle;
  }
  const auto z = z_of(low);
  expect_near(rig.proxy(),
              {static_cast<double>(z[0]), static_cast<double>(z[1]), static_cast<double>(z[2])},
              1e-11);
}

TEST(SceneSolve, ContactsTiedByASpringShareTheForce) {
  // Two contacts on x tied by K = [a c; c a]; only the first meets a wall.
  build::ProgramSpec spec = scene_spec(2);
  add_object(spec, spec.free_planes, ObjectKind::plane, control::Plane{{1, 0, 0}, 0}, rigid());
  build::CouplingBlock block;
  block.coordinates = {0, 3};
  block.stiffness = {2, 2, {1000, -300, -300, 1000}};
  block.damping = {2, 2, {0, 0, 0, 0}};
  build::CouplingBlock rest = spring_damper(0, {1, 1, 1});
  rest.coordinates = {1, 2, 4, 5};
  rest.stiffness = rest.damping = {4, 4, std::vector<double>(16, 0.0)};
  for (std::size_t i = 0; i < 4; ++i) rest.stiffness(i, i) = 700;
  spec.coupling = {block, rest};
  SceneRig rig(std::move(spec));
  rig.put(1, {0.01, 0, 0});
  rig.start({0.01, 0, 0});
  rig.at({-0.002, 0, 0});
  // y1 = 0; y2 free: its force is zero, so 1000 d2 = 300 d1 ... f1 = -(1000 d1 - 300 d2).
  const double d1 = -0.002, d2 = 0.3 * d1;
  EXPECT_NEAR(rig.force(0).x, -(1000 * d1 - 300 * d2), 1e-8);
  EXPECT_NEAR(rig.force(1).x, 0, 1e-8);
  EXPECT_NEAR(rig.proxy(1).x, 0.01 - d2, 1e-12);
}

TEST(SceneSolve, TheForceLimitIsASpringThatGivesWay) {
  build::ProgramSpec spec = scene_spec(1, 6);
  add_object(spec, spec.free_planes, ObjectKind::plane, control::Plane{{1, 0, 0}, 0},
             surface(5000));
  spec.coupling = {spring_damper(0, {2000, 2000, 2000})};
  SceneRig rig(std::move(spec));
  rig.start({0.01, 0, 0});
  for (const double x : {-0.001, -0.003, -0.02, -0.05, -0.02, -0.004, -0.002}) {
    const double unlimited = -x / (1 / 5000.0 + 1 / 2000.0);
    EXPECT_NEAR(rig.at({x, 0, 0}).x, std::min(unlimited, 6.0), 1e-5) << x;
    EXPECT_LE(rig.force().x, 6.0);
  }
}

TEST(SceneSolve, ASlowLoopInACornerAtTheForceLimitDoesNoWork) {
  build::ProgramSpec spec = scene_spec(1, 6);
  const double s = std::sqrt(0.5);
  add_object(spec, spec.free_planes, ObjectKind::plane, control::Plane{{s, s, 0}, 0}, surface(500));
  add_object(spec, spec.free_planes, ObjectKind::plane, control::Plane{{-s, s, 0}, 0},
             surface(5000));
  spec.coupling = {spring_damper(0, {2000, 2000, 2000})};
  SceneRig rig(std::move(spec));
  const int steps = 20000;
  const auto place = [&](int i) {
    const double angle = 2 * 3.14159265358979323846 * i / steps;
    return Vec3{0.005 * std::cos(angle), -0.008 + 0.005 * std::sin(angle), 0};
  };
  rig.start({0, 0.02, 0});
  for (int i = 0; i < steps; ++i) rig.at(place(i));
  double work = 0, limited = 0;
  Vec3 last = place(0), force = rig.at(last);
  for (int i = 1; i <= steps; ++i) {
    const Vec3 next = place(i);
    const Vec3 before = force;
    force = rig.at(next);
    work += 0.5 * dot(before + force, next - last);
    limited += rig.findings.limits.has(Limit::force);
    last = next;
  }
  EXPECT_GT(limited, 0.5 * steps);
  EXPECT_NEAR(work, 0, 1e-9);
}

TEST(SceneSolve, WithoutASweepTheProxiesStayWhereTheyAre) {
  build::ProgramSpec spec = with_plane({1, 0, 0}, 0, rigid());
  spec.coupling = {spring_damper(0, {600, 600, 600})};
  spec.max_sweeps = 0;
  SceneRig rig(std::move(spec));
  rig.start({0.01, 0.002, 0});
  expect_near(rig.at({-0.002, 0.003, 0}), 600 * Vec3{0.012, -0.001, 0}, 1e-12);
  expect_near(rig.proxy(), {0.01, 0.002, 0}, 0);
}

TEST(SceneSolve, AGeneralFilterThatIsASpringAndADamperIsOne) {
  // V = 1 / (K + B (1 - 1/z) / T) as a state space: d = C xi + D f, xi the last stretch.
  const double k = 700, b = 0.2, z = k + b / 1e-3;
  build::CouplingBlock filter;
  filter.coordinates = {0};
  filter.state_space = build::CouplingBlock::StateSpace{
      {1, 1, {b / 1e-3 / z}}, {1, 1, {1 / z}}, {1, 1, {b / 1e-3 / z}}, {1, 1, {1 / z}}};
  build::CouplingBlock spring = spring_damper(0, {k, k, k}, {b, b, b});
  const auto rig_with = [](std::vector<build::CouplingBlock> blocks) {
    build::ProgramSpec spec = with_plane({1, 0, 0}, 0, surface(2000));
    spec.coupling = std::move(blocks);
    return spec;
  };
  SceneRig plain(rig_with({spring}));
  SceneRig general(rig_with({filter}));
  plain.start({0.002, 0, 0});
  general.start({0.002, 0, 0});
  for (int tick = 0; tick < 200; ++tick) {
    const Vec3 x{0.003 * std::cos(0.1 * tick), 0, 0};
    EXPECT_NEAR(general.at(x).x, plain.at(x).x, 1e-10);
  }
}

TEST(SceneSolve, AMassBehindASpringIsFeltThroughAWallAndTheWallThroughTheMass) {
  // The contact's proxy y meets a soft wall at 0 and pulls a mass m by a spring c; backward Euler:
  // K (x - y) - c (y - p) + k max(0, -y) = 0, m (p - 2 p1 + p2) / T^2 = c (y - p).
  const double spring = 900, k = 3000, c = 400, m = 0.3, t2 = 1e-6;
  build::ProgramSpec spec = with_plane({1, 0, 0}, 0, surface(k));
  spec.coupling = {spring_damper(0, {spring, spring, spring})};
  spec.networks = {{.nodes = {{.mass = m}}, .elements = {}}};
  using build::NetworkEnd;
  spec.networks[0].elements = {
      {{NetworkEnd::At::coordinate, 0}, {NetworkEnd::At::node, 0}, c, 0, 0}};
  SceneRig rig(std::move(spec));
  rig.start({0, 0, 0});
  double p1 = 0, p2 = 0;
  for (int tick = 1; tick < 400; ++tick) {
    const double x = -0.004 * std::sin(0.05 * tick);
    // p = (c y + m (2 p1 - p2) / T^2) / (c + m / T^2): eliminated, the rest is linear in y.
    const double share = c / (c + m / t2), fixed = m / t2 * (2 * p1 - p2) / (c + m / t2);
    const double held = spring + c * (1 - share), pull = spring * x + c * fixed;
    const double y = pull / held < 0 ? pull / (held + k) : pull / held;
    const double p = share * y + fixed;
    EXPECT_NEAR(rig.at({x, 0, 0}).x, spring * (y - x), 1e-9) << tick;
    EXPECT_NEAR(rig.proxy().x, y, 1e-12);
    p2 = p1;
    p1 = p;
  }
}

TEST(SceneSolve, StartingInsideHoldsOnToTheNearestFreePoint) {
  build::ProgramSpec spec = with_plane({0, 1, 0}, 0, surface(1000));
  SceneRig rig(std::move(spec));
  expect_near(rig.start({0, -0.004, 0}), {0, 4, 0}, 1e-12);
  expect_near(rig.at({0, -0.003, 0}), {0, 3, 0}, 1e-12);
}

}  // namespace
}  // namespace hapticd::test
