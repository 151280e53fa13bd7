// The emulated OpenFFBoard: settings, what its axes do by themselves, what it sends when.
#include <gtest/gtest.h>

#include "tests/unit/emulators/usb_openffboard_host.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::usb;

TEST(Openffboard, TheDescriptorHasItsReportsInTheirSizes) {
  for (const std::size_t axes : {1u, 2u}) {
    Openffboard board(plain_board(axes));
    const auto bits = usb_report_bits(board.report_descriptor(Openffboard::kHid));
    const std::map<std::pair<int, int>, std::size_t> wanted{{{0x80, 0x01}, 24 * 8},
                                                            {{0x80, 0xa1}, 24 * 8},
                                                            {{0x90, 0xa1}, 24 * 8},
                                                            {{0x80, 0x02}, 8},
                                                            {{0x90, 0x01}, (13 + 4 * axes) * 8},
                                                            {{0x90, 0x05}, 24},
                                                            {{0x90, 0x0a}, 24},
                                                            {{0x90, 0x0b}, 8},
                                                            {{0x90, 0x0c}, 8},
                                                            {{0x90, 0x0d}, 8},
                                                            {{0xb0, 0x11}, 24},
                                                            {{0xb0, 0x12}, 32},
                                                            {{0xb0, 0x13}, 32}};
    EXPECT_EQ(bits, wanted);
    EXPECT_TRUE(board.report_descriptor(0).empty());
  }
}

TEST(Openffboard, AWriteIsAnsweredAsARead) {
  Openffboard board(plain_board());
  BoardHost host(board);
  host.tell(
      {.type = CommandType::write, .class_id = kAxis, .instance = 1, .command = 0, .data = 70001});
  const auto reply = host.answer();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->type, CommandType::read);
  EXPECT_EQ(reply->instance, 1);
  EXPECT_EQ(reply->data, 70001);  // as asked, though 16 bits were kept
  EXPECT_EQ(host.setting(0, kAxis, 1), 70001 - 65536);
  EXPECT_EQ(host.setting(0, kAxis, 0), 32767);
}

TEST(Openffboard, WhatIsNotThereIsNotFound) {
  Openffboard board(plain_board());
  BoardHost host(board);
  host.tell({.type = CommandType::read, .class_id = 0xa03, .command = 4, .data = 5, .address = 6});
  auto reply = host.answer();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->type, CommandType::not_found);
  EXPECT_EQ(reply->data, 5);
  host.tell({.type = CommandType::read, .class_id = kAxis, .instance = 2});
  reply = host.answer();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->type, CommandType::not_found);
  host.tell({.type = CommandType::write, .class_id = kAxis, .command = 0x15, .data = 5});
  reply = host.answer();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->type, CommandType::error);  // cpr cannot be written
}

TEST(Openffboard, ThePadComesWhenItChangesElseEachTenthOfASecond) {
  Openffboard board(plain_board());
  BoardHost host(board);
  for (int i = 0; i < 200; ++i) host.in(Openffboard::kIn);
  host.run_for(1.05);
  EXPECT_EQ(host.all.size(), 10u);
  host.all.clear();
  for (int i = 1; i <= 50; ++i) {
    board.motor(0).move_to(10 * i, 0);
    host.run_for(1e-3);
  }
  EXPECT_NEAR(static_cast<double>(host.all.size()), 50, 1);
  for (const auto& done : host.all) EXPECT_EQ(done.bytes.size(), kOpenffboardPadBytes);
}

TEST(Openffboard, RepliesCompeteWithThePad) {
  Openffboard board(plain_board());
  BoardHost host(board);
  std::size_t replies = 0, pads = 0;
  for (int i = 0; i < 3; ++i) host.in(Openffboard::kIn);
  for (int i = 1; i <= 300; ++i) {
    board.motor(0).move_to(10 * i, 0);
    host.out(Openffboard::kOut,
             openffboard_command({.type = CommandType::read, .class_id = kAxis}));
    host.run_for(1e-3);
    for (const auto& done : host.all) {
      if (done.bytes.empty()) continue;
      (done.bytes[0] == 0xa1 ? replies : pads) += 1;
      host.in(Openffboard::kIn);
    }
    host.all.clear();
  }
  EXPECT_NEAR(static_cast<double>(replies), 200, 3);
  EXPECT_NEAR(static_cast<double>(pads), 100, 3);
}

TEST(Openffboard, CountsAreOfTheRangeItHadAtPowerUp) {
  OpenffboardOptions options = plain_board(1);
  options.axis.cpr = 1 << 24;
  Openffboard board(options);
  BoardHost host(board);
  const auto pad_at = [&](double counts) {
    board.motor(0).move_to(counts, 0);
    host.run_for(5e-3);
    (void)host.read(Openffboard::kIn, 0.2);
    return board.axis(0).pad();
  };
  EXPECT_EQ(pad_at(1000.7), 1000);
  EXPECT_EQ(pad_at(-1000.5), -1001);
  EXPECT_EQ(pad_at(40000), 32767);
  EXPECT_EQ(pad_at(1000.7), 1000);
  host.tell({.type = CommandType::write, .class_id = kAxis, .command = 1, .data = 450});
  EXPECT_EQ(pad_at(1000.7), 2001);
  EXPECT_EQ(host.setting(9), std::llround(1000.7 / 65536 * 900 / 360 * (1 << 24)));
}

TEST(Openffboard, ItsOwnEffectsActUnlessSwitchedOff) {
  OpenffboardOptions options = plain_board(1);
  options.axis.idlespring = 127;
  Openffboard board(options);
  BoardHost host(board);
  board.motor(0).move_to(1000, 0);
  host.run_for(5e-3);
  EXPECT_NEAR(board.motor(0).torque(), -1000 * 1.77 / 32767, 1e-4);
  host.send({0x0c, 0x01});
  EXPECT_EQ(board.motor(0).torque(), 0);
  host.tell({.type = CommandType::write, .class_id = kAxis, .command = 6, .data = 30});
  for (int i = 0; i < 200; ++i) {
    board.motor(0).move_to(1000 + i, 0);  // 900 / 65536 degrees a ms
    host.run_for(1e-3);
  }
  EXPECT_NEAR(board.motor(0).torque(), -900.0 / 65.536 * 30 * 40 * 0.7 / 255 / 32767, 1e-4);
  host.tell({.type = CommandType::write, .class_id = kAxis, .command = 6, .data = 0});
  board.motor(0).move_to(33268, 0);  // 500 counts beyond the end
  host.run_for(0.1);
  EXPECT_NEAR(board.motor(0).torque(), -127 * 25 * 500.0 * 900 / 65536 / 32767, 2e-4);
}

TEST(Openffboard, FarOutOfItsRangeTheMotorStops) {
  Openffboard board(plain_board(1));
  BoardHost host(board);
  host.play(10000);
  board.motor(0).move_to(70000, 0);
  host.run_for(5e-3);
  EXPECT_FALSE(board.motor(0).enabled());
  board.motor(0).move_to(0, 0);
  host.run_for(5e-3);
  EXPECT_FALSE(board.motor(0).enabled());
  host.wire.unplug();
  host.wire.plug(false, host.now_ns);
  EXPECT_TRUE(board.motor(0).enabled());
}

TEST(Openffboard, PowerScalesAndLimits) {
  Openffboard board(plain_board(1));
  BoardHost host(board);
  host.play(32767);
  host.tell({.type = CommandType::write, .class_id = kAxis, .command = 0, .data = 3276});
  EXPECT_NEAR(board.motor(0).torque(), -0.1, 1e-4);
  host.tell({.type = CommandType::write, .class_id = kAxis, .command = 0x0c, .data = 51});
  EXPECT_NEAR(board.motor(0).torque(), -0.02, 1e-4);
}

TEST(Openffboard, UnpluggedItForgetsEffectsAndKeepsSettings) {
  Openffboard board(plain_board(1));
  BoardHost host(board);
  host.play(10000);
  host.tell({.type = CommandType::write, .class_id = kAxis, .command = 0x0c, .data = 51});
  host.wire.unplug();
  host.run_for(0.01);
  host.wire.plug(false, host.now_ns);
  host.run_for(0.01);
  EXPECT_FALSE(board.actuators_on());
  EXPECT_EQ(board.motor(0).torque(), 0);
  EXPECT_EQ(host.setting(0x0c), 51);
  host.wire.unplug();
  host.wire.plug(true, host.now_ns);
  EXPECT_EQ(host.setting(0x0c), 255);
}

TEST(Openffboard, AnOutputReportByRequestIsAcceptedAndLost) {
  Openffboard board(plain_board(1));
  BoardHost host(board);
  EXPECT_TRUE(usb_acked(host.ask({0x21, 9, 0x020c, 2, 2}, {0x0c, 0x01})));
  EXPECT_FALSE(board.actuators_on());
}

}  // namespace
}  // namespace hapticd::test::emulator
