// ODrive: what it does.
#include "sim/can/odrive_drive.h"

#include <gtest/gtest.h>

#include "tests/unit/emulators/host_end.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;

struct TestedOdrive {
  OdriveDrive drive;
  std::int64_t now_ns = 0;
  explicit TestedOdrive(const OdriveOptions& options = quiet()) : drive(options, 0) {}

  // No cyclic messages, node 1.
  static OdriveOptions quiet() {
    OdriveOptions options;
    options.node = 1;
    options.estimates_every_s = options.heartbeat_every_s = 0;
    return options;
  }
  void tell(unsigned command, const std::string& hex, unsigned node = 1) {
    drive.receive(data_frame(node << 5 | command, hex), now_ns);
  }
  void torque(float torque_Nm) { tell(0x0e, hex_le(torque_Nm)); }
  void state(std::uint32_t state) { tell(0x07, hex_le(state)); }
  void arm() {
    tell(0x0b, "0100000001000000");
    state(8);
  }
  void run_to(std::int64_t at_ns) {
    now_ns = at_ns;
    drive.advance(now_ns);
  }
  std::string ask(unsigned command, unsigned node = 1) {
    drive.take_sent();
    drive.receive(classic_frame((node << 5 | command) | CAN_RTR_FLAG, 8), now_ns);
    const auto sent = drive.take_sent();
    if (sent.size() != 1) return "";
    EXPECT_EQ(sent[0].at_ns, now_ns + 50 * kUs);
    EXPECT_EQ(sent[0].frame.can_id, drive.node() * 32U + command);
    return hex_of(sent[0].frame);
  }
};

TEST(OdriveDrive, FollowsTorqueOnlyInClosedLoopAndTorqueModeWithPassthrough) {
  TestedOdrive t;
  t.torque(0.5F);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.state(8);  // still in position mode
  EXPECT_EQ(t.drive.state(), 8);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.tell(0x0b, "0100000006000000");  // torque ramp
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.tell(0x0b, "0100000001000000");
  EXPECT_TRUE(t.drive.enabled());
  EXPECT_EQ(t.drive.torque_Nm(), 0.5);
  t.torque(-0.25F);
  EXPECT_EQ(t.drive.torque_Nm(), -0.25);
  t.torque(100);
  EXPECT_EQ(t.drive.torque_Nm(), 10);
  t.state(1);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
}

TEST(OdriveDrive, TakesBothLengthsOfStateAndTorque) {
  TestedOdrive t;
  t.arm();
  t.tell(0x0e, hex_le(1.0F) + "00000000");
  EXPECT_EQ(t.drive.torque_Nm(), 1);
  t.tell(0x07, "0100000000000000");
  EXPECT_EQ(t.drive.state(), 1);
  t.tell(0x07, "08000000");
  EXPECT_EQ(t.drive.state(), 8);
}

TEST(OdriveDrive, HearsOnlyItsOwnNode) {
  TestedOdrive t;
  t.arm();
  t.tell(0x0e, hex_le(1.0F), 2);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.drive.receive(
      frame_of({{"can_id", 1U << 5 | 0x0eU}, {"data", hex_le(1.0F)}, {"extended", true}}), 0);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
}

TEST(OdriveDrive, TheWatchdogDisarmsExactlyItsTimeAfterTheLastTorque) {
  TestedOdrive t;
  t.run_to(500 * kMs);  // idle: it does not count
  EXPECT_EQ(t.drive.errors(), 0U);
  t.arm();
  EXPECT_EQ(t.drive.next_ns(), 520 * kMs);
  t.run_to(510 * kMs);
  t.torque(1);
  t.run_to(530 * kMs - 1);
  EXPECT_EQ(t.drive.torque_Nm(), 1);
  t.run_to(530 * kMs);
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  EXPECT_FALSE(t.drive.enabled());
  EXPECT_EQ(t.drive.state(), 1);
  EXPECT_EQ(t.ask(0x03), "0000000100000001");
}

TEST(OdriveDrive, NothingButInputsFeedsTheWatchdog) {
  TestedOdrive t;
  t.arm();
  for (int ms = 5; ms <= 25; ms += 5) {
    t.run_to(ms * kMs);
    t.ask(0x09);
    t.tell(0x0f, hex_le(1.0F) + hex_le(1.0F));
    t.state(8);
  }
  EXPECT_EQ(t.drive.errors(), OdriveDrive::kWatchdogExpired);
}

TEST(OdriveDrive, ADisabledWatchdogNeverExpires) {
  OdriveOptions options = TestedOdrive::quiet();
  options.watchdog_enabled = false;
  TestedOdrive t(options);
  t.arm();
  t.run_to(10'000 * kMs);
  EXPECT_TRUE(t.drive.enabled());
}

TEST(OdriveDrive, ErrorsKeepItOutOfClosedLoopUntilCleared) {
  TestedOdrive t;
  t.arm();
  t.run_to(20 * kMs);
  ASSERT_EQ(t.drive.state(), 1);
  t.state(8);
  EXPECT_EQ(t.drive.state(), 1);
  t.tell(0x18, "00");
  EXPECT_EQ(t.drive.errors(), 0U);
  t.state(8);
  EXPECT_EQ(t.drive.state(), 8);
  EXPECT_EQ(t.drive.next_ns(), 40 * kMs);
}

TEST(OdriveDrive, AnOldTorqueStaysOverADisarm) {
  TestedOdrive t;
  t.arm();
  t.torque(1);
  t.state(1);
  t.state(8);
  EXPECT_EQ(t.drive.torque_Nm(), 1);
}

TEST(OdriveDrive, EstopFaultsAndNotANumberDisarm) {
  TestedOdrive t;
  t.arm();
  t.tell(0x02, "");
  EXPECT_EQ(t.drive.errors(), OdriveDrive::kEstopRequested);
  t.tell(0x18, "00");
  t.arm();
  t.torque(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(t.drive.errors(), OdriveDrive::kMissingInput);
  t.tell(0x18, "00");
  t.arm();
  t.drive.fail(1 << 9, 0);
  EXPECT_FALSE(t.drive.enabled());
  EXPECT_EQ(t.ask(0x03), "0002000000020000");
}

TEST(OdriveDrive, EstimatesAreZeroUntilTheFirstClosedLoopThenCounts) {
  TestedOdrive t;
  t.drive.move_to(1.00003, -0.5);
  EXPECT_EQ(t.ask(0x09), "0000000000000000");
  t.state(8);
  EXPECT_EQ(t.ask(0x09), hex_le(1.0F) + hex_le(-0.5F));
  t.drive.move_to(-1e-6, 0);
  EXPECT_EQ(t.ask(0x09), hex_le(-1.0F / 16384) + hex_le(0.0F));
  t.state(1);
  EXPECT_EQ(t.ask(0x09), hex_le(-1.0F / 16384) + hex_le(0.0F));
}

TEST(OdriveDrive, AnswersRemoteRequests) {
  TestedOdrive t;
  t.arm();
  t.torque(0.5F);
  EXPECT_EQ(t.ask(0x00).substr(0, 2), "02");
  EXPECT_EQ(t.ask(0x00).substr(8, 6), "00060b");
  EXPECT_EQ(t.ask(0x1c), hex_le(0.5F) + hex_le(0.5F));
  EXPECT_EQ(t.ask(0x14), hex_le(5.0F) + hex_le(5.0F));
  EXPECT_EQ(t.ask(0x15).size(), 16U);
  EXPECT_EQ(t.ask(0x17).substr(0, 8), hex_le(24.0F));
  EXPECT_EQ(t.ask(0x09, 2), "");
  EXPECT_EQ(t.ask(0x1e), "");
}

TEST(OdriveDrive, TheBroadcastFindsItAndSetsItsNode) {
  TestedOdrive t;
  const std::string address = t.ask(0x06, 63);
  EXPECT_EQ(address.substr(0, 2), "01");
  t.tell(0x06, "05" + std::string("ffffffffffff"), 63);
  EXPECT_EQ(t.drive.node(), 1);
  t.tell(0x06, "05" + address.substr(2, 12), 63);
  EXPECT_EQ(t.drive.node(), 5);
}

std::vector<std::int64_t> times_of(OdriveDrive& drive, unsigned command) {
  std::vector<std::int64_t> times;
  for (const auto& sent : drive.take_sent())
    if ((sent.frame.can_id & 0x1f) == command) times.push_back(sent.at_ns);
  return times;
}

TEST(OdriveDrive, CyclicMessagesComeOnItsOwnClock) {
  OdriveOptions options;
  options.clock_drift = 0.01;
  options.start_phase_s = 0.0003;
  OdriveDrive drive(options, 1000 * kMs);
  drive.advance(2000 * kMs);
  const auto times = times_of(drive, 0x09);
  ASSERT_EQ(times.size(), 1010U);
  EXPECT_EQ(times[0], 1000 * kMs + 297030);
  EXPECT_EQ(times[1000], 1000 * kMs + 990396040);  // 1.0003 s of its own, without adding up
  drive.reset(2000 * kMs);
  drive.advance(2999 * kMs);
  EXPECT_EQ(times_of(drive, 0x01).size(), 11U);
}

TEST(OdriveDrive, HeartbeatsTellStateAndErrors) {
  OdriveOptions options = TestedOdrive::quiet();
  options.heartbeat_every_s = 0.1;
  options.watchdog_s = 0.01;
  TestedOdrive t(options);
  t.run_to(50 * kMs);
  t.arm();
  EXPECT_EQ(hex_of(sent_by(t.drive).at(0)), "0000000001000000");
  t.torque(0);
  t.run_to(59 * kMs);
  EXPECT_TRUE(sent_by(t.drive).empty());
  t.run_to(100 * kMs);
  EXPECT_EQ(hex_of(sent_by(t.drive).at(0)), "0000000101030000");
}

TEST(OdriveDrive, HeartbeatsOnChangeIfAsked) {
  OdriveOptions options = TestedOdrive::quiet();
  options.heartbeat_on_change = true;
  TestedOdrive t(options);
  t.arm();
  EXPECT_EQ(hex_of(sent_by(t.drive).at(0)), "0000000008000000");
  t.run_to(20 * kMs);
  const auto sent = t.drive.take_sent();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].at_ns, 20 * kMs);
  EXPECT_EQ(hex_of(sent[0].frame), "0000000101030000");
}

TEST(OdriveDrive, APowerCycleForgetsAll) {
  TestedOdrive t;
  t.arm();
  t.torque(1);
  t.drive.reset(kMs);
  EXPECT_FALSE(t.drive.enabled());
  EXPECT_EQ(t.drive.mode().control, 3U);
  t.arm();
  EXPECT_EQ(t.drive.torque_Nm(), 0);
  t.tell(0x16, "00");
  EXPECT_EQ(t.drive.state(), 1);
}

}  // namespace
}  // namespace hapticd::test::emulator
