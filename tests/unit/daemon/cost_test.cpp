#include "daemon/cost.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "daemon/cost_object.h"
#include "daemon/cost_parts.h"
#include "daemon/cost_place.h"
#include "daemon/cost_predict.h"
#include "daemon/cost_table.h"
#include "daemon/ctl_cost.h"
#include "tests/support/any_shape.h"
#include "tests/support/every_kind.h"
#include "tests/support/scene_fixture.h"

namespace hapticd::daemon {
namespace {

using control::ObjectKind;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double kTight = 1e-12;

/// One device of three axes and one object of 1000 N/m.
template <class Shape>
build::ProgramSpec scene_of(std::vector<Shape> build::ProgramSpec::*list, ObjectKind kind,
                            const Shape& shape) {
  build::ProgramSpec spec = test::scene_spec();
  test::add_object(spec, spec.*list, kind, shape, test::surface(1000));
  return spec;
}

/// The contact's force there [N], rendered by the whole tick.
double force_at(const build::ProgramSpec& spec, const Stand& stand) {
  CostRig rig(with_ideal_devices(spec));
  Walk walk;
  for (auto& raw : walk) raw = {stand.at.x, stand.at.y, stand.at.z};
  rig.walk(walk);
  rig.run(5);
  EXPECT_TRUE(rig.enabled());
  const auto f = rig.program().state().scene_force;
  return std::hypot(f[0], f[1], f[2]);
}

/// A millimetre deep by the shape's own signed distance, and felt as 1000 N/m of that; nothing a
/// metre away.
template <class Shape>
void expect_touched(const build::ProgramSpec& spec, const Shape& shape) {
  build::Program program(spec);
  const control::Encounter& encounter = program.plan().encounters[0];
  const auto stand = touching_stand(program, encounter);
  ASSERT_TRUE(stand);
  EXPECT_NEAR(test::body::signed_distance(shape, stand->at), -kTouchDepth_m, 1e-9);
  EXPECT_NEAR(force_at(spec, *stand), 1, 1e-6);
  EXPECT_NEAR(norm(stand->along), 1, kTight);
  const auto away = distant_stand(program, encounter);
  ASSERT_TRUE(away);
  EXPECT_GT(test::body::signed_distance(shape, away->at), 0.9);
  EXPECT_EQ(force_at(spec, *away), 0);
}

TEST(CostPlace, ASurfaceIsTouchedAMillimetreDeepAndNotFromAMetreAway) {
  const control::Sphere sphere{.centre = {1, 2, 3}, .radius = 0.05};
  expect_touched(scene_of(&build::ProgramSpec::spheres, ObjectKind::sphere, sphere), sphere);
  const control::Box box{.frame = {diagonal(1), {1, 2, 3}}, .half = {0.1, 0.2, 0.3}};
  expect_touched(scene_of(&build::ProgramSpec::boxes, ObjectKind::box, box), box);
  const control::Cylinder can{
      .centre = {1, 2, 3}, .axis = {0, 0.6, 0.8}, .radius = 0.05, .half = 0.2};
  expect_touched(scene_of(&build::ProgramSpec::cylinders, ObjectKind::cylinder, can), can);
  const control::Capsule pill{
      .centre = {1, 2, 3}, .axis = {0.6, 0, 0.8}, .radius = 0.05, .half = 0.2};
  expect_touched(scene_of(&build::ProgramSpec::capsules, ObjectKind::capsule, pill), pill);
  const control::Plane plane{.normal = {0.6, 0, 0.8}, .offset = 0.3};
  expect_touched(scene_of(&build::ProgramSpec::free_planes, ObjectKind::plane, plane), plane);
}

TEST(CostPlace, ACavityIsTouchedFromWithin) {
  const control::Sphere cave{.centre = {1, 0, 0}, .radius = 0.5, .free = control::Free::inside};
  const auto spec = scene_of(&build::ProgramSpec::spheres, ObjectKind::sphere, cave);
  build::Program program(spec);
  const auto stand = touching_stand(program, program.plan().encounters[0]);
  ASSERT_TRUE(stand);
  EXPECT_NEAR(norm(stand->at - cave.centre), 0.5 + kTouchDepth_m, 1e-9);
  const auto away = distant_stand(program, program.plan().encounters[0]);
  ASSERT_TRUE(away);
  EXPECT_EQ(force_at(spec, *away), 0);
}

TEST(CostPlace, WhatIsThinnerIsTouchedHalfAsDeepAsItIs) {
  const control::Sphere grain{.centre = {0, 0, 0}, .radius = 0.4e-3};
  build::Program program(scene_of(&build::ProgramSpec::spheres, ObjectKind::sphere, grain));
  const auto stand = touching_stand(program, program.plan().encounters[0]);
  ASSERT_TRUE(stand);
  EXPECT_NEAR(norm(stand->at), 0.2e-3, 1e-9);
  EXPECT_LE(stand->amplitude, 0.1e-3 + 1e-9);
}

TEST(CostPlace, AContactThatCannotGetThereHasNoPlace) {
  build::ProgramSpec spec = scene_of(&build::ProgramSpec::spheres, ObjectKind::sphere,
                                     control::Sphere{.centre = {0.2, 0.03, 0}, .radius = 0.05});
  spec.contacts[0].coordinates = 1;  // along x, at y = z = 0
  {
    build::Program program(spec);
    const auto stand = touching_stand(program, program.plan().encounters[0]);
    ASSERT_TRUE(stand);  // the chord at y = 0 is 2 * 0.04 long
    EXPECT_NEAR(norm(stand->at - Vec3{0.2, 0.03, 0}), 0.049, 1e-9);
    EXPECT_EQ(stand->at.y, 0);
  }
  spec.spheres[0].centre.y = 0.06;
  build::Program program(spec);
  EXPECT_FALSE(touching_stand(program, program.plan().encounters[0]));
}

TEST(CostPlace, APlaneThatIsRenderedDirectlyIsTouchedToo) {
  const control::PlaneContact plane{
      .coordinates = 2, .normal = {0.6, 0.8}, .offset = 0.1, .stiffness = 500};
  const Stand stand = touching_stand(plane);
  EXPECT_NEAR(0.6 * stand.at.x + 0.8 * stand.at.y, 0.1 - kTouchDepth_m, kTight);
}

TEST(CostMeasure, AWalkGoesToAndFroInFifths) {
  double lowest = 0, highest = 0;
  for (std::size_t i = 0; i < kWalkTicks; ++i) {
    EXPECT_NEAR(std::abs(walked(i + 1) - walked(i)), 0.2, kTight);
    lowest = std::min(lowest, walked(i));
    highest = std::max(highest, walked(i));
  }
  EXPECT_NEAR(lowest, -1, kTight);
  EXPECT_NEAR(highest, 1, kTight);
}

TEST(CostMeasure, AFigureIsTheMedianAndBelowItsSpreadNotSeen) {
  std::vector<double> steady(101, 5.0), noisy;
  EXPECT_EQ(median_figure(steady, 0.5).ns, 5);
  EXPECT_EQ(median_figure(steady, 0.5).resolution_ns, 0.5);
  EXPECT_TRUE(median_figure(steady, 0.5).seen());
  EXPECT_FALSE(median_figure(steady, 6).seen());
  // Uniform on [-50, 50]: quartiles 50 apart, sigma 37, three errors of the median 13.9.
  for (int i = 0; i <= 100; ++i) noisy.push_back(static_cast<double>((i * 37) % 101) - 50 + 4);
  const Figure figure = median_figure(noisy, 0);
  EXPECT_EQ(figure.ns, 4);
  EXPECT_NEAR(figure.resolution_ns, 3 * 1.253 * (50 / 1.349) / std::sqrt(101.0), 1e-9);
  EXPECT_FALSE(figure.seen());
  std::vector<double> below(101, -3.0);
  EXPECT_EQ(median_figure(below, 0).ns, 0);
}

config::Compiled compiled(const std::string& text) {
  auto made = config::read_text(text, "test").and_then(config::compile);
  EXPECT_TRUE(made) << config::to_string(made.error().front());
  return std::move(made.value());
}

std::string every_kind(bool coupled) {
  return test::every_kind_text(coupled, HAPTICD_SOURCE_DIR "/config/examples/ball.obj");
}

/// `count` spheres of 1 cm in a row.
std::string spheres(int count) {
  std::string text = every_kind(false);
  text.resize(text.find("scene:"));
  text += "scene:\n";
  for (int i = 0; i < count; ++i) {
    text += "  - sphere: {name: s" + std::to_string(i) + ", center_m: [" + std::to_string(i) +
            ", 0, 0], radius_m: 0.01, stiffness_N_m: 800}\n";
  }
  return text + "stability: {require: none}\n";
}

TEST(Cost, EveryKindIsTouchedAndHasFigures) {
  for (const bool coupled : {false, true}) {
    const config::Compiled config = compiled(every_kind(coupled));
    const CostReport report = cost(config, {.ticks = 1000});
    ASSERT_EQ(report.objects.size(), config.document.config.scene.size());
    for (const ObjectCost& object : report.objects) {
      EXPECT_TRUE(object.touched.measured) << object.name << ": " << object.touched.note;
      EXPECT_TRUE(object.distant.measured) << object.name << ": " << object.distant.note;
      EXPECT_GT(object.touched.predicted_ns, 0) << object.kind;
    }
    EXPECT_TRUE(report.busiest.measured);
    EXPECT_FALSE(report.busiest_name.empty());
    EXPECT_GT(report.stages[0].cost.measured->ns, 0);
  }
}

TEST(Cost, TheBroadPhaseHoldsBackWhatIsBoundedInAScene) {
  const CostReport few = cost(compiled(spheres(3)), {.ticks = 1000});
  EXPECT_THAT(few.objects[0].distant.note, IsEmpty());
  EXPECT_EQ(few.stages[3].cost.predicted_ns, 0);
  const CostReport many = cost(compiled(spheres(20)), {.ticks = 1000});
  EXPECT_EQ(many.objects[0].distant.measured->ns, 0);
  EXPECT_THAT(many.objects[0].distant.note, HasSubstr("broad phase"));
  EXPECT_GT(many.stages[3].cost.measured->ns, 0);
}

TEST(Cost, BeyondFiftyOfAKindTheRestIsOneRow) {
  const CostReport report = cost(compiled(spheres(57)), {.ticks = 1000});
  ASSERT_EQ(report.objects.size(), 51u);
  EXPECT_EQ(report.objects.back().count, 7u);
  EXPECT_THAT(cost_text(report, {}), HasSubstr("and 7 more of kind sphere"));
}

TEST(Cost, TotalsAreTheSumsOfTheRows) {
  const CostReport report = cost(compiled(every_kind(false)), {.ticks = 1000});
  double predicted = 0, measured = 0;
  for (const StageCost& stage : report.stages) {
    predicted += stage.cost.predicted_ns;
    measured += stage.cost.measured->ns;
  }
  for (const ObjectCost& object : report.objects) {
    predicted += object.distant.predicted_ns;
    measured += object.distant.measured->ns;
  }
  EXPECT_NEAR(report.untouched.predicted_ns, predicted, 1e-6);
  EXPECT_NEAR(report.untouched.measured->ns, measured, 1e-6);
  EXPECT_GE(report.busiest.measured->ns, measured);
}

TEST(Cost, WhatIsBelowTheResolutionIsPrintedAsSuchAndNothingIsNegative) {
  CostReport report{.period_ns = 1e6, .ticks = 1010, .floor_ns = 2};
  report.stages = {{"loop", {.predicted_ns = 80, .measured = Figure{100, 1}}},
                   {"observers", {.predicted_ns = 3, .measured = Figure{1, 2}}}};
  report.untouched = {.predicted_ns = 83, .measured = Figure{101, 2}};
  const std::string text = cost_text(report, {.processor = "P", .kernel = "K", .load = "0.5"});
  EXPECT_THAT(text, AllOf(HasSubstr("P, K, load 0.5"), HasSubstr("100 ns"), HasSubstr("0.010 %"),
                          HasSubstr("< 2.0 ns"), HasSubstr(std::string(kReferenceMachine))));
  EXPECT_THAT(text, Not(testing::ContainsRegex("-[0-9]")));
  const Json json = cost_json(report, {});
  EXPECT_EQ(json["stages"]["loop"]["measured_ns"], 100);
  EXPECT_TRUE(json["stages"]["observers"]["measured_ns"].is_null());
  EXPECT_EQ(json["stages"]["observers"]["resolution_ns"], 2);
}

TEST(CostPredict, AddsUpWhatTheTableHas) {
  const config::Compiled config = compiled(every_kind(true));
  const control::Plan& plan = config.program->plan();
  EXPECT_DOUBLE_EQ(predicted_loop_ns(config.program->spec()),
                   kLoop_ns + kLoopDevice_ns + 3 * kLoopAxis_ns);
  EXPECT_EQ(predicted_observers_ns(config.program->spec()), 0);
  EXPECT_DOUBLE_EQ(predicted_coupling_ns(plan),
                   kContact_ns + kGroup_ns + kGain_ns * static_cast<double>(plan.gains.size()));
  EXPECT_DOUBLE_EQ(predicted_broad_phase_ns(plan), kBroadPhase_ns);
}

TEST(CostPredict, TheTableHasEveryKindOfTheScene) {
  for (const config::SceneObject& object : compiled(every_kind(false)).document.config.scene) {
    const std::string kind = kind_name(object);
    const auto has = [&](const KindCost& cost) { return cost.kind == kind && cost.touched_ns > 0; };
    EXPECT_TRUE(std::any_of(kKindCosts.begin(), kKindCosts.end(), has)) << kind;
  }
}

}  // namespace
}  // namespace hapticd::daemon
