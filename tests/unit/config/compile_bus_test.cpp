// Devices of CAN drives: what their drivers are told, and what a bus cannot do.
#include <cmath>
#include <numbers>

#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

/// One axis on can0; line 6 is `can`, line 8 the latency, line 11 the axis' `can`.
const std::string kCan = R"(version: 1
loop: {rate_Hz: 1000}
devices:
  - name: arm
    driver: odrive
    can: {interface: can0, watchdog_s: 0.02}
    kinematics: {cartesian: {directions: [x]}}
    latency_s: 0.003
    axes:
      - name: x
        can: {node: 3, counts_per_turn: 8192}
        encoder: {counts_per_m: 163840, reversed: true}
        actuator: {max_force_N: 8}
stability: {require: none}
guard: {max_force_N: 6}
)";

std::string can_with(const std::string& keys) {
  return replaced(kCan, "watchdog_s: 0.02", "watchdog_s: 0.02, " + keys);
}

/// As many axes, nodes 1, 2, ..., of `driver`, on can0 or on those of `interfaces`.
std::string many(const std::string& driver, int axes, const std::string& keys,
                 const std::vector<std::string>& interfaces = {}) {
  const char* directions[] = {"x", "y", "z"};
  std::string text = "version: 1\ndevices:\n";
  for (int first = 0; first < axes; first += 3) {
    const int count = std::min(3, axes - first);
    std::string named;
    for (int i = 0; i < count; ++i) named += (i > 0 ? ", " : "") + std::string(directions[i]);
    text += "  - name: d" + std::to_string(first) + "\n    driver: " + driver +
            "\n    can: {interface: can0, watchdog_s: 0.02" + keys +
            "}\n    latency_s: 0.01\n    kinematics: {cartesian: {directions: [" + named +
            "]}}\n    axes:\n";
    for (int i = 0; i < count; ++i) {
      const auto axis = static_cast<std::size_t>(first + i);
      text += "      - {name: " + std::string(directions[i]) +
              ", can: {node: " + std::to_string(axis + 1) + ", counts_per_turn: 8192" +
              (axis < interfaces.size() ? ", interface: " + interfaces[axis] : "") +
              "}, encoder: {counts_per_m: 163840}, actuator: {max_force_N: 8}}\n";
    }
  }
  return text + "stability: {require: none}\nguard: {max_force_N: 6}\n";
}

TEST(CompileCan, DriversAreToldWhatTheConfigSays) {
  const Compiled compiled =
      compiled_of(replaced(can_with("heartbeat_every_s: 0.05"), "counts_per_turn: 8192",
                           "counts_per_turn: 8192, max_current_A: 12"));
  ASSERT_TRUE(compiled.can.at(0));
  const can::DeviceOptions& device = *compiled.can[0];
  EXPECT_EQ(device.protocol, can::Protocol::odrive);
  EXPECT_EQ(device.timing, drivers::Timing::free_running);
  EXPECT_EQ(device.watchdog_s, 0.02);
  EXPECT_EQ(device.heartbeat_every_s, 0.05);
  ASSERT_EQ(device.drives.size(), 1U);
  const can::DriveOptions& drive = device.drives[0];
  EXPECT_EQ(drive.axis, "arm.x");
  EXPECT_EQ(drive.interface, "can0");
  EXPECT_EQ(drive.node, 3);
  EXPECT_EQ(drive.counts_per_unit, -163840) << "reversed: torque, too";
  EXPECT_EQ(drive.counts_per_turn, 8192);
  EXPECT_EQ(drive.max_effort, 8);
  EXPECT_EQ(drive.max_current_A, 12);
  EXPECT_EQ(drive.max_velocity_turns_s, 2 * 1.5 * 20) << "twice the guard's 1.5 m/s";
}

TEST(CompileCan, EachDriverHasATimingOfItsOwn) {
  const auto timing = [](const std::string& driver) {
    return compiled_of(replaced(kCan, "odrive", driver)).can[0]->timing;
  };
  EXPECT_EQ(timing("odrive"), drivers::Timing::free_running);
  EXPECT_EQ(timing("moteus"), drivers::Timing::reply_to_command);
  EXPECT_EQ(timing("cia402"), drivers::Timing::in_phase);
  expect_error(can_with("timing: reply_to_command"), "6:54", "devices[0].can.timing",
               {"free_running or in_phase", "odrive", "reply_to_command"});
  expect_error(replaced(can_with("timing: free_running"), "odrive", "cia402"), "6:54",
               "devices[0].can.timing", {"expected in_phase for"});
}

TEST(CompileCan, KeysOfABusStandWithADriverForOne) {
  expect_error(replaced(kCan, "    can: {interface: can0, watchdog_s: 0.02}\n", ""), "4:5",
               "devices[0].can", {"missing", "driver: odrive"});
  expect_error(replaced(kCan, "        can: {node: 3, counts_per_turn: 8192}\n", ""), "10:9",
               "devices[0].axes[0].can", {"missing"});
  const std::string simulated = listed(errors_of(replaced(kCan, "odrive", "sim")));
  EXPECT_NE(simulated.find("devices[0].can: driver: sim has no CAN bus"), std::string::npos)
      << simulated;
  EXPECT_NE(simulated.find("axes[0].can: driver: sim has no CAN bus"), std::string::npos)
      << simulated;
}

/// hapticd gives up before a drive does, and a hand never waits longer than 50 ms.
TEST(CompileCan, TheWatchdogComesAfterTheFault) {
  expect_error(replaced(kCan, "watchdog_s: 0.02", "watchdog_s: 0.004"), "6:40",
               "devices[0].can.watchdog_s",
               {"more than 4 ticks", "0.004 s", "loop.rate_Hz above 1000"});
  EXPECT_TRUE(errors_of(replaced(kCan, "watchdog_s: 0.02", "watchdog_s: 0.0041")).empty());
  expect_error(replaced(kCan, "watchdog_s: 0.02", "watchdog_s: 0.051"), "6:40",
               "devices[0].can.watchdog_s", {"0.05"});
  const std::string slow = replaced(replaced(kCan, "rate_Hz: 1000", "rate_Hz: 100"),
                                    "watchdog_s: 0.02", "watchdog_s: 0.03");
  EXPECT_NE(listed(errors_of(slow)).find("the longest watchdog, 0.05 s, needs 80"),
            std::string::npos)
      << listed(errors_of(slow));
}

TEST(CompileCan, NodesAreThoseOfTheProtocolAndNobodyElses) {
  expect_error(replaced(kCan, "node: 3", "node: 63"), "11:21", "devices[0].axes[0].can.node",
               {"0 to 62", "63"});
  expect_error(replaced(replaced(kCan, "odrive", "moteus"), "node: 3", "node: 127"), "11:21",
               "devices[0].axes[0].can.node", {"1 to 126"});
  expect_error(replaced(replaced(can_with("host_id: 3"), "odrive", "moteus"), "node: 3", "node: 3"),
               "6:55", "devices[0].can.host_id", {"no drive has", "axis 'x'"});
  const std::string two = replaced(many("odrive", 2, ""), "node: 2", "node: 1");
  EXPECT_NE(listed(errors_of(two)).find("node 1 on can0 is the drive of 'd0.x' already"),
            std::string::npos)
      << listed(errors_of(two));
}

TEST(CompileCan, TwoProtocolsDoNotShareABus) {
  const std::string text =
      replaced(many("odrive", 4, ""),
               "driver: odrive\n    can: {interface: can0, watchdog_s: 0.02}\n    latency_s: "
               "0.01\n    kinematics: {cartesian: {directions: [x]}}",
               "driver: cia402\n    can: {interface: can0, watchdog_s: 0.02}\n    latency_s: "
               "0.01\n    kinematics: {cartesian: {directions: [x]}}");
  EXPECT_NE(listed(errors_of(text)).find("another protocol"), std::string::npos)
      << listed(errors_of(text));
  EXPECT_NE(
      listed(errors_of(many("cia402", 4, ", heartbeat_every_s: 1"))).find("a SYNC of their own"),
      std::string::npos);
}

/// By the bits of ISO 11898-1: 3 ODrive axes at 1 kHz take 690 us of 1000, 4 take 920; a heartbeat of 135 us comes ten times a second.
TEST(CompileCan, ABusHasRoomForThreeAxes) {
  const Compiled three = compiled_of(many("odrive", 3, ""));
  ASSERT_EQ(three.buses.size(), 1U);
  EXPECT_NEAR(three.buses[0].share, 0.690 + 3 * 135e-6 / 0.1, 1e-9);
  EXPECT_EQ(three.buses[0].axes_that_fit, 3U);
  const auto errors = errors_of(many("odrive", 4, ""));
  ASSERT_FALSE(errors.empty());
  EXPECT_NE(errors[0].message.find("expected at most 80 %"), std::string::npos) << listed(errors);
  EXPECT_NE(errors[0].message.find("3 of these axes fit"), std::string::npos);
  EXPECT_TRUE(errors_of(many("odrive", 4, "", {"can0", "can0", "can0", "can1"})).empty());
}

TEST(CompileCan, RoomOfTheOtherProtocols) {
  // CiA 402: 230 us an axis, SYNC 55 us; heartbeats of 65 us of drives (1/s) and host (every 20/3 ms).
  const Compiled cia402 = compiled_of(many("cia402", 3, ", heartbeat_every_s: 1"));
  EXPECT_NEAR(cia402.buses[0].share, 3 * (0.230 + 65e-6) + 0.055 + 65e-6 / (0.02 / 3), 1e-9);
  EXPECT_EQ(cia402.buses[0].axes_that_fit, 3U);
  // moteus: 48 bytes out, 24 back, both taken as extended: 161 and 113 us.
  const Compiled moteus = compiled_of(many("moteus", 2, ""));
  EXPECT_NEAR(moteus.buses[0].share, 2 * (0.161 + 0.113), 0.002);
  EXPECT_EQ(moteus.buses[0].axes_that_fit, 2U);
}

/// In phase with one axis: questions and answers 55 + 135 us, a heartbeat 135 us, torque 95 us.
TEST(CompileCan, LatencyCoversSampleAgeFramesAndDrive) {
  const std::string text = can_with("timing: in_phase");
  const Compiled compiled = compiled_of(text);
  EXPECT_EQ(compiled.collect_s, 0.0005) << "half a period";
  EXPECT_EQ(compiled.can[0]->worst_sample_age_s, 0.0005);
  const double least_s = 0.0005 + 50e-6 + 95e-6 + 135e-6 + 1e-4;
  EXPECT_TRUE(errors_of(replaced(text, "latency_s: 0.003", "latency_s: 0.000881")).empty());
  EXPECT_NEAR(least_s, 0.00088, 1e-12);
  expect_error(replaced(text, "latency_s: 0.003", "latency_s: 0.00087"), "8:16",
               "devices[0].latency_s", {"at least 0.00088 s", "0.0005 s old (in_phase)"});
  // Free running: 1 ms on the drive's clock; all frames of a tick (365 us) may come before it, on its way and on the way
  // back.
  expect_error(replaced(kCan, "latency_s: 0.003", "latency_s: 0.0022"), "8:16",
               "devices[0].latency_s", {"at least 0.002246 s", "free_running"});
}

/// n axes: n (55 + 135) us, a heartbeat of 135 us, turnaround 100 us, a late wake 50 us.
TEST(CompileCan, InPhaseTheAnswersMustComeInTime) {
  EXPECT_NEAR(compiled_of(many("odrive", 2, ", timing: in_phase")).collect_s, 665e-6, 1e-9)
      << "the loop waits for longer than half a period";
  const std::string three = listed(errors_of(many("odrive", 3, ", timing: in_phase")));
  EXPECT_NE(three.find("after 80 % of a period, 0.0008 s; at worst they take 0.000855"),
            std::string::npos)
      << three;
  EXPECT_NE(three.find("or free_running"), std::string::npos) << three;
  EXPECT_TRUE(errors_of(many("odrive", 3, ", timing: in_phase", {"can0", "can1", "can0"})).empty());
}

TEST(CompileCan, AKeyOfAnotherDriverIsRefused) {
  expect_error(can_with("prefix: 3"), "6:54", "devices[0].can.prefix",
               {"driver: moteus", "odrive"});
  expect_error(replaced(replaced(kCan, "odrive", "moteus"), "counts_per_turn: 8192",
                        "counts_per_turn: 8192, max_current_A: 3"),
               "11:62", "devices[0].axes[0].can.max_current_A", {"driver: odrive", "moteus"});
  expect_error(
      replaced(kCan, "counts_per_turn: 8192", "counts_per_turn: 8192, max_velocity_turns_s: 3"),
      "11:69", "devices[0].axes[0].can.max_velocity_turns_s", {"max_current_A, too"});
  expect_error(replaced(kCan, "interface: can0", "interface: a_name_too_long_"), "6:22",
               "devices[0].can.interface", {"1 to 15 letters"});
}

TEST(CompileCan, DevicesOnOneBusAgreeOnIt) {
  const auto errors_with = [](const std::string& driver, const std::string& from,
                              const std::string& to) {
    std::string text = many(driver, 4, "");
    const auto second = text.find("name: d3");
    return listed(errors_of(text.substr(0, second) + replaced(text.substr(second), from, to)));
  };
  EXPECT_NE(errors_with("odrive", "watchdog_s: 0.02", "watchdog_s: 0.02, bitrate_Hz: 500000")
                .find("other bit rates on can0: 'd0'"),
            std::string::npos);
  EXPECT_NE(errors_with("moteus", "watchdog_s: 0.02", "watchdog_s: 0.02, host_id: 2")
                .find("a drive has the id of a host"),
            std::string::npos);
}

/// Beside a device that is sampled in phase the loop waits, for the others, too.
TEST(CompileCan, LatencyCoversWaitingForOthers) {
  std::string text = many("odrive", 4, "", {"can0", "can0", "can0", "can1"});
  const auto second = text.find("name: d3");
  const std::string mixed =
      text.substr(0, second) +
      replaced(text.substr(second), "watchdog_s: 0.02", "watchdog_s: 0.02, timing: in_phase");
  const auto latency = [](const Compiled& compiled) {
    return can::worst_latency_s(*compiled.can[0], can::worst_of(*compiled.can[0], compiled.buses));
  };
  EXPECT_NEAR(latency(compiled_of(mixed)), latency(compiled_of(text)) + 0.0005, 1e-9);
}

/// The age of a sample on a bus varies: a proof for one latency alone does not count.
TEST(CompileCan, TheCheckKnowsThatTheLatencyVaries) {
  EXPECT_TRUE(compiled_of(kCan).assumed[0].latency_varies);
  EXPECT_FALSE(compiled_of(kSmall).assumed[0].latency_varies);
}

}  // namespace
}  // namespace hapticd::config::test
