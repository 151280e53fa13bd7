// The emulated Falcon against the vectors, the boot transcript and the faults of its boot.
#include <gtest/gtest.h>

#include "tests/unit/emulators/usb_falcon_host.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::usb;

TEST(FalconVectors, Commands) {
  for (const char* group : {"falcon_encode", "falcon_encode_saturate_policy"})
    each_usb_vector(group, [](const Json& vector) {
      const auto command = falcon_command(usb_bytes(vector));
      ASSERT_TRUE(command);
      const auto motors = vector.value("expect_motor", vector.at("motor")).get<std::vector<int>>();
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(command->motors[i], motors[i]);
      EXPECT_EQ(command->leds, vector.value("led", 0));
      EXPECT_EQ(command->homing, vector.value("homing_mode", false));
    });
}

TEST(FalconVectors, Replies) {
  each_usb_vector("falcon_decode", [](const Json& vector) {
    FalconState state{.homed = vector.at("homing_bits").get<std::uint8_t>(),
                      .grip = vector.at("grip_bits").get<std::uint8_t>()};
    for (std::size_t i = 0; i < 3; ++i)
      state.encoders[i] = vector.at("encoders")[i].get<std::int16_t>();
    EXPECT_EQ(hex_of(falcon_reply(state)), vector.at("hex").get<std::string>());
  });
}

TEST(FalconVectors, WhatIsNoFrameIsNoCommand) {
  each_usb_vector("falcon_decode_reject", [](const Json& vector) {
    UsbBytes bytes = usb_bytes(vector);
    if (bytes.size() > 13) bytes[13] = 'A';  // as a command has it
    EXPECT_FALSE(falcon_command(bytes));
  });
}

TEST(FalconVectors, PacketsOfTheStream) {
  each_usb_vector("falcon_stream", [](const Json& vector) {
    std::string line;
    for (const Json& packet : vector.at("usb_in_packets"))
      line += packet.get<std::string>().substr(4);
    for (const Json& frame : vector.at("frames")) {
      FalconState state{.homed = frame.at("homing_bits").get<std::uint8_t>(),
                        .grip = frame.at("grip_bits").get<std::uint8_t>()};
      for (std::size_t i = 0; i < 3; ++i)
        state.encoders[i] = frame.at("encoders")[i].get<std::int16_t>();
      EXPECT_NE(line.find(hex_of(falcon_reply(state))), std::string::npos);
    }
  });
}

TEST(FalconVectors, BaudRates) {
  each_usb_vector("ftdi_baud", [](const Json& vector) {
    const char* key = vector.contains("divisor") ? "divisor" : "divisor_used_by_public_driver";
    const auto divisor = std::stoul(vector.at(key).get<std::string>(), nullptr, 16);
    const double baud = vector.value("actual_baud", vector.at("baud").get<double>());
    EXPECT_NEAR(ftdi_baud(static_cast<std::uint16_t>(divisor), 0), baud, 1e-9 * baud);
  });
}

TEST(FalconVectors, BootTranscript) {
  each_usb_vector("falcon_boot_transcript", [](const Json& vector) {
    FalconOptions options;
    options.board.firmware = made_up_firmware(1000);
    Falcon falcon(options);
    FalconHost host(falcon);
    for (const Json& step : vector.at("steps")) {
      SCOPED_TRACE(step.dump());
      const std::string what = step.at("step").get<std::string>();
      if (step.contains("bRequest")) {
        host.set(step.at("bRequest").get<std::uint8_t>(), step.at("wValue").get<std::uint16_t>());
      } else if (what.starts_with("bulk out")) {
        host.out(Falcon::kOut, usb_bytes(step));
      } else if (what.starts_with("bulk in")) {
        EXPECT_EQ(hex_of(host.hear(0.04)), step.at("hex").get<std::string>());
      } else {
        ASSERT_TRUE(what.starts_with("upload"));
        EXPECT_EQ(host.upload(options.board.firmware), 17u);
      }
    }
    EXPECT_TRUE(falcon.board().firmware_runs());
    const auto reply = host.exchange(command_bytes({0, 0, 0}));
    ASSERT_TRUE(reply);
    EXPECT_EQ(hex_of(*reply),
              "3c414141414141414141414141"
              "41413e");
  });
}

TEST(Falcon, WithoutTheWakingOfPinsTheRomIsDeaf) {
  Falcon falcon({});
  FalconHost host(falcon);
  host.set(3, kRomDivisor);
  EXPECT_FALSE(host.greeted());
  host.wake();
  EXPECT_TRUE(host.greeted());
  EXPECT_FALSE(host.greeted());  // once
}

TEST(Falcon, AtAnotherRateThereIsOnlyGarbage) {
  Falcon falcon({});
  FalconHost host(falcon);
  host.wake();
  host.set(3, kRunDivisor);
  EXPECT_FALSE(host.greeted());

  Falcon running(loaded_falcon());
  FalconHost other(running);
  other.to_run_speed();
  other.set(3, kRomDivisor);
  EXPECT_FALSE(other.exchange(command_bytes({0, 0, 0}), 0.05));
  EXPECT_EQ(running.board().commands(), 0u);
}

TEST(Falcon, AnotherImageDoesNotRun) {
  FalconOptions options;
  options.board.firmware = made_up_firmware(620);
  Falcon falcon(options);
  FalconHost host(falcon);
  host.wake();
  ASSERT_TRUE(host.greeted());
  host.start_loader();
  UsbBytes image = options.board.firmware;
  image[400] ^= 1;
  EXPECT_EQ(host.upload(image), 10u);  // it echoes all the same
  host.to_run_speed();
  EXPECT_FALSE(falcon.board().firmware_runs());
  EXPECT_FALSE(host.exchange(command_bytes({0, 0, 0})));
}

TEST(Falcon, AWrongEchoIsAWrongImageAndTheNextUploadRuns) {
  FalconOptions options;
  options.board.firmware = made_up_firmware(620);
  options.board.wrong_echo_chunk = 4;
  options.board.wrong_echo_times = 1;
  Falcon falcon(options);
  FalconHost host(falcon);
  for (const std::size_t chunks : {4u, 10u}) {
    host.wake();
    ASSERT_TRUE(host.greeted());
    host.start_loader();
    EXPECT_EQ(host.upload(options.board.firmware), chunks);
  }
  EXPECT_TRUE(falcon.board().firmware_runs());
}

TEST(Falcon, DiesInTheUploadAndWakesAgain) {
  FalconOptions options;
  options.board.firmware = made_up_firmware(620);
  options.board.dies_at = 0.5;
  Falcon falcon(options);
  FalconHost host(falcon);
  for (const std::size_t chunks : {5u, 10u}) {
    host.wake();
    ASSERT_TRUE(host.greeted());
    host.start_loader();
    EXPECT_EQ(host.upload(options.board.firmware), chunks);
  }
  EXPECT_TRUE(falcon.board().firmware_runs());
}

TEST(Falcon, IgnoresGreetingsAndAnswersWithALeadingZero) {
  FalconOptions options;
  options.board.deaf_greetings = 2;
  options.board.leading_zero = true;
  Falcon falcon(options);
  FalconHost host(falcon);
  host.wake();
  for (int i = 0; i < 2; ++i) {
    host.out(Falcon::kOut, {0x0a, 0x43, 0x0d});
    EXPECT_TRUE(host.hear(0.05).empty());
  }
  host.out(Falcon::kOut, {0x0a, 0x43, 0x0d});
  EXPECT_EQ(host.hear(0.05), (UsbBytes{0x00, 0x0a, 0x44, 0x2c, 0x0d}));
}

}  // namespace
}  // namespace hapticd::test::emulator
