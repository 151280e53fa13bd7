// Axes: units of both kinds, velocity, homing, travel, temperature, latency.
#include <cmath>
#include <numbers>

#include "tests/unit/config/five_bar_text.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

/// kSmall (one linear axis, 8 N, 163840 counts/m) with more keys of the axis.
std::string with_axis(const std::string& keys) {
  return replaced(kSmall, "scene:\n", "        " + keys + "\nscene:\n");
}
control::AxisPlan axis_of(const std::string& text) {
  const Compiled compiled = compiled_of(text);
  return compiled.program->plan().axes[0];
}

TEST(CompileAxis, RotaryAxisIsInRadians) {
  const Compiled compiled =
      compiled_of(replaced(kFiveBar, "bits: 24}", "bits: 24, offset_rad: 0.5, reversed: true}"));
  const control::AxisPlan& axis = compiled.program->plan().axes[0];
  EXPECT_DOUBLE_EQ(axis.unit_per_raw, -2 * std::numbers::pi / 32768);
  EXPECT_EQ(axis.offset, 0.5);
  EXPECT_EQ(axis.max_effort, 0.4);
  EXPECT_EQ(axis.max_velocity, 10) << "the default of rotary axes";
  EXPECT_EQ(axis.min_damping, 8e-4);
  EXPECT_EQ(compiled.program->spec().rotary, (std::vector<bool>{true, true}));
  const sim::AxisOptions& simulated = compiled.simulated[0].axes[0];
  EXPECT_DOUBLE_EQ(simulated.counts_per_m, -32768 / (2 * std::numbers::pi));
  EXPECT_EQ(simulated.zero_m, 0.5);
  EXPECT_EQ(simulated.mass_kg, 2e-4);
}

TEST(CompileAxis, KeyOfTheOtherKindIsRefusedWithTheRightOne) {
  expect_error(replaced(kFiveBar, "max_torque_Nm: 0.4", "max_force_N: 0.4"), "11:33",
               "devices[0].axes[0].actuator.max_force_N", {"rotary", "max_torque_Nm"});
  expect_error(replaced(kSmall, "counts_per_m", "counts_per_rev"), "10:35",
               "devices[0].axes[0].encoder.counts_per_rev", {"linear", "counts_per_m"});
  expect_error(with_axis("travel: {min_rad: 0, min_m: 0, max_m: 1, margin_m: 1}"), "13:27",
               "devices[0].axes[0].travel.min_rad", {"linear", "min_m"});
  expect_error(
      replaced(kSmall, "latency_s: 0", "sim: {axes: [{stops_rad: [0, 1]}]}\n    latency_s: 0"),
      "7:30", "devices[0].sim.axes[0].stops_rad", {"linear", "stops_m"});
  expect_error(replaced(kSmall, "latency_s: 0",
                        "sim: {failures: [{kind: jump, at_s: 1, size_rad: 1}]}\n    latency_s: 0"),
               "7:54", "devices[0].sim.failures[0].size_rad", {"linear", "size_m"});
}

TEST(CompileAxis, MissingKeyIsSaidOnceInTheUnitOfTheKind) {
  expect_error(replaced(kFiveBar, "counts_per_rev: 32768, bits: 24", "bits: 24"), "10:18",
               "devices[0].axes[0].encoder.counts_per_rev", {"missing", "rotary"});
  expect_error(replaced(kFiveBar, "inertia_kgm2: 2.0e-4, ", ""), "12:16",
               "devices[0].axes[0].model.inertia_kgm2", {"missing", "rotary"});
  expect_error(replaced(kSmall, "{max_force_N: 8}", "{thermal_time_s: 8}"), "11:19",
               "devices[0].axes[0].actuator.max_force_N", {"missing", "linear"});
}

TEST(CompileAxis, LatencyIsWholeTicksAndAShare) {
  const auto of = [](const std::string& latency) {
    return axis_of(replaced(kSmall, "latency_s: 0", "latency_s: " + latency));
  };
  EXPECT_EQ(of("0").delay_ticks, 0);
  EXPECT_EQ(of("0").delay_share, 0);
  EXPECT_EQ(of("0.00025").delay_ticks, 0);
  EXPECT_DOUBLE_EQ(of("0.00025").delay_share, 0.25);
  EXPECT_EQ(of("0.003").delay_ticks, 3);
  EXPECT_NEAR(of("0.003").delay_share, 0, 1e-9);
  EXPECT_EQ(of("0.014").delay_ticks, 14);
}

TEST(CompileAxis, LatencyBeyondTheDelayLineIsRefused) {
  expect_error(replaced(kSmall, "latency_s: 0", "latency_s: 0.0141"), "7:16",
               "devices[0].latency_s", {"14 ticks", "0.0141 s"});
}

TEST(CompileAxis, EveryEstimatorHasItsArray) {
  EXPECT_TRUE(compiled_of(kSmall).program->plan().low_passes.empty());
  const auto plan_of = [](const std::string& keys) {
    return compiled_of(with_axis("velocity: {estimator: " + keys + "}")).program->spec();
  };
  const auto low_pass = plan_of("low_pass, cutoff_Hz: 50").low_passes;
  ASSERT_EQ(low_pass.size(), 1U);
  EXPECT_NEAR(low_pass[0].share, 1 - std::exp(-2 * std::numbers::pi * 50e-3), 1e-15);
  const auto line = plan_of("least_squares, window: 3, degree: 1").least_squares;
  ASSERT_EQ(line.size(), 1U);
  EXPECT_NEAR(line[0].weights[2], -0.5 / 1e-3, 1e-9) << "(q0 - q2) / 2T is the slope of a line";
  const auto foaw = plan_of("foaw, window: 16, noise_counts: 2").foaws;
  ASSERT_EQ(foaw.size(), 1U);
  EXPECT_EQ(foaw[0].window, 16);
  EXPECT_NEAR(foaw[0].noise, 2.0 / 163840, 1e-8 / 163840);
  const auto tracking = plan_of("alpha_beta_gamma, bandwidth_rad_s: 100").alpha_beta_gammas;
  ASSERT_EQ(tracking.size(), 1U);
  EXPECT_NEAR(tracking[0].alpha, 1 - std::exp(-0.3), 1e-15);
}

TEST(CompileAxis, LeastSquaresNeedsMoreSamplesThanItsDegree) {
  expect_error(with_axis("velocity: {estimator: least_squares, window: 3, degree: 3}"), "13:65",
               "devices[0].axes[0].velocity.degree", {"less than window", "3"});
  EXPECT_TRUE(errors_of(with_axis("velocity: {estimator: foaw, window: 2}")).empty())
      << "other estimators have no degree";
}

TEST(CompileAxis, CutoffIsBelowHalfTheRate) {
  expect_error(with_axis("velocity: {estimator: low_pass, cutoff_Hz: 500}"), "13:52",
               "devices[0].axes[0].velocity.cutoff_Hz", {"500 Hz"});
}

TEST(CompileAxis, HomingByHardStopIsBoundedInForceSpeedAndTime) {
  const Compiled compiled =
      compiled_of(with_axis("homing: {by: hard_stop, position_m: -0.05, search_force_N: -2, "
                            "search_velocity_m_s: 0.02, still_s: 0.1, timeout_s: 3}"));
  const auto homings = compiled.program->plan().homings;
  ASSERT_EQ(homings.size(), 1U);
  EXPECT_EQ(homings[0].by, control::HomingBy::hard_stop);
  EXPECT_EQ(homings[0].position, -0.05);
  EXPECT_EQ(homings[0].effort, -2);
  EXPECT_DOUBLE_EQ(homings[0].effort_per_tick, 2 * 0.001 / 0.5);
  EXPECT_EQ(homings[0].velocity, 0.02);
  EXPECT_EQ(homings[0].still_ticks, 100U);
  EXPECT_EQ(homings[0].max_ticks, 3000U);
}

TEST(CompileAxis, HomingByHandOrDeviceNeedsNoForce) {
  const Compiled index = compiled_of(with_axis("homing: {by: index, position_m: 0.1}"));
  ASSERT_EQ(index.program->plan().homings.size(), 1U);
  EXPECT_EQ(index.program->plan().homings[0].effort, 0);
  EXPECT_EQ(index.program->plan().homings[0].by, control::HomingBy::index);
  const Compiled device = compiled_of(with_axis("homing: {by: device}"));
  EXPECT_EQ(device.program->plan().homings[0].by, control::HomingBy::device);
  EXPECT_TRUE(compiled_of(kSmall).program->plan().homings.empty());
}

TEST(CompileAxis, SearchIsGentleAndAHardStopNeedsOne) {
  expect_error(with_axis("homing: {by: hard_stop, search_force_N: 2.1}"), "13:49",
               "devices[0].axes[0].homing.search_force_N", {"a quarter", "2 N", "2.1"});
  expect_error(with_axis("homing: {by: hard_stop}"), "13:17",
               "devices[0].axes[0].homing.search_force_N", {"missing", "sign"});
}

TEST(CompileAxis, TravelIsARangeWithSprings) {
  const Compiled compiled = compiled_of(
      with_axis("travel: {min_m: -0.1, max_m: 0.2, stiffness_N_m: 300, margin_m: 0.01}"));
  const auto travels = compiled.program->plan().travels;
  ASSERT_EQ(travels.size(), 1U);
  EXPECT_EQ(travels[0].min, -0.1);
  EXPECT_EQ(travels[0].max, 0.2);
  EXPECT_EQ(travels[0].stiffness, 300);
  EXPECT_EQ(travels[0].margin, 0.01);
  EXPECT_EQ(travels[0].max_effort, 8) << "the actuator's";
  expect_error(with_axis("travel: {min_m: 0.2, max_m: 0.2, margin_m: 0.01}"), "13:37",
               "devices[0].axes[0].travel.max_m", {"more than the lower end", "0.2"});
  expect_error(with_axis("travel: {min_m: 0, max_m: 1}"), "13:17",
               "devices[0].axes[0].travel.margin_m", {"missing"});
}

TEST(CompileAxis, ContinuousForceLimitsHeat) {
  const Compiled compiled = compiled_of(replaced(
      kSmall, "{max_force_N: 8}", "{max_force_N: 8, continuous_force_N: 3, thermal_time_s: 20}"));
  const auto thermals = compiled.program->plan().thermals;
  ASSERT_EQ(thermals.size(), 1U);
  EXPECT_EQ(thermals[0].continuous, 3);
  EXPECT_NEAR(thermals[0].share, 1 - std::exp(-0.001 / 20), 1e-15);
  expect_error(replaced(kSmall, "{max_force_N: 8}", "{max_force_N: 8, continuous_force_N: 9}"),
               "11:56", "devices[0].axes[0].actuator.continuous_force_N", {"8 N", "found 9"});
}

TEST(CompileAxis, StuckWatchOfARotaryAxisIsAFifthOfItsTorque) {
  const Compiled compiled = compiled_of(replaced(kFiveBar, "bits: 24", "bits: 24, stuck_s: 1"));
  ASSERT_EQ(compiled.program->plan().stuck_watches.size(), 1U);
  EXPECT_DOUBLE_EQ(compiled.program->plan().stuck_watches[0].min_effort, 0.2 * 0.4);
}

TEST(CompileAxis, SimulationHasStopsIndexAndHoming) {
  const Compiled compiled = compiled_of(replaced(
      kSmall, "latency_s: 0",
      "sim: {axes: [{position_m: 0.01, relative: true, index_m: 0.02, stops_m: [-0.1, 0.1], "
      "homed_at_s: 2}], digital: [{at_s: 1, bits: 5}]}\n    latency_s: 0"));
  const sim::AxisOptions& axis = compiled.simulated[0].axes[0];
  EXPECT_TRUE(axis.relative);
  EXPECT_EQ(axis.index_m, 0.02);
  EXPECT_EQ(axis.stops->min_m, -0.1);
  EXPECT_EQ(axis.stops->max_m, 0.1);
  EXPECT_EQ(axis.homed_at_s, 2);
  ASSERT_EQ(compiled.simulated[0].digital.size(), 1U);
  EXPECT_EQ(compiled.simulated[0].digital[0].bits, 5U);
}

TEST(CompileAxis, SimulatedStopsAndInputsAreInOrder) {
  const auto with_sim = [](const std::string& sim) {
    return replaced(kSmall, "latency_s: 0", "sim: {" + sim + "}\n    latency_s: 0");
  };
  expect_error(with_sim("axes: [{stops_m: [0.1, -0.1]}]"), "7:28", "devices[0].sim.axes[0].stops_m",
               {"lower end", "0.1, -0.1"});
  expect_error(with_sim("axes: [{position_m: 1, stops_m: [-0.1, 0.1]}]"), "7:31",
               "devices[0].sim.axes[0].position_m", {"between the stops"});
  expect_error(with_sim("digital: [{at_s: 2, bits: 1}, {at_s: 1, bits: 0}]"), "7:48",
               "devices[0].sim.digital[1].at_s", {"later", "2 s"});
}

}  // namespace
}  // namespace hapticd::config::test
