// moteus: what it does.
#include "sim/can/moteus_drive.h"

#include <gtest/gtest.h>

#include "tests/unit/emulators/host_end.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;

// Mode 10, position NaN, velocity 0, torque, kp = kd = 0, then max torque, timeout and ilimit 0.
std::string pure_torque(float torque_Nm, float timeout_s = 0.1F, float most_Nm = 9) {
  return "01000a0c06200000c07f00000000" + hex_le(torque_Nm) + "0000000000000000" + hex_le(most_Nm) +
         "0d27" + hex_le(timeout_s) + "0d2b00000000";
}

struct TestedMoteus {
  MoteusDrive drive;
  std::int64_t now_ns = 0;
  explicit TestedMoteus(const MoteusOptions& options = {}) : drive(options, 0) {}

  void tell(const std::string& hex, unsigned destination = 1) {
    drive.receive(fd_frame(destination, hex), now_ns);
  }
  void run_to(std::int64_t at_ns) {
    now_ns = at_ns;
    drive.advance(now_ns);
  }
  // Reply to a query with these subframes, without padding it would not need.
  std::string ask(const std::string& hex, std::uint32_t id = 0x8001) {
    drive.take_sent();
    drive.receive(fd_frame(id, hex), now_ns);
    const auto sent = sent_by(drive);
    return sent.size() == 1 ? hex_of(sent[0]) : "";
  }
  void arm(float torque_Nm = 0) {
    tell(pure_torque(torque_Nm));
    run_to(now_ns + 10 * kMs);
  }
};

TEST(MoteusDrive, CalibratesOnTheWayFromStopped) {
  TestedMoteus t;
  t.tell(pure_torque(0.5F));
  EXPECT_EQ(t.drive.mode(), MoteusMode::enabling);
  t.run_to(4 * kMs);
  EXPECT_EQ(t.drive.mode(), MoteusMode::calibrating);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.tell(pure_torque(0.25F));
  t.run_to(7 * kMs);
  EXPECT_EQ(t.drive.mode(), MoteusMode::calibrated);
  t.run_to(10 * kMs);
  EXPECT_EQ(t.drive.mode(), MoteusMode::position);
  EXPECT_TRUE(t.drive.enabled());
  EXPECT_EQ(t.drive.torque_Nm(), 0.25);
}

TEST(MoteusDrive, PureTorqueDoesNotDependOnTheMotion) {
  TestedMoteus t;
  t.arm(0.5F);
  for (int i = 0; i < 50; ++i) {
    t.run_to(t.now_ns + kMs);
    t.drive.move_to(0.01 * i, 10);
    t.tell(pure_torque(0.5F));
    ASSERT_EQ(t.drive.torque_Nm(), 0.5);
  }
  EXPECT_EQ(t.drive.fault(), 0);
}

// int16 position NaN: the setpoint stays where the servo was when it was armed.
TEST(MoteusDrive, AForgottenScaleShowsAsTorque) {
  TestedMoteus t;
  t.arm();
  t.drive.move_to(0.5, 2);
  t.tell("01000a05200080012400012b00");  // no kp
  EXPECT_NEAR(t.drive.torque_Nm(), -4 * 0.5, 1e-9);
  t.tell("01000a05200080012300012b00");  // no kd
  EXPECT_NEAR(t.drive.torque_Nm(), -0.05 * 2, 1e-9);
}

TEST(MoteusDrive, AForgottenIlimitIntegrates) {
  TestedMoteus t;
  t.arm();
  t.drive.move_to(0.5, 0);
  t.tell("01000a0520008002230000");
  t.run_to(t.now_ns + 50 * kMs);
  EXPECT_NEAR(t.drive.torque_Nm(), -0.5 * 0.05, 1e-9);
  for (int i = 0; i < 100; ++i) {
    t.tell("01000a0520008002230000");
    t.run_to(t.now_ns + 50 * kMs);
  }
  EXPECT_NEAR(t.drive.torque_Nm(), -1, 1e-9);
}

TEST(MoteusDrive, ANewCommandForgetsTheFieldsOfTheLast) {
  TestedMoteus t;
  t.arm(0.5F);
  t.tell("01000a");
  EXPECT_EQ(t.drive.command().feedforward_Nm, 0);
  EXPECT_EQ(t.drive.command().kp_scale, 1);
  EXPECT_EQ(t.drive.command().kd_scale, 1);
  EXPECT_EQ(t.drive.command().ilimit_scale, 1);
  EXPECT_EQ(t.drive.command().max_torque_Nm, 100);
  EXPECT_EQ(t.drive.command().timeout_s, 0);
}

TEST(MoteusDrive, WithoutAModeNothingIsApplied) {
  TestedMoteus t;
  t.arm(0.5F);
  t.tell("0d22" + hex_le(2.0F));
  EXPECT_EQ(t.drive.torque_Nm(), 0.5);
  EXPECT_EQ(t.ask("1d22").substr(0, 12), "2d22" + hex_le(2.0F));
  t.tell("0d22" + hex_le(3.0F) + "01000a");  // the mode comes too late
  EXPECT_EQ(t.drive.command().feedforward_Nm, 0);
}

TEST(MoteusDrive, StayWithinWithoutBoundsIsPureTorque) {
  TestedMoteus t;
  t.tell("01000d0f400000c07f0000c07f0000803e0e450000803fcdcccc3d505050505050");
  t.run_to(10 * kMs);
  t.drive.move_to(3, 5);
  EXPECT_EQ(t.drive.mode(), MoteusMode::stay_within);
  EXPECT_EQ(t.drive.torque_Nm(), 0.25);
  t.run_to(110 * kMs - kUs);
  EXPECT_EQ(t.drive.mode(), MoteusMode::stay_within);
  t.run_to(110 * kMs + kUs);
  EXPECT_EQ(t.drive.mode(), MoteusMode::timeout);
}

TEST(MoteusDrive, MaximumTorqueClipsAndIsReportedWhileRunning) {
  TestedMoteus t;
  t.tell(pure_torque(-3, 0.1F, 2));
  t.run_to(10 * kMs);
  EXPECT_EQ(t.drive.torque_Nm(), -2);
  EXPECT_TRUE(t.drive.enabled());
  EXPECT_EQ(t.ask("110f").substr(0, 6), "210f66");
  t.tell(pure_torque(-1, 0.1F, 2));
  EXPECT_EQ(t.ask("110f").substr(0, 6), "210f00");
  t.tell(pure_torque(50, 0.1F, std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(t.drive.torque_Nm(), 10);
}

TEST(MoteusDrive, TheWatchdogLatchesUntilStopped) {
  TestedMoteus t;
  t.tell(pure_torque(1, 0.02F));
  t.run_to(10 * kMs);
  t.run_to(15 * kMs);
  t.tell(pure_torque(1, 0.02F));
  t.run_to(35 * kMs - 1);
  EXPECT_EQ(t.drive.torque_Nm(), 1);
  EXPECT_EQ(t.drive.next_ns(), 35 * kMs);
  t.run_to(35 * kMs);
  EXPECT_EQ(t.drive.mode(), MoteusMode::timeout);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.tell(pure_torque(1, 0.02F));
  EXPECT_EQ(t.drive.mode(), MoteusMode::timeout);
  t.tell("010000");
  EXPECT_EQ(t.drive.mode(), MoteusMode::stopped);
  t.arm(1);
  EXPECT_EQ(t.drive.torque_Nm(), 1);
}

TEST(MoteusDrive, TimeoutZeroIsTheConfiguredOneAndNaNNone) {
  TestedMoteus t;
  t.tell(pure_torque(1, 0));
  t.run_to(10 * kMs);
  EXPECT_EQ(t.drive.next_ns(), 110 * kMs);
  t.tell(pure_torque(1, std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(t.drive.next_ns(), kNever);
}

TEST(MoteusDrive, AFaultLatchesUntilStopped) {
  TestedMoteus t;
  t.arm(1);
  t.drive.fail(33, t.now_ns);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  EXPECT_EQ(t.ask("1100110f").substr(0, 12), "210001210f21");
  t.tell(pure_torque(1));
  EXPECT_EQ(t.drive.mode(), MoteusMode::fault);
  t.tell("010000");
  EXPECT_EQ(t.ask("1100110f").substr(0, 12), "210000210f00");
}

TEST(MoteusDrive, EnteringOutsideThePositionLimitsIsFault39) {
  MoteusOptions options;
  options.position_min = -0.01;
  options.position_max = 0.01;
  TestedMoteus t(options);
  t.drive.move_to(0.02, 0);
  t.arm(1);
  EXPECT_EQ(t.drive.mode(), MoteusMode::fault);
  EXPECT_EQ(t.drive.fault(), 39);
  t.tell("010000");
  t.tell(pure_torque(1) + "012d01");  // ignore them
  t.run_to(t.now_ns + 10 * kMs);
  EXPECT_EQ(t.drive.torque_Nm(), 1);
}

TEST(MoteusDrive, BeyondTheLimitsOutwardTorqueIsTakenAway) {
  MoteusOptions options;
  options.position_min = -0.01;
  options.position_max = 0.01;
  TestedMoteus t(options);
  t.arm(1);
  t.drive.move_to(0.02, 0);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  EXPECT_EQ(t.drive.fault(), MoteusDrive::kLimitPosition);
  t.tell(pure_torque(-1));
  EXPECT_EQ(t.drive.torque_Nm(), -1);
}

TEST(MoteusDrive, AnswersTheDefaultQuery) {
  TestedMoteus t;
  t.arm(0.25F);
  t.drive.move_to(-0.5, 0.25);
  EXPECT_EQ(t.ask("11001f01130d"),
            "21000a2f01" + hex_le(-0.5F) + hex_le(0.25F) + hex_le(0.25F) + "230d301a005050");
}

TEST(MoteusDrive, TheReplyTellsTheStateBeforeItsCommandActs) {
  TestedMoteus t;
  t.arm(0.25F);
  EXPECT_EQ(t.ask("0100001100").substr(0, 6), "21000a");
  EXPECT_EQ(t.ask("1100").substr(0, 6), "210000");
}

TEST(MoteusDrive, RepliesOnlyWhenAskedAndWithTheIdsOfTheQuery) {
  TestedMoteus t;
  EXPECT_EQ(t.ask("1100", 0x0001), "");
  EXPECT_EQ(t.ask("1100", 0x8002), "");
  EXPECT_EQ(t.ask("1100", 0x128001), "");  // another prefix
  t.drive.receive(fd_frame(0x8301, "1100"), 0);
  const auto sent = t.drive.take_sent();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].frame.can_id, 0x103U);
  EXPECT_EQ(sent[0].at_ns, 50 * kUs);
  EXPECT_NE(t.ask("1100", 0x807f), "");  // broadcast
}

TEST(MoteusDrive, HighServosAnswerWithExtendedFramesAndPrefixesAreKept) {
  MoteusOptions options;
  options.servo = 9;
  options.prefix = 0x12;
  MoteusDrive drive(options, 0);
  drive.receive(fd_frame(0x128009, "1100"), 0);
  EXPECT_EQ(sent_by(drive).at(0).can_id, 0x120900U | CAN_EFF_FLAG);
}

TEST(MoteusDrive, AnswersInTheKindOfTheQuery) {
  TestedMoteus t;
  const auto flags = [&](Frame query) {
    query.can_id = 0x8001U | CAN_EFF_FLAG;
    t.drive.receive(query, 0);
    return sent_by(t.drive).at(0).flags;
  };
  EXPECT_EQ(flags(fd_frame(0x8001, "1100", true)), CANFD_FDF | CANFD_BRS);
  EXPECT_EQ(flags(fd_frame(0x8001, "1100", false)), CANFD_FDF);
  EXPECT_EQ(flags(data_frame(0, "1100")), 0);
}

TEST(MoteusDrive, CountsMillisecondsOfItsOwnClockAndWraps) {
  MoteusOptions options;
  options.clock_drift = 0.5;
  TestedMoteus t(options);
  t.run_to(100 * kMs + kUs);
  EXPECT_EQ(t.ask("1170").substr(0, 6), "2170" + hex_le(static_cast<std::int8_t>(-106)));  // 150
  EXPECT_EQ(t.ask("1570").substr(0, 8), "2570" + hex_le(std::int16_t{150}));
}

TEST(MoteusDrive, TellsWhatItIs) {
  TestedMoteus t;
  EXPECT_EQ(t.ask("118202").substr(0, 8), "21820205");
  EXPECT_EQ(t.ask("1ba002").substr(0, 14), "2ba002" + hex_le(std::uint32_t{0x39713466}));
}

TEST(MoteusDrive, UnknownRegistersGiveErrors) {
  TestedMoteus t;
  EXPECT_EQ(t.ask("11e007").substr(0, 8), "31e00701");
  EXPECT_EQ(t.ask("01e00700"
                  "1100")
                .substr(0, 14),
            "30e00701210000");
}

TEST(MoteusDrive, IntegerFormatsScaleBothWays) {
  TestedMoteus t;
  t.tell("01000a0720008000009600022300000525c80005273200012b00");
  t.run_to(10 * kMs);
  EXPECT_DOUBLE_EQ(t.drive.torque_Nm(), 1.5);
  EXPECT_DOUBLE_EQ(t.drive.command().max_torque_Nm, 2);
  EXPECT_DOUBLE_EQ(t.drive.command().timeout_s, 0.05);
  t.drive.move_to(-0.75, 0.5);
  EXPECT_EQ(t.ask("140400"), "2404000a00" + hex_le(std::int16_t{-7500}) +
                                 hex_le(std::int16_t{2000}) + hex_le(std::int16_t{150}) + "50");
}

TEST(MoteusDrive, OfAnUnfinishedFrameWhatCameBeforeCounts) {
  TestedMoteus t;
  t.arm(0.5F);
  t.tell("01000060");
  EXPECT_EQ(t.drive.mode(), MoteusMode::stopped);
}

TEST(MoteusDrive, APowerCycleStops) {
  TestedMoteus t;
  t.arm(1);
  t.drive.reset(t.now_ns);
  EXPECT_EQ(t.drive.mode(), MoteusMode::stopped);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
}

TEST(MoteusDrive, NotANumberIsAFault) {
  TestedMoteus t;
  t.arm(1);
  t.tell(pure_torque(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(t.drive.mode(), MoteusMode::fault);
}

}  // namespace
}  // namespace hapticd::test::emulator
