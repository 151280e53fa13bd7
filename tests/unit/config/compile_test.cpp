// What needs more than one key, and what the plan gets.
#include <cmath>

#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

const std::string kAxis = R"(      - name: NAME
        encoder: {counts_per_m: 1000, bits: 32}
        actuator: {max_force_N: 8}
)";

std::string axis(const std::string& name) {
  return replaced(kAxis, "NAME", name);
}
/// kSmall with two more axes, on y and z.
std::string three_axes() {
  return replaced(replaced(kSmall, "scene:\n", axis("b") + axis("c") + "scene:\n"),
                  "latency_s: 0\n",
                  "latency_s: 0\n    sim: {axes: [{}, {mass_kg: 1}, {mass_kg: 1}]}\n");
}
std::string with_directions(const std::string& directions) {
  return replaced(three_axes(), "[x]", directions);
}

TEST(Compile, PlanHasTheAxisInSi) {
  const Compiled compiled =
      compiled_of(replaced(kSmall, "bits: 32", "bits: 24, offset_m: 0.1, reversed: true"));
  const control::AxisPlan& axis_plan = compiled.program->plan().axes[0];
  EXPECT_EQ(axis_plan.unit_per_raw, -1.0 / 163840);
  EXPECT_EQ(axis_plan.offset, 0.1);
  EXPECT_EQ(axis_plan.modulus_raw, 16777216);
  EXPECT_EQ(axis_plan.max_effort, 8);
  EXPECT_EQ(axis_plan.max_velocity, 1.5);
  EXPECT_DOUBLE_EQ(axis_plan.max_step, 10 * 1.5 * 0.001);
  EXPECT_EQ(compiled.program->plan().period_s, 0.001);
}

TEST(Compile, EncoderWithoutBitsNeverWraps) {
  const Compiled compiled = compiled_of(replaced(kSmall, "bits: 32", "bits: 0"));
  EXPECT_EQ(compiled.program->plan().axes[0].modulus_raw, 0);
  EXPECT_EQ(compiled.simulated[0].axes[0].encoder_bits, 0);
}

TEST(Compile, GuardDefaultsFollowFromTheDevice) {
  const Compiled compiled = compiled_of(replaced(kSmall, "guard: {max_force_N: 6}\n", ""));
  const control::DevicePlan& device = compiled.program->plan().devices[0];
  EXPECT_EQ(device.max_force, 8) << "the actuator's";
  EXPECT_DOUBLE_EQ(device.max_slew, 8 / 0.005 * 0.001);
  EXPECT_DOUBLE_EQ(device.ramp_per_tick, 0.001 / 0.5);
  EXPECT_EQ(device.max_stale_ticks, 3U);
}

TEST(Compile, DevicesGuardOverridesTheGlobalOneKeyByKey) {
  std::string text = replaced(kSmall, "guard: {max_force_N: 6}",
                              "guard: {max_force_N: 6, max_velocity_m_s: 1, max_slew_N_s: 500, "
                              "ramp_s: 1, max_stale_ticks: 9}");
  text = replaced(text, "    axes:", "    guard: {max_force_N: 2, ramp_s: 0}\n    axes:");
  const Compiled compiled = compiled_of(text);
  const control::DevicePlan& device = compiled.program->plan().devices[0];
  EXPECT_EQ(device.max_force, 2);
  EXPECT_EQ(device.ramp_per_tick, 1);
  EXPECT_EQ(device.max_slew, 0.5);
  EXPECT_EQ(device.max_stale_ticks, 9U);
  EXPECT_EQ(compiled.program->plan().axes[0].max_velocity, 1);
  EXPECT_EQ(compiled.simulated[0].ramp_s, 0);
}

TEST(Compile, StuckWatchCountsTicksAtAFifthOfTheForceLimit) {
  EXPECT_TRUE(compiled_of(kSmall).program->plan().stuck_watches.empty());
  const Compiled compiled = compiled_of(replaced(kSmall, "bits: 32", "bits: 32, stuck_s: 0.25"));
  const auto watches = compiled.program->plan().stuck_watches;
  ASSERT_EQ(watches.size(), 1U);
  EXPECT_EQ(watches[0].axis, 0);
  EXPECT_EQ(watches[0].ticks, 250U);
  EXPECT_DOUBLE_EQ(watches[0].min_effort, 1.2);
}

TEST(Compile, AssumptionIsTheLeastDampingOfTheModel) {
  const Compiled compiled = compiled_of(replaced(kSmall, "latency_s: 0", "latency_s: 0.0002"));
  ASSERT_EQ(compiled.assumed.size(), 1U);
  EXPECT_EQ(compiled.assumed[0].latency_s, 0.0002);
  ASSERT_EQ(compiled.assumed[0].min_damping.size(), 1U);
  EXPECT_DOUBLE_EQ(compiled.assumed[0].min_damping[0], 1.37 * 0.8);
}

TEST(Compile, OneAxisWithoutModelLeavesNoAssumption) {
  EXPECT_TRUE(compiled_of(with_directions("[x, y, z]")).assumed[0].min_damping.empty());
}

TEST(Compile, TruthOfTheSimulationDoesNotReachPlanOrAssumption) {
  const Compiled model = compiled_of(kSmall);
  const Compiled truth = compiled_of(
      replaced(kSmall, "latency_s: 0",
               "sim: {axes: [{mass_kg: 9, damping_Ns_m: 99, delay_s: 0.01}]}\n    latency_s: 0"));
  EXPECT_EQ(truth.assumed[0].min_damping, model.assumed[0].min_damping);
  EXPECT_EQ(truth.assumed[0].latency_s, model.assumed[0].latency_s);
  EXPECT_EQ(truth.simulated[0].axes[0].mass_kg, 9);
  EXPECT_EQ(model.simulated[0].axes[0].mass_kg, 0.05) << "left out, it equals the model";
  EXPECT_EQ(model.simulated[0].axes[0].damping_Ns_m, 1.37);
}

TEST(Compile, SimulatedEncoderIsThatOfTheAxis) {
  const std::string text = replaced(
      replaced(kSmall, "bits: 32", "bits: 20, reversed: true, offset_m: 0.5"), "latency_s: 0",
      "sim: {axes: [{position_m: 0.6}], hand: {script: [{at_s: 0, position_m: 0.7}]}}\n    "
      "latency_s: 0");
  const Compiled compiled = compiled_of(text);
  const sim::AxisOptions& axis_options = compiled.simulated[0].axes[0];
  EXPECT_EQ(axis_options.counts_per_m, -163840);
  EXPECT_EQ(axis_options.encoder_bits, 20);
  EXPECT_EQ(axis_options.max_effort_N, 8);
  EXPECT_EQ(axis_options.position_m, 0.6);
  EXPECT_EQ(axis_options.zero_m, 0.5);
  EXPECT_EQ(compiled.simulated[0].hand.script[0].position_m, 0.7);
  const control::AxisPlan& plan = compiled.program->plan().axes[0];
  const double raw = (axis_options.position_m - axis_options.zero_m) * axis_options.counts_per_m;
  EXPECT_DOUBLE_EQ(raw * plan.unit_per_raw + plan.offset, 0.6)
      << "the loop gets the axis' own position back";
}

TEST(Compile, FailureKindsOfConfigAndSimulatorAgree) {
  const auto same = [](SimFailureKind a, sim::FailureKind b) {
    return static_cast<int>(a) == static_cast<int>(b);
  };
  EXPECT_TRUE(same(SimFailureKind::nan, sim::FailureKind::nan));
  EXPECT_TRUE(same(SimFailureKind::stuck, sim::FailureKind::stuck));
  EXPECT_TRUE(same(SimFailureKind::jump, sim::FailureKind::jump));
  EXPECT_TRUE(same(SimFailureKind::missing, sim::FailureKind::missing));
  EXPECT_TRUE(same(SimFailureKind::disarm, sim::FailureKind::disarm));
  EXPECT_TRUE(same(SimFailureKind::fault, sim::FailureKind::fault));
  EXPECT_TRUE(same(SimFailureKind::slow, sim::FailureKind::slow));
}

TEST(Compile, FailureNamesAnAxisOfItsDevice) {
  const std::string text =
      replaced(kSmall, "latency_s: 0",
               "sim: {failures: [{kind: stuck, axis: y, at_s: 1, for_s: 2}]}\n    latency_s: 0");
  expect_error(text, "7:42", "devices[0].sim.failures[0].axis", {"no axis 'y'"});
  const Compiled compiled = compiled_of(replaced(text, "axis: y, ", ""));
  ASSERT_EQ(compiled.simulated[0].failures.size(), 1U);
  EXPECT_EQ(compiled.simulated[0].failures[0].kind, sim::FailureKind::stuck);
  EXPECT_EQ(compiled.simulated[0].failures[0].for_s, 2);
}

TEST(Compile, CoordinatesAreWorldDirectionsInOrderWhateverTheOrderOfAxes) {
  const std::string text = replaced(with_directions("[z, x, y]"), "[1, 0, 0]", "[0, 3, 4]");
  const Compiled compiled = compiled_of(text);
  const control::Plan& plan = compiled.program->plan();
  ASSERT_EQ(plan.planes.size(), 1U);
  EXPECT_EQ(plan.planes[0].coordinates, 3);
  EXPECT_DOUBLE_EQ(plan.planes[0].normal[0], 0.0) << "x";
  EXPECT_DOUBLE_EQ(plan.planes[0].normal[1], 0.6) << "y";
  EXPECT_DOUBLE_EQ(plan.planes[0].normal[2], 0.8) << "z";
  EXPECT_EQ(compiled.program->spec().coordinate_names,
            (std::vector<std::string>{"left.x", "left.y", "left.z"}));
  EXPECT_EQ(compiled.program->spec().axis_names,
            (std::vector<std::string>{"left.x", "left.b", "left.c"}));
  ASSERT_EQ(plan.cartesian_axes.size(), 3U);
  const std::array<int, 3> axis_of{1, 2, 0};
  for (std::size_t i = 0; i < axis_of.size(); ++i) {
    EXPECT_EQ(plan.cartesian_axes[i].coordinate, i);
    EXPECT_EQ(plan.cartesian_axes[i].axis, axis_of[i]);
    EXPECT_EQ(plan.cartesian_axes[i].scale, 1);
  }
}

TEST(Compile, NormalIsProjectedNotStretchedOnFewerDirections) {
  const Compiled compiled = compiled_of(replaced(kSmall, "[1, 0, 0]", "[3, 4, 0]"));
  EXPECT_DOUBLE_EQ(compiled.program->plan().planes[0].normal[0], 0.6);
}

TEST(Compile, PlaneThatADeviceCannotFeelIsRefused) {
  expect_error(replaced(kSmall, "[1, 0, 0]", "[0, 1, 0]"), "14:33", "scene[0].plane.normal",
               {"'left'", "cannot feel"});
  expect_error(replaced(kSmall, "[1, 0, 0]", "[0, 0, 0]"), "14:33", "scene[0].plane.normal",
               {"length 0"});
}

std::string two_devices() {
  const auto begin = kSmall.find("  - name: left");
  const auto end = kSmall.find("scene:");
  return replaced(kSmall, "scene:\n",
                  replaced(kSmall.substr(begin, end - begin), "left", "right") + "scene:\n");
}

TEST(Compile, PlaneWithoutDevicesIsFeltByAll) {
  const Compiled compiled = compiled_of(two_devices());
  const auto planes = compiled.program->plan().planes;
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_EQ(planes[0].first_coordinate, 0);
  EXPECT_EQ(planes[1].first_coordinate, 1);
  EXPECT_EQ(compiled.program->plan().devices[1].first_axis, 1);
  EXPECT_EQ(compiled_of(replaced(two_devices(), "name: wall", "name: wall, devices: [right]"))
                .program->plan()
                .planes[0]
                .first_coordinate,
            1);
}

TEST(Compile, PlaneNamesDevicesThatExistOnce) {
  expect_error(replaced(kSmall, "name: wall", "name: wall, devices: [lefd]"), "14:35",
               "scene[0].plane.devices[0]", {"no device 'lefd'", "did you mean 'left'"});
  expect_error(replaced(kSmall, "name: wall", "name: wall, devices: [left, left]"), "14:41",
               "scene[0].plane.devices[1]", {"named twice"});
}

TEST(Compile, NamesAreUnique) {
  expect_error(replaced(two_devices(), "name: right", "name: left"), "13:11", "devices[1].name",
               {"devices[0].name"});
  expect_error(replaced(with_directions("[x, y, z]"), "name: c", "name: b"), "17:15",
               "devices[0].axes[2].name", {"devices[0].axes[1].name"});
  expect_error(replaced(kSmall, "guard:",
                        "  - plane: {name: wall, normal: [1, 0, 0], stiffness_N_m: 1}\nguard:"),
               "15:19", "scene[1].plane.name", {"scene[0].plane.name"});
}

TEST(Compile, DirectionsAreUniqueAndAsManyAsAxes) {
  expect_error(with_directions("[x, y]"), "6:42", "devices[0].kinematics.cartesian.directions",
               {"each of the 3 axes"});
  expect_error(with_directions("[x, y, x]"), "6:49",
               "devices[0].kinematics.cartesian.directions[2]", {"'x'", "taken"});
}

TEST(Compile, ForceLimitIsWithinTheWeakestActuator) {
  expect_error(replaced(kSmall, "max_force_N: 6", "max_force_N: 8.5"), "15:22", "guard.max_force_N",
               {"at most 8 N", "'left'", "devices[0].guard.max_force_N"});
  expect_error(replaced(kSmall, "    axes:", "    guard: {max_force_N: 9}\n    axes:"), "8:26",
               "devices[0].guard.max_force_N", {"at most 8 N", "found 9 N"});
}

TEST(Compile, EncoderMustTellAWrapFromMotion) {
  expect_error(replaced(kSmall, "bits: 32", "bits: 12"), "10:47", "devices[0].axes[0].encoder.bits",
               {"at least 13 bits"});
  EXPECT_TRUE(errors_of(replaced(kSmall, "bits: 32", "bits: 13")).empty());
}

TEST(Compile, SimulatedAxisNeedsAMass) {
  expect_error(replaced(with_directions("[x, y, z]"), "{mass_kg: 1}", "{}"), "8:22",
               "devices[0].sim.axes[1].mass_kg", {"no mass", "model"});
}

TEST(Compile, SimulatedAxesAreAsManyAsAxes) {
  expect_error(replaced(kSmall, "latency_s: 0", "sim: {axes: [{}, {}]}\n    latency_s: 0"), "7:17",
               "devices[0].sim.axes", {"each of the 1 axes", "found 2"});
}

TEST(Compile, ScriptTimesIncrease) {
  const std::string text = replaced(
      kSmall, "latency_s: 0", "sim: {hand: {script: [{at_s: 1}, {at_s: 1}]}}\n    latency_s: 0");
  expect_error(text, "7:45", "devices[0].sim.hand.script[1].at_s", {"later", "1 s"});
}

TEST(Compile, SimulatedStartIsWithinTheEncodersRange) {
  expect_error(replaced(replaced(kSmall, "bits: 32", "bits: 16"), "latency_s: 0",
                        "sim: {axes: [{position_m: 0.3}]}\n    latency_s: 0"),
               "7:31", "devices[0].sim.axes[0].position_m", {"16 bits"});
}

TEST(Compile, ConverterStepIsWithinTheActuator) {
  expect_error(replaced(kSmall, "latency_s: 0", "sim: {axes: [{dac_step_N: 9}]}\n    latency_s: 0"),
               "7:31", "devices[0].sim.axes[0].dac_step_N", {"8 N", "9 N"});
}

TEST(Compile, TooManyAxesAreSaidOncePerLimitAndNothingElse) {
  Document document = *read_text(kSmall, "test.yaml");
  document.config.devices[0].axes.assign(10'000, document.config.devices[0].axes[0]);
  const auto compiled = compile(std::move(document));
  ASSERT_FALSE(compiled);
  ASSERT_EQ(compiled.error().size(), 2U) << listed(compiled.error());
  EXPECT_NE(compiled.error()[0].message.find("at most 6 axes of a device, found 10000"),
            std::string::npos);
  EXPECT_NE(compiled.error()[1].message.find("at most 48 axes over all devices, found 10000"),
            std::string::npos);
  EXPECT_EQ(compiled.error()[0].line, 9);
}

TEST(Compile, SocketPathFitsTheSystemsLimit) {
  const std::string fits = "/" + std::string(106, 's');
  EXPECT_TRUE(errors_of(kSmall + "control: {socket: " + fits + "}\n").empty());
  expect_error(kSmall + "control: {socket: " + fits + "s}\n", "16:19", "control.socket",
               {"107 bytes", "108"});
  expect_error(kSmall + "control: {socket: ''}\n", "16:19", "control.socket", {"a path"});
}

TEST(Compile, RelativePathsAreRelativeToTheFile) {
  const std::string text =
      kSmall + "control: {socket: run/s}\ntelemetry: {flight_dir: ../flights, record: r.hap}\n";
  const auto compiled = read_text(text, "/etc/hapticd/a.yaml").and_then(compile);
  ASSERT_TRUE(compiled);
  EXPECT_EQ(compiled->document.config.control.socket, "/etc/hapticd/run/s");
  EXPECT_EQ(compiled->document.config.telemetry.flight_dir, "/etc/flights");
  EXPECT_EQ(compiled->document.config.telemetry.record, "/etc/hapticd/r.hap");
  const auto here = read_text(text, "a.yaml").and_then(compile);
  ASSERT_TRUE(here);
  EXPECT_EQ(here->document.config.telemetry.record, "r.hap");
}

TEST(Compile, EmptyFlightDirStaysEmpty) {
  const auto compiled =
      read_text(kSmall + "telemetry: {flight_dir: ''}\n", "/etc/a.yaml").and_then(compile);
  ASSERT_TRUE(compiled);
  EXPECT_EQ(compiled->document.config.telemetry.flight_dir, "");
}

TEST(Compile, AllErrorsComeAtOnce) {
  std::string text = replaced(kSmall, "bits: 32", "bits: 5");
  text = replaced(text, "[x]", "[x, y]");
  text = replaced(text, "max_force_N: 6", "max_force_N: 60");
  EXPECT_EQ(errors_of(text).size(), 3U) << listed(errors_of(text));
}

TEST(Compile, ConfigMadeInCodeCompilesWithoutPlaces) {
  Document document;
  document.config = config_of(kSmall);
  EXPECT_TRUE(compile(document));
  document.config.devices[0].axes[0].encoder.bits = 3;
  const auto refused = compile(std::move(document));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error()[0].line, 0);
}

}  // namespace
}  // namespace hapticd::config::test
