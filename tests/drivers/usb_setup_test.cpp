// Before the loop: a Falcon's firmware, and devices that are not as the config says.
#include <gtest/gtest.h>

#include "tests/drivers/usb_configs.h"

namespace hapticd::test {
namespace {

using control::Mode;

/// A Falcon that has lost its firmware, and what is wrong with it.
std::unique_ptr<UsbRig> empty_falcon(
    const std::function<void(sim::usb::FalconBoardOptions&)>& wrong,
    const std::string& falcon = "{firmware: " + firmware_file() + "}") {
  auto options = falcon_electronics(false);
  wrong(options.board);
  return usb_rig(falcon_text(falcon), std::make_unique<sim::usb::Falcon>(options));
}
sim::usb::FalconBoard& board_of(UsbRig& rig) {
  return static_cast<sim::usb::Falcon&>(rig.wire().device()).board();
}

TEST(FalconSetUp, LoadsItsFirmwareAndRuns) {
  auto rig = empty_falcon([](auto&) {});
  const auto info = rig->connect();
  ASSERT_TRUE(info) << info.error().text;
  EXPECT_EQ(info->serial, "FALCON01");
  EXPECT_TRUE(board_of(*rig).firmware_runs());
  rig->input.enable = true;
  EXPECT_TRUE(rig->until([&] { return rig->enabled(); })) << rig->fault_text();
}

TEST(FalconSetUp, FirmwareThatIsThereIsNotLoadedAgain) {
  auto options = falcon_electronics(true);
  options.board.firmware = sim::usb::made_up_firmware(2000);  // another one than the file's
  auto rig = usb_rig(falcon_text("{firmware: " + firmware_file() + "}"),
                     std::make_unique<sim::usb::Falcon>(options));
  const auto info = rig->connect();
  ASSERT_TRUE(info) << info.error().text;
}

TEST(FalconSetUp, BadEchoesDeathsAndDeafnessAreTriedAgain) {
  const std::vector<std::function<void(sim::usb::FalconBoardOptions&)>> troubles = {
      [](auto& board) { board.deaf_greetings = 3; },
      [](auto& board) { board.leading_zero = true; },
      [](auto& board) {
        board.wrong_echo_chunk = 0;
        board.wrong_echo_times = 2;
      },
      [](auto& board) {
        board.wrong_echo_chunk = 127;
        board.wrong_echo_times = 1;
      },
      [](auto& board) {
        board.dies_at = 0.5;
        board.deaths = 2;
      },
      [](auto& board) {
        board.dies_at = 0.999;
        board.deaths = 1;
      }};
  for (std::size_t i = 0; i < troubles.size(); ++i) {
    auto rig = empty_falcon(troubles[i]);
    const auto info = rig->connect();
    EXPECT_TRUE(info) << i << ": " << info.error().text;
  }
}

TEST(FalconSetUp, WhatCannotBeLoadedIsRefusedWithTheReason) {
  const auto refusal = [](UsbRig& rig) {
    const auto info = rig.connect();
    return info ? std::string("connected") : info.error().text;
  };
  auto rig = empty_falcon([](auto&) {}, "{}");
  EXPECT_NE(refusal(*rig).find("give falcon.firmware"), std::string::npos) << refusal(*rig);
  const std::string twice = "{firmware: " + firmware_file() + ", upload_tries: 2}";
  rig = empty_falcon(
      [](auto& board) {
        board.wrong_echo_chunk = 5;
        board.wrong_echo_times = 1000;
      },
      twice);
  EXPECT_NE(refusal(*rig).find("does not send back"), std::string::npos) << refusal(*rig);
  rig = empty_falcon([](auto& board) { board.deaf_greetings = 100000; }, twice);
  EXPECT_NE(refusal(*rig).find("mains adaptor"), std::string::npos) << refusal(*rig);
  rig = empty_falcon([](auto&) {}, "{firmware: /nowhere.bin}");
  EXPECT_NE(refusal(*rig).find("/nowhere.bin: No such file"), std::string::npos) << refusal(*rig);
  // The file is another one.
  rig = empty_falcon([](auto& board) { board.firmware[100] ^= 1; }, twice);
  EXPECT_NE(refusal(*rig).find("does not answer after the upload"), std::string::npos)
      << refusal(*rig);
}

TEST(FalconSetUp, NoForceBeforeTheUserHasHomedIt) {
  auto options = falcon_electronics();
  options.board.home_after_s = -1;
  auto rig = usb_rig(falcon_text(), std::make_unique<sim::usb::Falcon>(options));
  ASSERT_TRUE(rig->connect());
  rig->input.enable = true;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_NE(rig->tick().mode, Mode::enabled);
    ASSERT_EQ(rig->torque(), 0);
  }
  EXPECT_TRUE(board_of(*rig).last_command().homing) << "it searches its zeros";
  ASSERT_TRUE(board_of(*rig).home(7));
  EXPECT_TRUE(rig->until([&] { return rig->enabled(); })) << rig->fault_text();
  rig->ticks(5);
  EXPECT_FALSE(board_of(*rig).last_command().homing);
}

TEST(FalconSetUp, ButtonsAreDigitalInputs) {
  auto rig = usb_rig(falcon_text(), std::make_unique<sim::usb::Falcon>(falcon_electronics()));
  ASSERT_TRUE(rig->connect());
  rig->ticks(20);
  board_of(*rig).set_grip(5);
  rig->ticks(10);
  EXPECT_EQ(rig->cycle().aux()[0].digital, 5u);
}

TEST(FalconSetUp, RoundTripIsMeasuredAndHeldAgainstTheConfig) {
  auto rig = usb_rig(falcon_text(), std::make_unique<sim::usb::Falcon>(falcon_electronics()));
  ASSERT_TRUE(rig->connect());
  const auto& traffic = *rig->device().traffic();
  EXPECT_GT(traffic.round_trip_ns.load(), 1'000'000) << "two frames at least";
  EXPECT_LT(traffic.round_trip_ns.load(), 5'000'000);
  std::string text = falcon_text();
  const std::string ages = kFalconUsb;
  text.replace(text.find(ages), ages.size(),
               "{arrival_age_s: 0.0001, max_age_s: 0.003, send_s: 0.0005}");
  rig = usb_rig(text, std::make_unique<sim::usb::Falcon>(falcon_electronics()));
  const auto info = rig->connect();
  ASSERT_FALSE(info);
  EXPECT_NE(info.error().text.find("raise these, and latency_s"), std::string::npos)
      << info.error().text;
}

TEST(ReportSetUp, BoardWithOtherReportsIsRefused) {
  const auto refusal = [](const std::function<void(sim::usb::ReportBoardOptions&)>& other) {
    auto options = report_electronics();
    other(options);
    auto rig = usb_rig(report_text(), std::make_unique<sim::usb::ReportBoard>(options));
    const auto info = rig->connect();
    return info ? std::string("connected") : info.error().text;
  };
  EXPECT_EQ(refusal([](auto&) {}), "connected");
  std::string text = refusal([](auto& board) { board.interfaces[0].in_bytes = 16; });
  EXPECT_NE(text.find("report.in describes a report without id of 8 bytes"), std::string::npos)
      << text;
  text = refusal([](auto& board) { board.interfaces[0].out_bytes = 4; });
  EXPECT_NE(text.find("report.out describes a report without id of 8 bytes"), std::string::npos)
      << text;
  text = refusal([](auto& board) { board.interfaces[0].in_id = 3; });
  EXPECT_NE(text.find("its reports have ids"), std::string::npos) << text;
  text = refusal([](auto& board) { board.interval = 8; });
  EXPECT_NE(text.find("it reports every 8.0 ms"), std::string::npos) << text;
}

TEST(ReportSetUp, SequenceThatBeginsAnewIsANewConnection) {
  auto rig = usb_rig(report_text(), std::make_unique<sim::usb::ReportBoard>(report_electronics()));
  ASSERT_TRUE(rig->connect());
  rig->input.enable = true;
  ASSERT_TRUE(rig->until([&] { return rig->enabled(); }));
  rig->ticks(300);
  rig->wire().device().replug(true, rig->now_ns());  // its processor restarted, the plug stayed
  rig->ticks(6);
  EXPECT_TRUE(rig->faulted());
  EXPECT_EQ(rig->torque(), 0);
}

TEST(ReportSetUp, LoopThatHangsLeavesNoForceHoweverSeldomTheBoardIsTold) {
  auto rig =
      usb_rig(report_text("\n        every_s: 0.9"), std::make_unique<sim::usb::ReportBoard>([] {
                auto options = report_electronics();
                options.watchdog_s = 0;
                return options;
              }()));
  ASSERT_TRUE(rig->connect());
  rig->input.enable = true;
  ASSERT_TRUE(rig->until([&] { return rig->enabled(); }));
  rig->ticks(500);
  ASSERT_GT(rig->torque(), 0);
  rig->stand_still(25'000'000);
  EXPECT_EQ(rig->torque(), 0) << "usb.watchdog_s is 20 ms";
}

}  // namespace
}  // namespace hapticd::test
