// Where devices stand and how their axes move the contact.
#include <cmath>

#include "tests/unit/config/five_bar_text.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

const std::string kMoreAxes = R"(      - name: b
        encoder: {counts_per_m: 1000, bits: 32}
        actuator: {max_force_N: 8}
        model: {mass_kg: 0.05, damping_Ns_m: 1.37}
      - name: c
        encoder: {counts_per_m: 1000, bits: 32}
        actuator: {max_force_N: 8}
        model: {mass_kg: 0.05, damping_Ns_m: 1.37}
)";

/// Three linear axes on x, y, z with more keys of the device.
std::string three_axes(const std::string& keys) {
  return replaced(
      replaced(replaced(kSmall, "scene:\n", kMoreAxes + "scene:\n"), "[x]", "[x, y, z]"),
      "    latency_s: 0\n", "    latency_s: 0\n" + keys);
}
std::string one_axis(const std::string& keys) {
  return replaced(kSmall, "    latency_s: 0\n", "    latency_s: 0\n" + keys);
}
const std::string kHalfTurnAboutZ = "    pose: {rotation_quaternion: [0, 0, 0, 1]}\n";
/// 30 degrees about z.
const std::string kSlanted =
    "    pose: {rotation_quaternion: [0.9659258263, 0, 0, 0.2588190451]}\n";

TEST(CompileKinematics, ScaleMovesPositionsUpAndForceLimitsDown) {
  const Compiled compiled =
      compiled_of(one_axis("    pose: {position_m: [0.1, 0.2, 0.3]}\n    workspace_scale: 4\n"));
  const control::Plan& plan = compiled.program->plan();
  ASSERT_EQ(plan.cartesian_axes.size(), 1U);
  EXPECT_EQ(plan.cartesian_axes[0].scale, 4);
  EXPECT_EQ(plan.cartesian_axes[0].origin, 0.1);
  EXPECT_EQ(plan.devices[0].max_force, 6.0 / 4);
  EXPECT_DOUBLE_EQ(plan.devices[0].max_slew, 6 / 0.005 * 0.001 / 4);
}

TEST(CompileKinematics, TurnedAxesAlongWorldDirectionsNeedNoJacobian) {
  const Compiled compiled = compiled_of(one_axis(kHalfTurnAboutZ));
  const control::Plan& plan = compiled.program->plan();
  EXPECT_TRUE(plan.linkages.empty());
  EXPECT_EQ(plan.cartesian_axes[0].scale, -1);
  // A third of a turn about (1, 1, 1): the device's x is the world's y.
  const Compiled turned =
      compiled_of(replaced(one_axis("    pose: {rotation_quaternion: [0.5, 0.5, 0.5, 0.5]}\n"),
                           "[1, 0, 0]", "[0, 1, 0]"));
  EXPECT_EQ(turned.program->spec().coordinate_names, std::vector<std::string>{"left.y"});
  EXPECT_EQ(turned.program->plan().cartesian_axes[0].scale, 1);
}

TEST(CompileKinematics, SlantedAxesAreALinearMap) {
  const Compiled compiled = compiled_of(three_axes(kSlanted + "    workspace_scale: 2\n"));
  const control::Plan& plan = compiled.program->plan();
  EXPECT_TRUE(plan.cartesian_axes.empty());
  ASSERT_EQ(plan.linkages.size(), 1U);
  ASSERT_EQ(plan.linear_maps.size(), 1U);
  const auto& turn = plan.linkages[0].turn;
  const double c = 2 * std::cos(M_PI / 6);
  const double s = 2 * std::sin(M_PI / 6);
  const double expected[3][3] = {{c, -s, 0}, {s, c, 0}, {0, 0, 2}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_NEAR(turn[i][j], expected[i][j], 1e-9) << i << j;
      EXPECT_EQ(plan.linear_maps[0].columns[i][j], i == j ? 1 : 0);
    }
  }
  EXPECT_FALSE(plan.linkages[0].rotary);
  EXPECT_EQ(plan.linkages[0].axes, 3);
}

TEST(CompileKinematics, OneSlantedAxisHasTheCoordinatesThatItMovesIn) {
  const Compiled compiled = compiled_of(one_axis(kSlanted));
  EXPECT_EQ(compiled.program->spec().coordinate_names,
            (std::vector<std::string>{"left.x", "left.y"}));
  EXPECT_EQ(compiled.program->plan().linkages[0].coordinates, 2);
  EXPECT_EQ(compiled.program->plan().planes[0].coordinates, 2);
}

TEST(CompileKinematics, PlaneMeetsTheContactWhereItsDeviceStands) {
  const Compiled compiled =
      compiled_of(replaced(one_axis("    pose: {position_m: [0.1, 0.2, 0.3]}\n"),
                           "normal: [1, 0, 0]", "normal: [3, 4, 0], offset_m: 0.5"));
  const control::PlaneContact& plane = compiled.program->plan().planes[0];
  EXPECT_DOUBLE_EQ(plane.normal[0], 0.6);
  EXPECT_DOUBLE_EQ(plane.offset, 0.5 - 0.8 * 0.2) << "y stays at 0.2 m";
}

TEST(CompileKinematics, QuaternionFarFromLengthOneIsRefused) {
  expect_error(one_axis("    pose: {rotation_quaternion: [1, 0, 0, 1]}\n"), "8:33",
               "devices[0].pose.rotation_quaternion", {"length 1", "1.41421"});
  EXPECT_TRUE(
      errors_of(replaced(one_axis("    pose: {rotation_quaternion: [0.7071, 0, 0, 0.7071]}\n"),
                         "[1, 0, 0]", "[0, 1, 0]"))
          .empty())
      << "as many digits as people write";
}

TEST(CompileKinematics, FiveBarMovesInItsPlane) {
  const Compiled compiled = compiled_of(kFiveBar);
  const control::Plan& plan = compiled.program->plan();
  ASSERT_EQ(plan.five_bars.size(), 1U);
  EXPECT_EQ(plan.five_bars[0].link_m, 0.2);
  EXPECT_EQ(plan.five_bars[0].base_m, 0.1);
  EXPECT_TRUE(plan.linkages[0].rotary);
  EXPECT_EQ(plan.linkages[0].axes, 2);
  EXPECT_EQ(plan.linkages[0].coordinates, 2);
  EXPECT_EQ(compiled.program->spec().coordinate_names,
            (std::vector<std::string>{"arm.x", "arm.y"}));
  EXPECT_EQ(plan.devices[0].max_force, 1.5);
  ASSERT_TRUE(compiled.simulated[0].linkage);
  EXPECT_EQ(std::get<control::FiveBar>(compiled.simulated[0].linkage->geometry).link_m, 0.2);
}

TEST(CompileKinematics, LinkageNeedsItsJointsAndAForceLimit) {
  expect_error(replaced(kFiveBar, "guard: {max_force_N: 1.5}\n", ""), "3:5",
               "devices[0].guard.max_force_N", {"missing", "linkage"});
  expect_error(replaced(kFiveBar, "base_m: 0.1", "base_m: 0.8"), "5:50",
               "devices[0].kinematics.five_bar.base_m", {"four times", "0.8 m"});
  expect_error(replaced(kFiveBar, "{five_bar: {link_m: 0.2, base_m: 0.1}}", "{delta: {}}"), "5:25",
               "devices[0].kinematics.delta", {"3, found 2 axes"});
  expect_error(replaced(kSmall, "cartesian: {directions: [x]}", "serial: {joints: [{a_m: 0.1}]}"),
               "9:9", "devices[0].axes[0].kind", {"expected rotary", "serial.joints[0]"});
}

std::string delta_text(const std::string& keys) {
  const std::string third = R"(      - name: c
        kind: rotary
        encoder: {counts_per_rev: 9880.7}
        actuator: {max_torque_Nm: 0.3}
        model: {inertia_kgm2: 2.0e-4, damping_Nms_rad: 8.0e-4}
)";
  return replaced(
      replaced(kFiveBar, "{five_bar: {link_m: 0.2, base_m: 0.1}}", "{delta: {" + keys + "}}"),
      "scene:\n", third + "scene:\n");
}

TEST(CompileKinematics, DeltaIsAFalconByDefault) {
  const Compiled compiled = compiled_of(delta_text(""));
  ASSERT_EQ(compiled.program->plan().deltas.size(), 1U);
  const control::Delta& delta = compiled.program->plan().deltas[0];
  const double lengths[8] = {delta.a, delta.b, delta.c, delta.d,
                             delta.e, delta.f, delta.r, delta.s};
  const double falcon[8] = {0.060, 0.1025, 0.01443, 0.01125, 0.01125, -0.025, 0.0400, -0.02309};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(lengths[i], falcon[i]) << i;
  const double degrees[3] = {105, -15, -135};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(delta.leg[i][0], std::cos(degrees[i] * M_PI / 180), 1e-15);
    EXPECT_NEAR(delta.leg[i][1], std::sin(degrees[i] * M_PI / 180), 1e-15);
  }
  EXPECT_EQ(compiled.program->plan().linkages[0].coordinates, 3);
}

TEST(CompileKinematics, DeltaWhoseHomeIsOutOfReachIsRefused) {
  expect_error(delta_text("home_m: [0, 0, 0.5]"), "5:34", "devices[0].kinematics.delta.home_m",
               {"out of reach"});
}

TEST(CompileKinematics, SerialChainTakesItsFigures) {
  const std::string text = replaced(
      replaced(kFiveBar, "{five_bar: {link_m: 0.2, base_m: 0.1}}",
               "{serial: {joints: [{a_m: 0.2, alpha_rad: 1.5, mass_kg: 0.1, center_m: [-0.1, 0, "
               "0]}, {theta_rad: 0.3, d_m: 0.05, a_m: 0.1}]}}"),
      "    latency_s: 0\n", "    latency_s: 0\n    gravity: {}\n");
  const Compiled compiled = compiled_of(text);
  ASSERT_EQ(compiled.program->plan().serials.size(), 1U);
  const control::Serial& chain = compiled.program->plan().serials[0];
  EXPECT_EQ(chain.joints, 2);
  EXPECT_EQ(chain.joint[0].a, 0.2);
  EXPECT_EQ(chain.joint[0].cos_twist, std::cos(1.5));
  EXPECT_EQ(chain.joint[0].sin_twist, std::sin(1.5));
  EXPECT_EQ(chain.joint[0].mass, 0.1);
  EXPECT_EQ(chain.joint[0].center[0], -0.1);
  EXPECT_EQ(chain.joint[1].theta, 0.3);
  EXPECT_EQ(chain.joint[1].d, 0.05);
  EXPECT_EQ(chain.gravity[2], -9.81);
  EXPECT_EQ(compiled.program->plan().linkages[0].coordinates, 3) << "a twist leaves the plane";
  expect_error(replaced(text, "    gravity: {}\n", ""), "5:35",
               "devices[0].kinematics.serial.joints", {"gravity: {}"});
}

TEST(CompileKinematics, SerialChainWithParallelAxesStaysInItsPlane) {
  const Compiled compiled =
      compiled_of(replaced(kFiveBar, "{five_bar: {link_m: 0.2, base_m: 0.1}}",
                           "{serial: {joints: [{a_m: 0.2}, {a_m: 0.1, alpha_rad: 1}]}}"));
  EXPECT_EQ(compiled.program->plan().linkages[0].coordinates, 2);
}

TEST(CompileKinematics, WeightOfTheTipActsUpwardsInTheScenesScale) {
  const Compiled compiled =
      compiled_of(three_axes("    gravity: {tip_mass_kg: 0.5}\n    workspace_scale: 2\n"));
  const auto tips = compiled.program->plan().gravity_tips;
  ASSERT_EQ(tips.size(), 1U);
  EXPECT_EQ(tips[0].weight[0], 0);
  EXPECT_DOUBLE_EQ(tips[0].weight[2], 0.5 * 9.81 / 2);
}

TEST(CompileKinematics, GravityOfASerialChainIsInTheDevicesFrame) {
  // A third of a turn about (1, 1, 1): the world's z is the device's y.
  const Compiled compiled =
      compiled_of(replaced(replaced(kFiveBar, "{five_bar: {link_m: 0.2, base_m: 0.1}}",
                                    "{serial: {joints: [{a_m: 0.2}, {a_m: 0.1}]}}"),
                           "    latency_s: 0\n",
                           "    latency_s: 0\n    gravity: {}\n    pose: {rotation_quaternion: "
                           "[0.5, 0.5, 0.5, 0.5]}\n"));
  const auto& gravity = compiled.program->plan().serials[0].gravity;
  EXPECT_EQ(gravity[0], 0);
  EXPECT_EQ(gravity[1], -9.81);
  EXPECT_EQ(gravity[2], 0);
  EXPECT_EQ(compiled.program->spec().coordinate_names,
            (std::vector<std::string>{"arm.y", "arm.z"}));
}

TEST(CompileKinematics, ForceSensorIsTurnedIntoTheContact) {
  const Compiled compiled = compiled_of(
      three_axes(kSlanted + "    workspace_scale: 2\n    force_sensor: {directions: [x, y]}\n"));
  const control::ForceSensor& sensor = compiled.program->plan().force_sensors[0];
  EXPECT_EQ(sensor.channels, 2);
  EXPECT_NEAR(sensor.turn[0][0], std::cos(M_PI / 6) / 2, 1e-9);
  EXPECT_NEAR(sensor.turn[0][1], -std::sin(M_PI / 6) / 2, 1e-9);
  EXPECT_NEAR(sensor.turn[1][0], std::sin(M_PI / 6) / 2, 1e-9);
  EXPECT_EQ(sensor.turn[2][0], 0);
}

TEST(CompileKinematics, SimulatedSensorHasTheAxesDirections) {
  expect_error(one_axis("    force_sensor: {directions: [y]}\n"), "8:32",
               "devices[0].force_sensor.directions", {"[x]"});
}

TEST(CompileKinematics, SimulatedLinkageHasItsMassesAndHand) {
  const std::string sim =
      "    sim: {linkage: {inner_link_kg: 1, outer_link_kg: 2, tip_kg: 3, gravity_m_s2: [0, -9, "
      "0]}, "
      "hand: {direction: [0, 3, 4]}}\n";
  const Compiled compiled =
      compiled_of(replaced(kFiveBar, "    latency_s: 0\n", sim + "    latency_s: 0\n"));
  const sim::LinkageOptions& linkage = *compiled.simulated[0].linkage;
  EXPECT_EQ(linkage.inner_link_kg, 1);
  EXPECT_EQ(linkage.outer_link_kg, 2);
  EXPECT_EQ(linkage.tip_kg, 3);
  EXPECT_EQ(linkage.gravity[1], -9);
  EXPECT_DOUBLE_EQ(linkage.hand_direction[1], 0.6);
  EXPECT_DOUBLE_EQ(linkage.hand_direction[2], 0.8);
  expect_error(one_axis("    sim: {linkage: {tip_kg: 3}}\n"), "8:20", "devices[0].sim.linkage",
               {"sim.axes"});
}

}  // namespace
}  // namespace hapticd::config::test
