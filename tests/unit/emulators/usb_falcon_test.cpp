// The emulated Falcon while its firmware runs, and its bridge.
#include <gtest/gtest.h>

#include "sim/emulated_device.h"
#include "tests/unit/emulators/usb_falcon_host.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::usb;

TEST(Falcon, TorqueIsAsCommandedAndStaysForEver) {
  Falcon falcon(loaded_falcon());
  FalconHost host(falcon);
  host.to_run_speed();
  EXPECT_FALSE(falcon.motor(0).enabled());
  ASSERT_TRUE(host.exchange(command_bytes({1000, -2000, 32767})));
  EXPECT_DOUBLE_EQ(falcon.motor(0).torque(), -0.1);
  EXPECT_DOUBLE_EQ(falcon.motor(1).torque(), 0.2);
  EXPECT_DOUBLE_EQ(falcon.motor(2).torque(), -3.2767);
  host.run_for(60);
  EXPECT_DOUBLE_EQ(falcon.motor(0).torque(), -0.1);
}

TEST(Falcon, MotorsGoOffAfterSilenceIfSoWished) {
  FalconOptions options = loaded_falcon();
  options.board.silence_s = 0.1;
  Falcon falcon(options);
  FalconHost host(falcon);
  host.to_run_speed();
  ASSERT_TRUE(host.exchange(command_bytes({1000, 0, 0})));
  host.run_for(0.09);
  EXPECT_TRUE(falcon.motor(0).enabled());
  host.run_for(0.02);
  EXPECT_FALSE(falcon.motor(0).enabled());
  EXPECT_EQ(falcon.motor(0).torque(), 0);
  ASSERT_TRUE(host.exchange(command_bytes({1000, 0, 0})));
  EXPECT_TRUE(falcon.motor(0).enabled());
}

TEST(Falcon, ALinkThatWentStaleNeedsPurgeAndBaudRate) {
  FalconOptions options = loaded_falcon();
  options.board.stale_s = 0.5;
  Falcon falcon(options);
  FalconHost host(falcon);
  host.to_run_speed();
  ASSERT_TRUE(host.exchange(command_bytes({1000, 0, 0})));
  host.run_for(0.6);
  EXPECT_TRUE(falcon.board().stale());
  EXPECT_FALSE(host.exchange(command_bytes({0, 0, 0})));
  EXPECT_DOUBLE_EQ(falcon.motor(0).torque(), -0.1);
  host.set(0, 1);
  EXPECT_FALSE(host.exchange(command_bytes({0, 0, 0})));
  host.to_run_speed();
  EXPECT_TRUE(host.exchange(command_bytes({0, 0, 0})));
}

TEST(Falcon, CountsStartAtPowerUpUntilItIsHomed) {
  Falcon falcon(loaded_falcon());
  FalconHost host(falcon);
  host.to_run_speed();
  for (std::size_t i = 0; i < 3; ++i) falcon.motor(i).move_to(500, 0);
  falcon.motor(1).move_to(523.4, 0);
  EXPECT_FALSE(falcon.board().home(7));  // it was not told to
  auto reply = host.exchange(command_bytes({0, 0, 0}, true));
  ASSERT_TRUE(reply);
  EXPECT_EQ(encoders_of(*reply), (std::array<std::int16_t, 3>{0, 23, 0}));
  EXPECT_TRUE(falcon.board().home(2));
  falcon.board().set_grip(4);
  reply = host.exchange(command_bytes({0, 0, 0}));
  ASSERT_TRUE(reply);
  EXPECT_EQ(encoders_of(*reply), (std::array<std::int16_t, 3>{0, 523, 0}));
  EXPECT_EQ(reply->at(13), 'A' + 0x20 + 4);
  falcon.motor(1).move_to(40000, 0);
  reply = host.exchange(command_bytes({0, 0, 0}));
  ASSERT_TRUE(reply);
  EXPECT_EQ(encoders_of(*reply)[1], 40000 - 65536);
}

TEST(Falcon, HomesItselfWhileTheBitIsSet) {
  FalconOptions options = loaded_falcon();
  options.board.home_after_s = 0.1;
  Falcon falcon(options);
  FalconHost host(falcon);
  host.to_run_speed();
  for (int i = 0; i < 10; ++i)
    ASSERT_TRUE(host.exchange(command_bytes({0, 0, 0}, i % 2 == 0), 0.02));
  EXPECT_EQ(falcon.board().homed(), 0);
  ASSERT_TRUE(host.exchange(command_bytes({0, 0, 0}, true)));
  host.run_for(0.09);
  EXPECT_EQ(falcon.board().homed(), 0);
  host.run_for(0.01);
  EXPECT_EQ(falcon.board().homed(), 7);
}

TEST(Falcon, FrozenEncodersDoNotMoveNorHome) {
  FalconOptions options = loaded_falcon();
  options.board.frozen_encoders = true;
  Falcon falcon(options);
  FalconHost host(falcon);
  host.to_run_speed();
  falcon.motor(0).move_to(100, 0);
  falcon.motor(0).move_to(300, 0);
  ASSERT_TRUE(host.exchange(command_bytes({0, 0, 0}, true)));
  EXPECT_TRUE(falcon.board().home(7));
  const auto reply = host.exchange(command_bytes({0, 0, 0}, true));
  ASSERT_TRUE(reply);
  EXPECT_EQ(encoders_of(*reply)[0], 0);
  EXPECT_EQ(reply->at(13), 'A');
}

TEST(Falcon, ThePowerDecidesWhetherTheFirmwareSurvivesUnplugging) {
  Falcon falcon(loaded_falcon());
  FalconHost host(falcon);
  host.to_run_speed();
  ASSERT_TRUE(host.exchange(command_bytes({1000, 0, 0})));
  host.wire.unplug();
  host.run_for(0.1);
  EXPECT_DOUBLE_EQ(falcon.motor(0).torque(), -0.1);
  host.wire.plug(false, host.now_ns);
  host.to_run_speed();
  EXPECT_TRUE(host.exchange(command_bytes({0, 0, 0})));

  FalconOptions empty;
  empty.board.firmware = made_up_firmware(62);
  Falcon other(empty);
  FalconHost again(other);
  again.wake();
  ASSERT_TRUE(again.greeted());
  again.start_loader();
  EXPECT_EQ(again.upload(empty.board.firmware), 1u);
  EXPECT_TRUE(other.board().firmware_runs());
  again.wire.unplug();
  again.wire.plug(true, again.now_ns);
  EXPECT_FALSE(other.board().firmware_runs());
  EXPECT_FALSE(other.motor(0).enabled());
}

TEST(FtdiBridge, AShortReplyWaitsForTheLatencyTimer) {
  FalconOptions options = loaded_falcon();
  options.bridge.idle_packets = false;
  Falcon falcon(options);
  FalconHost host(falcon);
  host.to_run_speed();
  host.set(9, 5);
  host.run_for(0.1);
  ASSERT_TRUE(host.exchange(command_bytes({0, 0, 0})));
  const std::int64_t last_ns = host.all.back().at_ns;
  const auto id = host.in(Falcon::kIn);
  host.out(Falcon::kOut, command_bytes({0, 0, 0}));
  host.run_for(0.02);
  ASSERT_NE(host.done(id), nullptr);
  EXPECT_GE(host.done(id)->at_ns, last_ns + 5'000'000);
}

TEST(FtdiBridge, TheEventCharacterDoesNotWait) {
  for (const bool acts : {true, false}) {
    FalconOptions options = loaded_falcon();
    options.bridge.acts_on_event_char = acts;
    Falcon falcon(options);
    FalconHost host(falcon);
    host.to_run_speed();
    host.set(9, 16);
    host.set(6, 0x0100 | '>');
    ASSERT_TRUE(host.read(Falcon::kIn));  // restarts the timer
    const std::int64_t from_ns = host.now_ns;
    host.out(Falcon::kOut, command_bytes({0, 0, 0}));
    const auto reply = host.read(Falcon::kIn);
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->size(), 18u);
    EXPECT_EQ(host.all.back().at_ns - from_ns <= 2'000'000, acts);
  }
}

TEST(FtdiBridge, IdleIsTwoBytesEachLatency) {
  Falcon falcon({});
  FalconHost host(falcon);
  host.set(9, 4);
  for (int i = 0; i < 30; ++i) host.in(Falcon::kIn);
  host.run_for(0.0401);
  EXPECT_EQ(host.all.size(), 10u);
  for (const auto& done : host.all) EXPECT_EQ(hex_of(done.bytes), "0160");

  FalconOptions silent;
  silent.bridge.idle_packets = false;
  Falcon quiet(silent);
  FalconHost other(quiet);
  other.in(Falcon::kIn);
  other.run_for(1);
  EXPECT_TRUE(other.all.empty());
}

TEST(FtdiBridge, EachPacketOfALongTransferHasItsStatus) {
  Falcon falcon(loaded_falcon());
  FalconHost host(falcon);
  host.to_run_speed();
  host.set(9, 16);
  ASSERT_TRUE(host.read(Falcon::kIn));
  const auto id = host.in(Falcon::kIn, 512);
  for (int i = 0; i < 8; ++i) host.out(Falcon::kOut, command_bytes({0, 0, 0}));
  host.run_for(0.1);
  ASSERT_NE(host.done(id), nullptr);
  const UsbBytes bytes = host.done(id)->bytes;
  ASSERT_EQ(bytes.size(), 8 * kFalconFrameBytes + 3 * FtdiBridge::kStatusBytes);
  std::string line;
  for (std::size_t i = 0; i < bytes.size(); i += 64) {
    const std::size_t size = std::min<std::size_t>(64, bytes.size() - i);
    EXPECT_EQ(hex_of(std::span(bytes).subspan(i, 2)), "0160");
    line += hex_of(std::span(bytes).subspan(i + 2, size - 2));
  }
  std::string wanted;
  for (int i = 0; i < 8; ++i) wanted += hex_of(falcon_reply({}));
  EXPECT_EQ(line, wanted);
}

TEST(FtdiBridge, WhatDoesNotFitIntoItsBufferIsLost) {
  FtdiBridge bridge({});
  for (int i = 0; i < 500; ++i) bridge.from_line(7, 9600, 0);
  std::size_t payload = 0;
  bool overrun = false;
  for (int i = 0; i < 20; ++i) {
    const Answer answer = bridge.in(64, 10'000'000'000 + i * 20'000'000);
    ASSERT_TRUE(usb_acked(answer));
    payload += answer.bytes.size() - 2;
    overrun = overrun || answer.bytes[1] & 2;
  }
  EXPECT_EQ(payload, FtdiBridge::kToHostBytes);
  EXPECT_TRUE(overrun);
}

TEST(Falcon, ItsLegsMoveMechanics) {
  Falcon falcon(loaded_falcon());
  FalconHost host(falcon);
  host.to_run_speed();
  sim::DeviceOptions truth;
  truth.name = "leg";
  sim::AxisOptions axis;
  axis.mass_kg = 2e-3;  // kg m^2
  axis.max_effort_N = 10;
  truth.axes = {axis};
  const double counts_per_rad = 9880.7 / (2 * M_PI);
  sim::EmulatedDevice body(truth, {{.motor = &falcon.motor(0), .turns_per_unit = counts_per_rad}});
  ASSERT_TRUE(body.start());
  body.advance(0);
  ASSERT_TRUE(host.exchange(command_bytes({-100, 0, 0})));
  const std::int64_t from_ns = host.now_ns;
  body.advance(from_ns);
  const double at = body.position(0), rate = body.truth().truth(0).velocity_m_s;
  body.advance(from_ns + 100'000'000);
  EXPECT_NEAR(body.position(0), at + rate * 0.1 + 0.5 * 0.01 / 2e-3 * 0.01, 1e-9);
  const auto reply = host.exchange(command_bytes({0, 0, 0}));
  ASSERT_TRUE(reply);
  EXPECT_EQ(encoders_of(*reply)[0], std::lround(counts_per_rad * body.position(0)));
}

}  // namespace
}  // namespace hapticd::test::emulator
