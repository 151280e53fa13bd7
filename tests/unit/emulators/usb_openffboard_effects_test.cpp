// The emulated OpenFFBoard: reports against the vectors, and effects.
#include <gtest/gtest.h>

#include "tests/unit/emulators/usb_openffboard_host.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::usb;

TEST(OpenffboardVectors, Commands) {
  each_usb_vector("openffboard_hidcmd", [](const Json& vector) {
    const OpenffboardCommand command{.type = static_cast<CommandType>(vector.at("type").get<int>()),
                                     .class_id = vector.at("class").get<std::uint16_t>(),
                                     .instance = vector.at("instance").get<std::uint8_t>(),
                                     .command = vector.at("cmd").get<std::uint32_t>(),
                                     .data = vector.at("data").get<std::int64_t>(),
                                     .address = vector.at("addr").get<std::int64_t>()};
    const auto read = openffboard_command(usb_bytes(vector));
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, command);
    EXPECT_EQ(hex_of(openffboard_command(command)), vector.at("hex").get<std::string>());
  });
  each_usb_vector("openffboard_reject",
                  [](const Json& vector) { EXPECT_FALSE(openffboard_command(usb_bytes(vector))); });
}

TEST(OpenffboardVectors, PadReports) {
  each_usb_vector("openffboard_gamepad_in16", [](const Json& vector) {
    OpenffboardPad pad{.buttons = vector.at("buttons").get<std::uint64_t>()};
    for (std::size_t i = 0; i < 8; ++i) pad.axes[i] = vector.at("axes")[i].get<std::int16_t>();
    EXPECT_EQ(hex_of(openffboard_pad(pad)), vector.at("hex").get<std::string>());
  });
}

TEST(OpenffboardVectors, ConstantForces) {
  each_usb_vector("pid_constant_force", [](const Json& vector) {
    const auto force = openffboard_constant(usb_bytes(vector));
    ASSERT_TRUE(force);
    EXPECT_EQ(force->index, vector.at("effect").get<int>());
    EXPECT_EQ(force->magnitude, vector.at("magnitude").get<int>());
  });
}

/// Each step that goes to the device is sent, each that comes from it is waited for.
TEST(OpenffboardVectors, Session) {
  Openffboard board(plain_board());
  BoardHost host(board);
  each_usb_vector("pid_session", [&](const Json& vector) {
    const UsbBytes bytes = usb_bytes(vector);
    switch (bytes.at(0)) {
      case 0x11:
        EXPECT_TRUE(usb_acked(host.ask({0x21, 9, 0x0311, 2, 4}, bytes)));
        break;
      case 0x12:
        EXPECT_EQ(hex_of(host.ask({0xa1, 1, 0x0312, 2, 5}).bytes), hex_of(bytes));
        break;
      case 0x02: {
        host.send(set_effect_bytes(kForever));
        std::optional<UsbBytes> state;
        for (int i = 0; i < 5 && state != bytes; ++i) {  // the first is of before
          host.send(set_effect_bytes(kForever));
          state = host.read(Openffboard::kIn, 0.2);
        }
        ASSERT_TRUE(state);
        EXPECT_EQ(hex_of(*state), hex_of(bytes));
        break;
      }
      default:
        host.send(bytes);
        EXPECT_TRUE(bytes[0] != 0x0a || board.effects().playing(1) == (bytes[2] == 1));
        EXPECT_TRUE(bytes[0] != 0x0c || board.actuators_on());
    }
  });
}

TEST(Openffboard, ForceActsAgainstTheMagnitudeInItsDirection) {
  Openffboard board(plain_board());
  BoardHost host(board);
  host.play(16384);
  EXPECT_NEAR(board.motor(0).torque(), -0.5, 1e-4);
  EXPECT_NEAR(board.motor(1).torque(), 0, 1e-4);
  host.force(-32767);
  EXPECT_NEAR(board.motor(0).torque(), 1, 1e-4);
  host.send(set_effect_bytes(kForever, 18000));  // Y: -cos 180 degrees = 1
  EXPECT_NEAR(board.motor(0).torque(), 0, 1e-4);
  EXPECT_NEAR(board.motor(1).torque(), 1, 1e-4);
  host.send(set_effect_bytes(kForever, 36000, 1));  // no direction: linear on X
  EXPECT_NEAR(board.motor(0).torque(), 1, 1e-4);
  EXPECT_NEAR(board.motor(1).torque(), 0, 1e-4);
}

TEST(Openffboard, TheLastForceStaysForEver) {
  Openffboard board(plain_board());
  BoardHost host(board);
  host.play(3000);
  host.run_for(100);
  EXPECT_NEAR(board.motor(0).torque(), -3000.0 / 32767, 1e-4);
}

TEST(Openffboard, AnEffectEndsByItsDurationAndStartsAnew) {
  Openffboard board(plain_board());
  BoardHost host(board);
  host.play(32767, 100);
  const auto plays_until = [&] {
    while (board.motor(0).torque() != 0 && host.now_ns < 10'000'000'000) host.run_for(0.1e-3);
    return host.now_ns;
  };
  const std::int64_t started_ns = host.now_ns;  // 1 to 2 ms after it was told
  EXPECT_NEAR(1e-9 * static_cast<double>(plays_until() - started_ns), 0.1, 3e-3);
  EXPECT_FALSE(board.effects().playing(1));
  for (int i = 0; i < 6; ++i) {
    host.send({0x0a, 1, 1, 1});
    host.run_for(0.07);
    EXPECT_NE(board.motor(0).torque(), 0);
  }
  const std::int64_t last_ns = host.now_ns;
  EXPECT_NEAR(1e-9 * static_cast<double>(plays_until() - last_ns), 0.03, 3e-3);
}

TEST(Openffboard, ForcesAddUpAndClip) {
  Openffboard board(plain_board());
  BoardHost host(board);
  host.play(20000);
  EXPECT_EQ(host.create().at(1), 2);
  host.send(set_effect_bytes(kForever, 9000, 6, 2));
  host.force(20000, 2);
  host.send({0x0a, 2, 1, 1});
  EXPECT_NEAR(board.motor(0).torque(), -1, 1e-9);
  host.send({0x0a, 2, 2, 1});  // alone
  EXPECT_NEAR(board.motor(0).torque(), -20000.0 / 32767, 1e-9);
  EXPECT_FALSE(board.effects().playing(1));
  host.send({0x0d, 51});
  EXPECT_NEAR(board.motor(0).torque(), -4000.0 / 32767, 1e-9);
}

TEST(Openffboard, ControlBitsSwitchActuators) {
  Openffboard board(plain_board());
  BoardHost host(board);
  host.play(10000);
  for (const int off : {0x02, 0x04, 0x10}) {
    host.send({0x0c, static_cast<std::uint8_t>(off)});
    EXPECT_EQ(board.motor(0).torque(), 0);
    EXPECT_TRUE(board.effects().playing(1));
    host.send({0x0c, 0x20});
    EXPECT_NEAR(board.motor(0).torque(), -10000.0 / 32767, 1e-9);
  }
  host.send({0x0c, 0x08});
  host.send({0x0c, 0x01});
  EXPECT_EQ(board.motor(0).torque(), 0);
  EXPECT_FALSE(board.effects().playing(1));
}

TEST(Openffboard, WhenAllPlacesAreTakenBlockLoadSaysSo) {
  Openffboard board(plain_board());
  BoardHost host(board);
  for (int i = 1; i <= 40; ++i) {
    const UsbBytes reply = host.create();
    EXPECT_EQ(reply.at(1), i);
    EXPECT_EQ(reply.at(2), 1);
  }
  EXPECT_EQ(host.create().at(2), 2);
  host.send({0x0b, 7});
  EXPECT_EQ(host.create().at(1), 7);
  EXPECT_EQ(host.create(13).at(2), 2);  // no such type
}

TEST(Openffboard, FilterOfConstantForcesSmoothsAStep) {
  Openffboard board(plain_board());
  BoardHost host(board);
  host.play(0);
  EXPECT_EQ(host.setting(0, kEffects), 500);
  host.force(10000);
  EXPECT_NEAR(board.motor(0).torque(), -10000.0 / 32767, 1e-9);
  host.force(0);
  host.tell({.type = CommandType::write, .class_id = kEffects, .command = 0, .data = 20});
  host.force(10000);
  EXPECT_LT(std::abs(board.motor(0).torque()), 0.1);
  host.run_for(0.5);
  EXPECT_NEAR(board.motor(0).torque(), -10000.0 / 32767, 1e-4);
  host.tell({.type = CommandType::write, .class_id = kEffects, .command = 0, .data = 9999});
  (void)host.answer();
  (void)host.answer();
  EXPECT_EQ(host.setting(0, kEffects), 500);
}

}  // namespace
}  // namespace hapticd::test::emulator
