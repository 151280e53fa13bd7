// Forces that wait: for a reference, for a hand on the dead-man.
#include <algorithm>
#include <cmath>

#include "control/core/fault.h"
#include "control/state.h"
#include "tests/process/daemon_fixture.h"

namespace hapticd::test {
namespace {

using control::Mode;
using testing::HasSubstr;

class Waiting : public DaemonTest {
 protected:
  /// A relative encoder 10 mm from a stop that is known to be at -30 mm, and nobody's hand on it.
  void write_homing_config() const {
    write_file("config.yaml", R"(version: 1
loop: {max_gap_ticks: 100000, max_missed_per_s: 20000}
devices:
  - name: left
    driver: sim
    sim: {axes: [{relative: true, position_m: -0.02, stops_m: [-0.03, 0.05]}]}
    kinematics: {cartesian: {directions: [x]}}
    latency_s: 0
    axes:
      - name: x
        encoder: {counts_per_m: 1e7}
        actuator: {max_force_N: 8}
        model: {mass_kg: 0.05, damping_Ns_m: 2}
        homing: {by: hard_stop, position_m: -0.03, search_force_N: -1, still_s: 0.5}
guard: {max_force_N: 6, ramp_s: 0.05}
control: {socket: )" + socket_ + R"(}
telemetry: {flight_dir: )" + dir_.file("flight") +
                                  ", record: " + record_ + "}\n");
  }
  static Mode mode_at(const daemon::Recording& recording, std::size_t i) {
    return static_cast<Mode>(recording.value(i, *recording.find("mode")));
  }
  /// The modes that the loop passed through, each once.
  static std::vector<Mode> modes(const daemon::Recording& recording) {
    std::vector<Mode> passed;
    for (std::size_t i = 0; i < recording.size(); ++i) {
      if (passed.empty() || passed.back() != mode_at(recording, i))
        passed.push_back(mode_at(recording, i));
    }
    return passed;
  }
};

TEST_F(Waiting, EnableFindsTheStopWithBoundedForceAndThenTurnsForcesOn) {
  write_homing_config();
  run();
  ASSERT_TRUE(reaches("ready")) << hapticd_->err();
  ASSERT_TRUE(eventually([&] { return !status()["waiting_for"].empty(); }));
  EXPECT_THAT(status()["waiting_for"][0].get<std::string>(),
              HasSubstr("left.x is not homed: `hapticctl enable` moves it slowly to its stop"));
  EXPECT_EQ(status()["summary"]["devices"][0]["homed"]["left.x"], false);
  EXPECT_EQ(ctl({"enable"}), 0) << ctl_err_;
  EXPECT_THAT(ctl_out_, HasSubstr("forces are on"));
  EXPECT_TRUE(eventually([&] { return status()["waiting_for"].empty(); }));
  EXPECT_EQ(status()["summary"]["devices"][0]["homed"]["left.x"], true);
  EXPECT_THAT(hapticd_->err(), HasSubstr("ready -> homing (hapticctl enable)"));
  ASSERT_EQ(stop(), 0);

  const auto recorded = recording();
  EXPECT_EQ(modes(recorded), (std::vector{Mode::idle, Mode::homing, Mode::enabled, Mode::idle}));
  double largest = 0, found = 0;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (mode_at(recorded, i) == Mode::homing)
      largest = std::max(largest, std::abs(recorded.value(i, *recorded.find("left.x.effort"))));
    if (mode_at(recorded, i) == Mode::enabled && found == 0)
      found = recorded.value(i, *recorded.find("left.x.q"));
  }
  EXPECT_GT(largest, 0.99);
  EXPECT_LE(largest, 1.0);
  EXPECT_NEAR(found, -0.03, 1e-3) << "the stop gives way a little";
}

TEST_F(Waiting, ASearchThatIsDisabledEndsWithoutForce) {
  write_homing_config();
  run();
  ASSERT_TRUE(reaches("ready")) << hapticd_->err();
  Process enable({HAPTICCTL_BINARY, "enable"}, dir_.file("enable"), {{"HAPTICD_SOCKET", socket_}});
  ASSERT_TRUE(reaches("homing"));
  ASSERT_EQ(ctl({"disable"}), 0);
  EXPECT_TRUE(reaches("ready"));
  EXPECT_EQ(enable.wait(), 1);
  ASSERT_EQ(stop(), 0);
  const auto recorded = recording();
  EXPECT_EQ(modes(recorded), (std::vector{Mode::idle, Mode::homing, Mode::idle}));
  EXPECT_EQ(recorded.value(recorded.size() - 1, *recorded.find("left.x.effort")), 0.0);
}

TEST_F(Waiting, ADeadManThatIsLetGoRampsToIdleAndComesBackWhenHeld) {
  start({.sim = "      digital: [{at_s: 0, bits: 1}, {at_s: 1, bits: 0}, {at_s: 2, bits: 1}]\n",
         .device = "    enable_inputs: [{bit: 0, role: dead_man}]\n"});
  ASSERT_TRUE(logs("forces wait: dead-man: left bit 0 is 0 and has to be 1")) << hapticd_->err();
  ASSERT_TRUE(passes_tick(2200));
  EXPECT_EQ(status()["state"], "enabled");
  EXPECT_TRUE(status()["waiting_for"].empty());
  ASSERT_EQ(stop(), 0);

  const auto recorded = recording();
  EXPECT_EQ(modes(recorded),
            (std::vector{Mode::idle, Mode::enabled, Mode::idle, Mode::enabled, Mode::idle}));
  const daemon::Field *tick = recorded.find("tick"), *effort = recorded.find("left.x.effort"),
                      *ramp = recorded.find("ramp");
  double pressed = 0;
  for (std::size_t i = 1; i < recorded.size(); ++i) {
    const double now = recorded.value(i, *effort);
    const bool let_go = recorded.value(i, *tick) >= 1000 && recorded.value(i, *tick) < 2000;
    if (!let_go) continue;
    if (pressed == 0) pressed = std::abs(recorded.value(i - 1, *effort));
    // The ramp, not the effort: the hand sinks in meanwhile, the farther the more ticks are missed.
    EXPECT_LE(recorded.value(i - 1, *ramp) - recorded.value(i, *ramp), 1.0 / 50 + 1e-12)
        << "record " << i;
    if (mode_at(recorded, i) == Mode::idle) {
      EXPECT_EQ(now, 0.0);
    }
  }
  EXPECT_GT(pressed, 1.0);
}

TEST_F(Waiting, EnableSaysWhichBitItWaitsFor) {
  start({.enable = "on_command", .device = "    enable_inputs: [{bit: 3, role: dead_man}]\n"});
  ASSERT_TRUE(reaches("ready")) << hapticd_->err();
  EXPECT_EQ(ctl({"enable"}), 75);
  EXPECT_THAT(ctl_err_, HasSubstr("dead-man: left bit 3 is 0 and has to be 1"));
  EXPECT_EQ(status()["enabling"], true);
  EXPECT_EQ(ctl({"status"}), 0);
  EXPECT_THAT(ctl_out_, HasSubstr("waiting for     dead-man: left bit 3"));
  EXPECT_EQ(stop(), 0);
}

TEST_F(Waiting, AnEmergencyStopInputIsAFaultNamingItsDevice) {
  start({.sim = "      digital: [{at_s: 0, bits: 2}, {at_s: 0.5, bits: 0}]\n",
         .device = "    enable_inputs: [{bit: 1, role: estop}]\n"});
  ASSERT_TRUE(reaches("fault")) << hapticd_->err();
  EXPECT_EQ(status()["fault"]["name"], "estop");
  EXPECT_EQ(status()["fault"]["axis_or_device"], "left");
  EXPECT_EQ(ctl({"enable"}), 1) << "the button is still pressed";
  EXPECT_EQ(stop(), 0);
}

}  // namespace
}  // namespace hapticd::test
