// Drives that are not as they have to be: refused before they are armed, with words that say what to do.
#include <gtest/gtest.h>

#include <functional>

#include "drivers/can/cia402_setup.h"
#include "drivers/can/scan.h"
#include "tests/drivers/can_configs.h"
#include "tests/drivers/can_rig.h"

namespace hapticd::test {
namespace {

using control::Mode;

constexpr Bus kOdrive{"odrive", "free_running"};
constexpr Bus kMoteus{"moteus", "reply_to_command"};
constexpr Bus kCia402{"cia402", "in_phase"};

Emulation changed(const std::function<void(Emulation&)>& change) {
  Emulation emulation;
  emulation.cia402.rated_torque_Nm = 0.1;
  change(emulation);
  return emulation;
}

void expect_no_connection(const Bus& bus, const Emulation& emulation, const std::string& words) {
  CanRig rig(wall_on(bus), emulation);
  const auto info = rig.connect();
  ASSERT_FALSE(info) << words;
  EXPECT_EQ(info.error().code, ExitCode::unavailable);
  EXPECT_NE(info.error().text.find(words), std::string::npos) << info.error().text;
  EXPECT_NE(info.error().text.find("node 3 on can0"), std::string::npos) << info.error().text;
}

void expect_no_arming(CanRig& rig, const std::string& words) {
  ASSERT_TRUE(rig.connect());
  rig.input.enable = true;
  const bool faulted = rig.run_until([&] { return rig.mode() == Mode::fault; }, 3000);
  ASSERT_TRUE(faulted) << "mode " << static_cast<int>(rig.mode());
  EXPECT_NE(rig.fault_text().find(words), std::string::npos) << rig.fault_text();
  for (int i = 0; i < 100; ++i) {
    rig.tick();
    EXPECT_EQ(rig.motor_Nm(), 0);
  }
  EXPECT_FALSE(rig.drives().drive(0).enabled());
}
void expect_no_arming(const Bus& bus, const Emulation& emulation, const std::string& words) {
  CanRig rig(wall_on(bus), emulation);
  expect_no_arming(rig, words);
}

TEST(CanRefusals, NobodyAnswers) {
  for (const Bus& bus : {kOdrive, kMoteus, kCia402}) {
    CanRig rig(wall_on(bus));
    rig.drives().drive(0).mute(true);
    const auto info = rig.connect();
    ASSERT_FALSE(info);
    EXPECT_NE(info.error().text.find("node 3 on can0"), std::string::npos) << info.error().text;
    EXPECT_NE(info.error().text.find("power"), std::string::npos) << info.error().text;
  }
}

TEST(CanRefusals, OdriveOfAnotherFirmware) {
  expect_no_connection(kOdrive, changed([](Emulation& e) {
                         e.odrive.firmware = {0, 5, 6};
                       }),
                       "firmware 0.5.6, expected 0.6");
}
TEST(CanRefusals, OdriveWithoutHeartbeat) {
  expect_no_connection(kOdrive, changed([](Emulation& e) { e.odrive.heartbeat_every_s = 1; }),
                       "heartbeat_msg_rate_ms");
}
TEST(CanRefusals, OdriveWhosePositionsComeTooSeldom) {
  expect_no_connection(kOdrive, changed([](Emulation& e) { e.odrive.estimates_every_s = 0.01; }),
                       "encoder_msg_rate_ms");
}
TEST(CanRefusals, OdriveWithoutAWatchdog) {
  expect_no_arming(kOdrive, changed([](Emulation& e) { e.odrive.watchdog_enabled = false; }),
                   "enable_watchdog = True");
}
TEST(CanRefusals, OdriveWithALongerWatchdogThanStated) {
  expect_no_arming(kOdrive, changed([](Emulation& e) { e.odrive.watchdog_s = 0.035; }),
                   "did not go off by its watchdog");
}
TEST(CanRefusals, OdriveThatHasAnErrorWhichDoesNotClear) {
  CanRig rig(wall_on(kOdrive));
  ASSERT_TRUE(rig.connect());
  rig.input.enable = true;
  // It fails again each time that it is cleared.
  bool faulted = false;
  for (int i = 0; i < 2000 && !faulted; ++i) {
    rig.drives().drive(0).fail(1 << 9, rig.now_ns());
    faulted = rig.tick().mode == Mode::fault;
  }
  EXPECT_TRUE(faulted);
  EXPECT_NE(rig.fault_text().find("would not enter closed loop: DC bus under-voltage"),
            std::string::npos)
      << rig.fault_text();
}

TEST(CanRefusals, MoteusOfAnotherRegisterMap) {
  expect_no_connection(kMoteus, changed([](Emulation& e) { e.moteus.register_map_version = 4; }),
                       "register map 4, expected 5");
}
TEST(CanRefusals, MoteusOutsideOfItsPositionBounds) {
  const Emulation narrow = changed([](Emulation& e) {
    e.moteus.position_min = -0.01;
    e.moteus.position_max = 0.01;
  });
  expect_no_arming(kMoteus, narrow, "outside of the position limits");
  // Told to ignore them, it runs.
  std::string text = wall_on(kMoteus);
  text.replace(text.find("timing:"), 0, "ignore_position_bounds: true, ");
  CanRig rig(text, narrow);
  ASSERT_TRUE(rig.connect());
  EXPECT_TRUE(rig.enable()) << rig.fault_text();
}

TEST(CanRefusals, Cia402WithoutATorqueMode) {
  expect_no_connection(kCia402, changed([](Emulation& e) { e.cia402.supports_cst = false; }),
                       "no cyclic synchronous torque");
}
TEST(CanRefusals, Cia402ThatGivesLessThanItsActuatorIsToGive) {
  expect_no_connection(kCia402, changed([](Emulation& e) { e.cia402.max_torque_Nm = 0.004; }),
                       "limits its torque");
}
TEST(CanRefusals, ACanopenDeviceThatIsNoDrive) {
  expect_no_connection(kCia402, changed([](Emulation& e) { e.cia402.device_type = 0x00010191; }),
                       "profile 401, expected 402");
}
TEST(CanRefusals, Cia402ThatCountsOtherwise) {
  CanRig rig(wall_on(kCia402), changed([](Emulation& e) { e.cia402_counts_factor = 4; }));
  const auto info = rig.connect();
  ASSERT_FALSE(info);
  EXPECT_NE(info.error().text.find("torque would be wrong by that factor"), std::string::npos)
      << info.error().text;
}

/// Arming begins with "off": a torque that was queued before meets a drive that does not follow it.
TEST(CanRefusals, NothingMovesWhileADriveIsArmed) {
  for (const Bus& bus : kBuses) {
    CanRig rig(wall_on(bus), changed([](Emulation&) {}));
    ASSERT_TRUE(rig.connect());
    rig.input.enable = true;
    while (rig.mode() != Mode::enabled) {
      ASSERT_EQ(rig.motor_Nm(), 0);
      ASSERT_NE(rig.tick().mode, Mode::fault) << rig.fault_text();
    }
  }
}

// -- who is on a bus

class VirtualConversation final : public can::Conversation {
 public:
  explicit VirtualConversation(CanRig& rig) : rig_(rig), inner_(rig.socket(), rig.host()) {}
  void send(const can::Frame& frame) override {
    sent.push_back(frame);
    inner_.send(frame);
  }
  std::optional<can::Frame> next(double timeout_s) override { return inner_.next(timeout_s); }
  std::int64_t now_ns() override { return rig_.host().now_ns(); }

  std::vector<can::Frame> sent;

 private:
  CanRig& rig_;
  can::SocketConversation inner_;
};

/// Whoever drove it before may have left it running: before anything else it is switched off, its torque taken back, and
/// only then it becomes operational.
TEST(CanSetUp, ACia402DriveIsSwitchedOffFirst) {
  CanRig rig(wall_on(kCia402), changed([](Emulation&) {}));
  VirtualConversation conversation(rig);
  ASSERT_TRUE(can::cia402::set_up(conversation, {.node = 3, .place = "node 3 on can0"}));
  const auto written = [&](std::uint16_t index) {  // 2B: two bytes
    const auto is = [&](const can::Frame& frame) {
      return frame.id == 0x603 && frame.data[0] == 0x2b &&
             can::get<std::uint16_t>(frame.payload(), 1) == index;
    };
    return std::ranges::find_if(conversation.sent, is);
  };
  const auto started = std::ranges::find_if(conversation.sent, [](const can::Frame& frame) {
    return frame.id == 0 && frame.data[0] == 0x01;
  });
  for (const std::uint16_t index : {std::uint16_t{0x6040}, std::uint16_t{0x6071}}) {
    const auto at = written(index);
    ASSERT_LT(at - conversation.sent.begin(), started - conversation.sent.begin()) << index;
    EXPECT_EQ(can::get<std::uint16_t>(at->payload(), 4), 0) << index;
  }
}

std::vector<can::FoundDrive> scan_of(const Bus& bus, const Emulation& emulation,
                                     const can::ScanOptions& options) {
  CanRig rig(wall_on(bus), emulation);
  VirtualConversation conversation(rig);
  return can::scan(conversation, options);
}

TEST(CanScan, FindsAnODriveByItsHeartbeat) {
  const auto found = scan_of(kOdrive, {}, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].node, 3);
  EXPECT_EQ(found[0].what, "ODrive, firmware 0.6.11");
  EXPECT_EQ(found[0].refused, "");
}

TEST(CanScan, SaysWhyADriveCannotBeUsed) {
  const auto old = scan_of(kOdrive, changed([](Emulation& e) {
                             e.odrive.firmware = {0, 5, 6};
                           }),
                           {});
  ASSERT_EQ(old.size(), 1U);
  EXPECT_NE(old[0].refused.find("not 0.6"), std::string::npos);
  const auto other = scan_of(kCia402, changed([](Emulation& e) { e.cia402.device_type = 0x191; }),
                             {.ask = {can::Protocol::cia402}});
  ASSERT_EQ(other.size(), 1U);
  EXPECT_EQ(other[0].what, "CANopen device of profile 401");
  EXPECT_NE(other[0].refused.find("402"), std::string::npos);
}

TEST(CanScan, ASilentDriveIsFoundWhenItIsAskedFor) {
  EXPECT_TRUE(scan_of(kMoteus, {}, {}).empty());
  const auto found = scan_of(kMoteus, {}, {.ask = {can::Protocol::moteus}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].node, 3);
  const auto drive = scan_of(kCia402, {}, {.ask = {can::Protocol::cia402}});
  ASSERT_EQ(drive.size(), 1U);
  EXPECT_EQ(drive[0].refused, "");
}

TEST(CanScan, WhereNothingMayBeAskedNothingIsSent) {
  CanRig rig(wall_on(kOdrive));
  VirtualConversation conversation(rig);
  const auto found = can::scan(conversation, {.ask = {can::Protocol::odrive}, .questions = false});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].what, "odrive by its heartbeat");
  EXPECT_EQ(rig.drives().bus("can0").received(), 0U);
}

}  // namespace
}  // namespace hapticd::test
