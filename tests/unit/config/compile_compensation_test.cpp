// Observers, friction and weight: what the plan gets, what is refused, and what the proof assumes.
#include <cmath>
#include <numbers>

#include "tests/unit/config/five_bar_text.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

/// One axis of 0.05 kg and 1.37 N s/m, at least 1.096, with dry friction and more keys.
std::string with_compensated(const std::string& keys) {
  return replaced(replaced(kSmall, "damping_Ns_m: 1.37,", "damping_Ns_m: 1.37, coulomb_N: 0.3,"),
                  "scene:\n", "        " + keys + "\nscene:\n");
}
std::string with_observer(const std::string& keys) {
  return with_compensated("observer: {" + keys + "}");
}

TEST(CompileFriction, SharesOfTheModelAreCompensated) {
  const Compiled compiled = compiled_of(
      with_compensated("compensation: {viscous_share: 0.2, coulomb_share: 0.5, smooth_m_s: 0.5}"));
  const auto frictions = compiled.program->plan().frictions;
  ASSERT_EQ(frictions.size(), 1U);
  EXPECT_DOUBLE_EQ(frictions[0].viscous, 0.2 * 1.37);
  EXPECT_DOUBLE_EQ(frictions[0].coulomb, 0.15);
  EXPECT_EQ(frictions[0].smooth, 0.5);
}

TEST(CompileFriction, DefaultSlopeTakesHalfOfWhatTheLeastDampingLeaves) {
  const Compiled compiled =
      compiled_of(with_compensated("compensation: {viscous_share: 0.2, coulomb_share: 0.5}"));
  const control::FrictionAxis& friction = compiled.program->plan().frictions[0];
  const double left = 1.37 * 0.8 - 0.2 * 1.37;
  EXPECT_NEAR(friction.coulomb / friction.smooth, left / 2, 1e-12);
}

TEST(CompileFriction, PassivityControllerGetsWhatTheSlopeLeavesAndTheProofCountsTheSlopeItself) {
  const Compiled compiled = compiled_of(
      with_compensated("compensation: {viscous_share: 0.2, coulomb_share: 0.5, smooth_m_s: 0.5}"));
  const double left = 1.37 * 0.8 - 0.2 * 1.37 - 0.15 / 0.5;
  ASSERT_EQ(compiled.assumed[0].min_damping.size(), 1U);
  EXPECT_NEAR(compiled.assumed[0].min_damping[0], 1.37 * 0.8, 1e-12);
  EXPECT_NEAR(compiled.program->plan().axes[0].min_damping, left, 1e-12);
}

TEST(CompileFriction, SlopeThatCouldLimitCycleIsRefused) {
  // 0.15 N / 0.1 m/s = 1.5 N s/m is more than 1.096.
  expect_error(with_compensated("compensation: {coulomb_share: 0.5, smooth_m_s: 0.1}"), "13:39",
               "devices[0].axes[0].compensation.coulomb_share",
               {"1.5 N s/m", "1.096", "smooth_m_s"});
  expect_error(with_compensated("compensation: {viscous_share: 0.8}"), "13:39",
               "devices[0].axes[0].compensation.viscous_share", {"1.096"});
  EXPECT_TRUE(errors_of(with_compensated("compensation: {viscous_share: 0.79}")).empty());
}

TEST(CompileFriction, ShareOfNothingIsRefused) {
  expect_error(
      replaced(with_compensated("compensation: {coulomb_share: 0.5}"), ", coulomb_N: 0.3", ""),
      "13:39", "devices[0].axes[0].compensation.coulomb_share", {"no dry friction"});
  const std::string text = with_compensated("compensation: {viscous_share: 0.5}");
  const auto model = text.find("        model:");
  expect_error(replaced(std::string(text).erase(model, text.find('\n', model) + 1 - model),
                        "latency_s: 0", "sim: {axes: [{mass_kg: 1}]}\n    latency_s: 0"),
               "13:39", "devices[0].axes[0].compensation.viscous_share", {"no model"});
}

TEST(CompileGravity, WeightOfAxes) {
  const Compiled compiled = compiled_of(with_compensated("compensation: {gravity_N: 2}"));
  ASSERT_EQ(compiled.program->plan().gravity_axes.size(), 1U);
  EXPECT_EQ(compiled.program->plan().gravity_axes[0].constant, 2);
  expect_error(with_compensated("compensation: {swing_Nm: 1}"), "13:34",
               "devices[0].axes[0].compensation.swing_Nm", {"linear", "gravity_N"});
  const Compiled arm = compiled_of(replaced(
      kFiveBar, "        kind: rotary\n",
      "        kind: rotary\n        compensation: {swing_Nm: 0.1, swing_phase_rad: 1}\n"));
  EXPECT_EQ(arm.program->plan().gravity_axes[0].swing, 0.1);
  EXPECT_EQ(arm.program->plan().gravity_axes[0].phase, 1);
}

TEST(CompileObserver, ModelModeFeedsTheDifferenceBack) {
  const Compiled compiled = compiled_of(
      with_observer("mode: model, nominal_mass_kg: 0.03, nominal_damping_Ns_m: 2, cutoff_Hz: 20, "
                    "extra_delay_ticks: 3, blend_s: 0.25"));
  const auto observers = compiled.program->plan().axis_observers;
  ASSERT_EQ(observers.size(), 1U);
  const double share = 1 - std::exp(-2 * std::numbers::pi * 20e-3);
  EXPECT_NEAR(observers[0].inertia, (0.03 - 0.05) / 1e-6, 1e-6);
  EXPECT_NEAR(observers[0].damping, (2 - 1.37) / 1e-3, 1e-9);
  EXPECT_EQ(observers[0].command_share, 0);
  EXPECT_NEAR(observers[0].share, share, 1e-15);
  EXPECT_NEAR(observers[0].second_share, share, 1e-15);
  EXPECT_EQ(observers[0].max_output, 8) << "the actuator's";
  EXPECT_NEAR(observers[0].blend_per_tick, 0.004, 1e-12);
  EXPECT_EQ(observers[0].extra_delay, 3);
}

TEST(CompileObserver, ClassicIsRefusedUntilSomebodyKnowsWhatItDoes) {
  expect_error(with_observer("mode: classic"), "13:26", "devices[0].axes[0].observer.mode",
               {"0 mm instead of 5 mm", "mode: model", "i_know_it_cancels_the_hand: true"});
  const Compiled compiled =
      compiled_of(with_observer("mode: classic, i_know_it_cancels_the_hand: true, order: 1"));
  const control::ObserverPlan& observer = compiled.program->plan().axis_observers[0];
  EXPECT_NEAR(observer.inertia, 0.05 / 1e-6, 1e-6) << "nominal by default: the model's";
  EXPECT_EQ(observer.command_share, 1);
  EXPECT_EQ(observer.hand_share, 0);
  EXPECT_EQ(observer.second_share, 1);
}

TEST(CompileObserver, SensorModeNeedsASensor) {
  const std::string text = with_observer("mode: sensor");
  expect_error(text, "13:26", "devices[0].axes[0].observer.mode", {"force_sensor", "model"});
  const Compiled compiled = compiled_of(
      replaced(text, "latency_s: 0", "force_sensor: {directions: [x]}\n    latency_s: 0"));
  EXPECT_EQ(compiled.program->plan().axis_observers[0].hand_share, 1);
  ASSERT_EQ(compiled.program->plan().force_sensors.size(), 1U);
  EXPECT_EQ(compiled.program->plan().force_sensors[0].channels, 1);
  EXPECT_TRUE(compiled.simulated[0].force_sensor) << "a silent one would make the hand friction";
}

TEST(CompileObserver, NeedsAModelThatDiffersAndACutoffBelowHalfTheRate) {
  expect_error(with_observer("mode: model"), "13:26", "devices[0].axes[0].observer.mode",
               {"does nothing", "nominal_mass_kg"});
  expect_error(with_observer("mode: model, nominal_mass_kg: 0.03, cutoff_Hz: 500"), "13:67",
               "devices[0].axes[0].observer.cutoff_Hz", {"500 Hz"});
  const std::string text = with_observer("mode: model, nominal_mass_kg: 0.03");
  const auto model = text.find("        model:");
  expect_error(replaced(std::string(text).erase(model, text.find('\n', model) + 1 - model),
                        "latency_s: 0", "sim: {axes: [{mass_kg: 1}]}\n    latency_s: 0"),
               "13:26", "devices[0].axes[0].observer.mode", {"has none"});
}

TEST(CompileObserver, ReductionBeyondTheModelsUncertaintyIsRefused) {
  const std::string text = replaced(with_observer("mode: model, nominal_mass_kg: 0.01"),
                                    "mass_kg: 0.05,", "mass_kg: 0.05, mass_uncertainty: 0.2,");
  expect_error(text, "13:50", "devices[0].axes[0].observer.nominal_mass_kg",
               {"uncertainty", "0.01", "lightest"});
  EXPECT_TRUE(errors_of(replaced(text, "nominal_mass_kg: 0.01", "nominal_mass_kg: 0.011")).empty());
  // 1.37 * 0.2 = 0.274 N s/m may be missing already.
  expect_error(with_observer("mode: model, nominal_damping_Ns_m: 0.27"), "13:55",
               "devices[0].axes[0].observer.nominal_damping_Ns_m", {"beyond 0", "0.004"});
  EXPECT_TRUE(errors_of(with_observer("mode: model, nominal_damping_Ns_m: 0.28")).empty());
}

std::string with_contact(const std::string& contact) {
  return replaced(kFiveBar, "    latency_s: 0\n",
                  "    latency_s: 0\n    contact: " + contact + "\n");
}
const std::string kLight =
    "{model: {mass_kg: 0.02, damping_Ns_m: 0.5}, observer: {mode: model, nominal_mass_kg: 0.01}}";

TEST(CompileObserver, ContactObserverStandsAtItsCoordinate) {
  const Compiled compiled = compiled_of(with_contact("{y: " + kLight + "}"));
  const auto observers = compiled.program->plan().contact_observers;
  ASSERT_EQ(observers.size(), 1U);
  EXPECT_EQ(observers[0].source, 1);
  EXPECT_NEAR(observers[0].inertia, (0.01 - 0.02) / 1e-6, 1e-6);
  EXPECT_EQ(observers[0].max_output, 1.5) << "guard.max_force_N";
  EXPECT_TRUE(compiled.program->plan().axis_observers.empty());
}

TEST(CompileObserver, ContactMovesAlongItsDirectionAndInOneSpaceOnly) {
  expect_error(with_contact("{z: " + kLight + "}"), "7:18", "devices[0].contact.z",
               {"'arm'", "does not move"});
  expect_error(replaced(with_contact("{x: " + kLight + "}"), "        kind: rotary\n",
                        "        kind: rotary\n        observer: {mode: model, "
                        "nominal_inertia_kgm2: 1.0e-4}\n"),
               "7:14", "devices[0].contact", {"not at both"});
}

TEST(Assumption, ObserversAndLinkagesAreNoObstacles) {
  EXPECT_TRUE(compiled_of(kSmall).assumed[0].obstacles.empty());
  EXPECT_TRUE(compiled_of(kFiveBar).assumed[0].obstacles.empty());
  EXPECT_TRUE(compiled_of(with_observer("mode: model, nominal_mass_kg: 0.03"))
                  .assumed[0]
                  .obstacles.empty());
}

TEST(Assumption, EstimatorMattersOnlyWhereVelocityMakesForce) {
  const std::string text = with_compensated("velocity: {estimator: low_pass}");
  EXPECT_TRUE(compiled_of(text).assumed[0].obstacles.empty());
  const auto damped =
      compiled_of(replaced(text, "stiffness_N_m: 1000", "stiffness_N_m: 1000, damping_Ns_m: 0.1"))
          .assumed[0]
          .obstacles;
  ASSERT_EQ(damped.size(), 1U);
  EXPECT_NE(damped[0].find("low_pass"), std::string::npos);
  const auto compensated =
      compiled_of(with_compensated("velocity: {estimator: low_pass}\n        "
                                   "compensation: {viscous_share: 0.1}"));
  EXPECT_EQ(compensated.assumed[0].obstacles.size(), 1U);
}

}  // namespace
}  // namespace hapticd::config::test
