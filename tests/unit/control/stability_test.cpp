#include "control/design/check/stability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/program_fixture.h"
#include "tests/support/scene_fixture.h"

namespace hapticd::check {
namespace {

PassiveAnswer answer(build::ProgramSpec spec, std::vector<double> damping, double latency_s = 0) {
  const build::Program program(std::move(spec));
  return passive(program.plan(),
                 {{.name = "left", .latency_s = latency_s, .min_damping = std::move(damping)}})
      .at(0);
}

build::ProgramSpec walls(std::size_t axes, std::vector<control::PlaneContact> planes) {
  auto spec = test::spec_of(axes);
  spec.planes = std::move(planes);
  return spec;
}

TEST(Passive, OneAxisIsColgatesCondition) {
  const auto yes = answer(walls(1, {test::wall(1000, 0.2)}), {0.71});
  EXPECT_TRUE(yes.proved);
  EXPECT_NEAR(yes.damping_used, 0.7 / 0.71, 1e-12);
  EXPECT_NEAR(yes.stiffness_factor, 0.51 / 0.5, 1e-12);
  EXPECT_NEAR(yes.longest_hold_s, 1e-3 * 0.71 / 0.7, 1e-15);
  EXPECT_FALSE(answer(walls(1, {test::wall(1000, 0.2)}), {0.69}).proved);
}

TEST(Passive, EqualityIsNoProof) {
  EXPECT_FALSE(answer(walls(1, {test::wall(1000, 0)}), {0.5}).proved);
}

TEST(Passive, PaperTwosWallIsNot) {  // only K <= 44 N/m would be: 2 b / T
  const auto no = answer(walls(1, {test::wall(1000, 1)}), {0.022});
  EXPECT_FALSE(no.proved);
  EXPECT_EQ(no.stiffness_factor, 0.0) << "B alone is too much";
  EXPECT_TRUE(answer(walls(1, {test::wall(43.9, 0)}), {0.022}).proved);
  EXPECT_FALSE(answer(walls(1, {test::wall(44.1, 0)}), {0.022}).proved);
}

TEST(Passive, MissingModelAndUndampedAxisAreNotCertified) {
  const auto spec = walls(1, {test::wall(10, 0)});
  EXPECT_NE(answer(spec, {}).why.find("model"), std::string::npos);
  EXPECT_NE(answer(spec, {0.0}).why.find("damping"), std::string::npos);
  for (const auto& no : {answer(spec, {}), answer(spec, {0.0})}) EXPECT_FALSE(no.proved);
}

TEST(Passive, AWallUnderLatencyNeedsMoreDampingAndNoneOfItsOwn) {
  // b > (K/2) [T/2 + tau + sqrt((T/2 + tau)^2 + t (T - t))]: .808, 1.059 and 1.5 K T at a quarter,
  // half and all of a period (sweeps over all frequencies gave the same); t (T - t) at its largest
  // from half a period on, because the latency may also be shorter.
  const auto wall = walls(1, {test::wall(1000, 0)});
  EXPECT_NEAR(answer(wall, {1.0}, 0.25e-3).damping_used, 0.8080, 5e-4);
  EXPECT_NEAR(answer(wall, {1.0}, 0.5e-3).damping_used, 1.0590, 5e-4);
  EXPECT_NEAR(answer(wall, {2.0}, 1e-3).damping_used,
              0.5 * 0.5 * (1.5 + std::sqrt(1.5 * 1.5 + 0.25)), 1e-12);
  const auto no = answer(walls(1, {test::wall(10, 0.1)}), {1.0}, 1e-4);
  EXPECT_FALSE(no.proved);
  EXPECT_NE(no.why.find("latency"), std::string::npos) << no.why;
}

build::ProgramSpec coupled(double stiffness, double damping, double sharpen = 0) {
  build::ProgramSpec spec = test::scene_spec();
  test::add_object(spec, spec.spheres, control::ObjectKind::sphere,
                   control::Sphere{{}, 0.05, control::Free::outside}, test::rigid(0.8, 0.4));
  spec.coupling = {
      test::spring_damper(0, {stiffness, stiffness, stiffness}, {damping, damping, damping})};
  spec.sharpen = {sharpen};
  return spec;
}

TEST(Passive, ThroughACouplingOnlyTheCouplingCounts) {  // the paper's device carries 2740 N/m
  EXPECT_TRUE(answer(coupled(2739, 0), {1.37, 1.37, 1.37}).proved);
  EXPECT_FALSE(answer(coupled(2741, 0), {1.37, 1.37, 1.37}).proved);
  EXPECT_NEAR(answer(coupled(1000, 0.2), {1.4, 1.4, 1.4}).damping_used, 0.5, 1e-12);
}

TEST(Passive, UnderLatencyACouplingNeedsTheSharperCheckInTheLoop) {
  // s = 0.89 T at tau = 0.2 T; g = tau/T + tau (T - tau) lambda / T, lambda = K / Delta.
  const std::vector<double> damping{2, 2, 2};
  const double g = 0.2 + 0.2 * 0.8e-3 * 1000 / 2;
  const auto yes = answer(coupled(1000, 0, g), damping, 0.2e-3);
  EXPECT_TRUE(yes.proved) << yes.why;
  EXPECT_NEAR(yes.damping_used, 0.89 / 2, 1e-3);
  const auto blunt = answer(coupled(1000, 0, 0.9 * g), damping, 0.2e-3);
  EXPECT_FALSE(blunt.proved);
  EXPECT_NE(blunt.why.find("descent check"), std::string::npos) << blunt.why;
  EXPECT_FALSE(answer(coupled(1000, 0.01, 1), damping, 0.2e-3).proved);
  EXPECT_FALSE(answer(coupled(1000, 0, 1), damping, 1.1e-3).proved);
}

TEST(Passive, BodiesWithoutCouplingAddUpWhereTheyCanBeTouchedTogether) {
  const auto spheres = [](double distance) {
    build::ProgramSpec spec = test::scene_spec();
    for (control::AxisPlan& axis : spec.axes) axis.max_step = 1e-3;
    for (int i = 0; i < 20; ++i) {
      test::add_object(spec, spec.spheres, control::ObjectKind::sphere,
                       control::Sphere{{i * distance, 0, 0}, 0.01, control::Free::outside},
                       test::surface(100));
    }
    return spec;
  };
  const std::vector<double> damping{1, 1, 1};
  EXPECT_NEAR(answer(spheres(0.001), damping).damping_used, 20 * 0.05, 1e-12);
  EXPECT_NEAR(answer(spheres(0.05), damping).damping_used, 0.05, 1e-12);
  EXPECT_FALSE(answer(spheres(0.05), damping, 1e-4).proved) << "not convex, and no coupling";
}

TEST(Passive, FrictionCompensationAsksItsSlope) {
  auto spec = walls(1, {test::wall(1000, 0.2)});
  spec.frictions = {{.axis = 0, .viscous = 0.1, .coulomb = 0.02, .smooth = 0.1}};
  EXPECT_NEAR(answer(spec, {2.0}).damping_used, (0.5 + 0.2 + 0.3) / 2, 1e-12);
  EXPECT_NEAR(answer(spec, {2.0}).longest_hold_s, 2e-3, 1e-15);
}

TEST(Passive, TravelSpringsCountOnceForBothEnds) {
  auto spec = walls(1, {});
  spec.travels = {{.axis = 0, .min = -1, .max = 1, .stiffness = 400, .max_effort = 1, .margin = 1}};
  EXPECT_NEAR(answer(spec, {1.0}).damping_used, 0.2, 1e-12);
}

TEST(Passive, AScaledWorkspaceIsStifferByItsSquare) {
  auto spec = walls(1, {test::wall(1000, 0)});
  spec.cartesian_axes = {{.axis = 0, .coordinate = 0, .scale = -3}};
  EXPECT_NEAR(answer(spec, {9.0}).damping_used, 0.5, 1e-12);
}

TEST(Passive, ATurnedDeviceMeetsThePlaneWithBothItsAxes) {
  auto spec = walls(2, {test::wall(1000, 0, 2)});
  spec.linkages = {{.axes = 2, .coordinates = 2, .turn = {{{0.6, -0.8, 0}, {0.8, 0.6, 0}}}}};
  spec.linear_maps = {{.columns = {{{1, 0}, {0, 1}, {0, 0}}}}};
  // n = (0.6, -0.8) in joint coordinates: 0.5 (0.36 / d1 + 0.64 / d2).
  EXPECT_NEAR(answer(spec, {1.0, 2.0}).damping_used, 0.5 * (0.36 + 0.32), 1e-12);
}

TEST(Passive, ObstaclesAreNamedAndNothingIsProved) {
  const build::Program program(walls(1, {test::wall(10, 0)}));
  const auto no =
      passive(program.plan(),
              {{.name = "left", .min_damping = {1.0}, .obstacles = {"the first", "the second"}}})
          .at(0);
  EXPECT_FALSE(no.proved);
  EXPECT_EQ(no.why, "the first; the second");
}

TEST(Passive, PlanesInACornerAddUpAndRightAnglesDoNotDisturb) {
  control::PlaneContact floor = test::wall(1000, 0, 2);
  floor.normal = {0, 1, 0};
  EXPECT_NEAR(answer(walls(2, {test::wall(1000, 0, 2), floor}), {1, 1}).damping_used, 0.5, 1e-12);
  EXPECT_NEAR(
      answer(walls(2, {test::wall(1000, 0, 2), test::wall(1000, 0, 2)}), {1, 1}).damping_used, 1.0,
      1e-12);
}

TEST(Passive, ObliquePlaneWeighsTheDampingOfEachAxis) {
  control::PlaneContact plane = test::wall(1000, 0, 2);
  plane.normal = {0.6, 0.8, 0};
  // rank one: share = k T/2 n' Delta^-1 n
  EXPECT_NEAR(answer(walls(2, {plane}), {2, 0.5}).damping_used, 0.5 * (0.36 / 2 + 0.64 / 0.5),
              1e-12);
}

TEST(Passive, ToleratedHoldIsToldOnlyWithAProof) {
  const auto three = answer(walls(1, {test::wall(1000, 0)}), {1.6});  // held up to 3.2 periods
  EXPECT_NE(three.why.find("2 missed ticks"), std::string::npos) << three.why;
  const auto no = answer(walls(1, {test::wall(1000, 0)}), {0.4});
  EXPECT_EQ(no.why.find("missed"), std::string::npos) << no.why;
  EXPECT_NE(no.why.find("0.8 times"), std::string::npos) << no.why;
}

TEST(Passive, EmptySceneNeedsNothing) {
  const auto yes = answer(walls(1, {}), {1e-6});
  EXPECT_TRUE(yes.proved);
  EXPECT_EQ(yes.damping_used, 0.0);
}

}  // namespace
}  // namespace hapticd::check
