// Each protocol and timing over the kernel's CAN, in real time: arming, a second of forces, and what ends them.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/vm/can_loop.h"
#include "tests/vm/links.h"

namespace hapticd::test {
namespace {

using can::Protocol;
using drivers::Timing;

struct Kind {
  const char* name = "";
  Protocol protocol = Protocol::odrive;
  Timing timing = Timing::in_phase;
};

class CanDevice : public testing::TestWithParam<Kind> {
 protected:
  const Kind& kind() const { return GetParam(); }
  /// A torque, as another program would send it.
  void command_from_outside() {
    RawSocket other(link.name(), true);
    switch (kind().protocol) {
      case Protocol::odrive:
        return other.send(kNode << 5 | 0x0e, {0, 0, 0x80, 0x3f});
      case Protocol::cia402:
        return other.send(0x200 + kNode, {0x0f, 0, 1, 0});
      case Protocol::moteus:
        return other.send(CAN_EFF_FLAG | 0x8200 | kNode, {0x01, 0x00, 0x0a}, CANFD_FDF | CANFD_BRS);
    }
  }
  void connect_and_arm() {
    ASSERT_EQ(loop.connect(), "");
    ASSERT_TRUE(loop.arm()) << loop.fault();
    loop.ticks(20, 2);
    ASSERT_NEAR(drive.torque_Nm(), 2 / (2 * M_PI * 20), 1e-4);
  }
  void expect_fault(const std::string& words) {
    EXPECT_TRUE(loop.aux.faulted);
    EXPECT_EQ(loop.fault(), link.name() + ": " + words);
  }
  void expect_off() {
    pause_ms(2);
    EXPECT_EQ(drive.torque_Nm(), 0);
    EXPECT_FALSE(drive.enabled());
  }
  void expect_recovery() {
    loop.disarm();
    EXPECT_FALSE(loop.aux.faulted) << loop.fault();
    EXPECT_TRUE(loop.arm()) << loop.fault();
    loop.ticks(20, 2);
    EXPECT_NEAR(drive.torque_Nm(), 2 / (2 * M_PI * 20), 1e-4);
  }

  Link link{"drives0", kFdMtu};
  can::DeviceOptions options = one_axis(kind().protocol, kind().timing, link.name());
  EmulatedDrive drive{options, link.name()};
  CanLoop loop{options};
};

INSTANTIATE_TEST_SUITE_P(
    All, CanDevice,
    testing::Values(Kind{"odrive_free_running", Protocol::odrive, Timing::free_running},
                    Kind{"odrive_in_phase", Protocol::odrive, Timing::in_phase},
                    Kind{"moteus", Protocol::moteus, Timing::reply_to_command},
                    Kind{"moteus_in_phase", Protocol::moteus, Timing::in_phase},
                    Kind{"cia402", Protocol::cia402, Timing::in_phase}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST_P(CanDevice, MakesForcesAndIsOffAfterwards) {
  ASSERT_EQ(loop.connect(), "");
  EXPECT_FALSE(drive.enabled());
  const std::int64_t start_ns = now_ns();
  ASSERT_TRUE(loop.arm()) << loop.fault();
  const std::int64_t armed_ns = now_ns();
  loop.ticks(5);

  loop.fresh = 0;
  loop.latest_ns = 0;
  constexpr int kTicks = 500;
  for (int i = 0; i < kTicks; ++i) {
    loop.tick(3);
    ASSERT_TRUE(loop.aux.armed && !loop.aux.faulted) << i << ": " << loop.fault();
    ASSERT_NEAR(loop.delivered, 3, 0.02) << i;
    if (loop.sample.freshness != Freshness::fresh) continue;
    ASSERT_NEAR(loop.sample.raw, kStandsAt_turns * kCountsPerTurn, 1) << i;
    ASSERT_GE(loop.sample.age_ns, 0) << i;
  }
  EXPECT_GE(loop.fresh, 0.95 * kTicks);
  EXPECT_NEAR(drive.torque_Nm(), 3 / (2 * M_PI * 20), 1e-4);
  const drivers::Traffic& counted = *loop.device().traffic();
  EXPECT_EQ(counted.not_sent, 0U);
  EXPECT_EQ(counted.lost, 0U);
  EXPECT_EQ(counted.foreign.load(), 0U);
  std::cout << "# " << kind().name << ": armed after " << (armed_ns - start_ns) / kMillisecond
            << " ms, " << loop.fresh << " of " << kTicks << " samples fresh, the last "
            << loop.sample.age_ns / 1000 << " us old, " << loop.device().traffic()->late.load()
            << " late, ticks end after at most " << loop.latest_ns / 1000 << " us\n";

  loop.device().disconnect();
  expect_off();
}

TEST_P(CanDevice, AnotherProgramThatCommandsTheDriveEndsForces) {
  connect_and_arm();
  command_from_outside();
  loop.tick(2);
  expect_fault("another program on this machine commands these drives");
  expect_off();
  expect_recovery();
}

TEST_P(CanDevice, AnInterfaceThatIsSwitchedOffIsAFaultInTheSameTick) {
  connect_and_arm();
  link.down();
  loop.tick(2);
  expect_fault("the interface was switched off: switch it on again (ip link set DEV up)");
  loop.ticks(50);  // the watchdog
  EXPECT_TRUE(loop.aux.faulted);
  expect_off();
  link.up();
  expect_recovery();
}

TEST_P(CanDevice, AnInterfaceThatIsGoneIsAFaultInTheSameTick) {
  connect_and_arm();
  link.remove();
  loop.tick(2);
  expect_fault("the interface is gone: plug it in again and restart hapticd");
  loop.ticks(50);
  expect_off();
}

TEST_P(CanDevice, BusOffIsAFaultInTheSameTick) {
  connect_and_arm();
  RawSocket controller(link.name());
  controller.report(CAN_ERR_BUSOFF);
  loop.tick(2);
  expect_fault(
      "the controller went bus-off: check wiring and termination, then restart it "
      "(ip link set DEV type can restart)");
  expect_off();
  controller.report(CAN_ERR_RESTARTED);
  expect_recovery();
}

/// A frame takes 6 ms or more, and most are refused.
TEST_P(CanDevice, ABusThatIsTooSlowArmsNothing) {
  ASSERT_EQ(loop.connect(), "");
  link.netem("rate 20kbit limit 2");
  EXPECT_FALSE(loop.arm());
  EXPECT_GT(loop.device().traffic()->not_sent.load(), 0U);
  EXPECT_FALSE(drive.enabled() && drive.torque_Nm() != 0);
}

}  // namespace
}  // namespace hapticd::test
