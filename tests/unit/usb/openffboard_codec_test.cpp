#include "drivers/hid/openffboard_codec.h"

#include <cmath>

#include "tests/unit/usb/vectors.h"

namespace hapticd::hid::openffboard {
namespace {

using usb::bytes;
using usb::each_vector;
using usb::hex;
using usb::Json;

Command command_of_vector(const Json& vector) {
  return {.type = static_cast<Type>(vector.at("type").get<int>()),
          .class_id = vector.at("class").get<std::uint16_t>(),
          .instance = vector.at("instance").get<std::uint8_t>(),
          .command = vector.at("cmd").get<std::uint32_t>(),
          .data = vector.at("data").get<std::int64_t>(),
          .address = vector.at("addr").get<std::int64_t>()};
}

TEST(OpenFfboardCodec, CommandsOfTheVectorsBothWays) {
  each_vector("openffboard_hidcmd", [](const Json& vector) {
    const Command command = command_of_vector(vector);
    EXPECT_EQ(hex(encode(command)), vector.at("hex"));
    EXPECT_EQ(decode_command(bytes(vector, "hex")), command);
  });
}

TEST(OpenFfboardCodec, RejectsTheVectors) {
  each_vector("openffboard_reject", [](const Json& vector) {
    const auto report = bytes(vector, "hex");
    EXPECT_FALSE(decode_command(report));
    EXPECT_FALSE(decode_gamepad(report));
    EXPECT_FALSE(decode_state(report));
    EXPECT_FALSE(decode_block_load(report));
  });
}

TEST(OpenFfboardCodec, RejectsOtherReportsLengthsAndTypes) {
  const CommandReport good = encode({});
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_FALSE(decode_command(std::span(good).first(size)));
  usb::Bytes longer(good.begin(), good.end());
  longer.push_back(0);
  EXPECT_FALSE(decode_command(longer));
  int taken = 0;
  for (int type = 0; type < 256; ++type) {
    CommandReport other = good;
    other[1] = static_cast<std::uint8_t>(type);
    taken += decode_command(other) ? 1 : 0;
  }
  EXPECT_EQ(taken, 9);
  CommandReport other = good;
  other[0] = 0x01;
  EXPECT_FALSE(decode_command(other));
  EXPECT_TRUE(decode_gamepad(other));
  EXPECT_FALSE(decode_gamepad(good));
}

TEST(OpenFfboardCodec, OnlyTheAnswerAnswers) {
  const Command read{.type = Type::read, .class_id = 0xa01, .command = 9};
  Command write = read;
  write.type = Type::write;
  Command reply = read;
  reply.data = 4711;
  EXPECT_TRUE(answers(reply, read));
  EXPECT_TRUE(answers(reply, write)) << "a write is answered as a read";
  for (const Type type : {Type::acknowledge, Type::not_found, Type::error}) {
    reply.type = type;
    EXPECT_TRUE(answers(reply, read));
  }
  for (const Type type : {Type::write, Type::info, Type::notification, Type::read_at}) {
    reply.type = type;
    EXPECT_FALSE(answers(reply, read));
  }
  reply = read;
  reply.command = 10;
  EXPECT_FALSE(answers(reply, read));
  reply = read;
  reply.class_id = 0xa02;
  EXPECT_FALSE(answers(reply, read));
  reply = read;
  reply.instance = 1;
  EXPECT_FALSE(answers(reply, read));
  Command of_all = read;
  of_all.instance = kAllInstances;
  EXPECT_TRUE(answers(reply, of_all));
  const Command write_at{.type = Type::write_at, .class_id = 0xa03, .command = 4, .address = 2};
  Command reply_at = write_at;
  reply_at.type = Type::read_at;
  EXPECT_TRUE(answers(reply_at, write_at));
  reply_at.address = 3;
  EXPECT_FALSE(answers(reply_at, write_at));
}

TEST(OpenFfboardCodec, GamepadReportsOfTheVectors) {
  each_vector("openffboard_gamepad_in16", [](const Json& vector) {
    const auto gamepad = decode_gamepad(bytes(vector, "hex"));
    ASSERT_TRUE(gamepad);
    EXPECT_EQ(gamepad->buttons, vector.at("buttons").get<std::uint64_t>());
    EXPECT_EQ(Json(gamepad->axes), vector.at("axes"));
  });
}

TEST(OpenFfboardCodec, EveryAxisAndButtonHasItsPlace) {
  usb::Bytes report{0x01};
  for (int i = 0; i < 24; ++i) report.push_back(static_cast<std::uint8_t>(0xf0 + i));
  const auto gamepad = decode_gamepad(report);
  ASSERT_TRUE(gamepad);
  EXPECT_EQ(gamepad->buttons, 0xf7f6f5f4f3f2f1f0U);
  EXPECT_EQ(gamepad->axes[0], static_cast<std::int16_t>(0xf9f8));
  EXPECT_EQ(gamepad->axes[3], static_cast<std::int16_t>(0xfffe));
  EXPECT_EQ(gamepad->axes[7], 0x0706);
}

TEST(OpenFfboardCodec, ConstantForcesOfTheVectors) {
  each_vector("pid_constant_force", [](const Json& vector) {
    const auto encoded = encode_magnitude(vector.at("effect").get<std::uint8_t>(),
                                          vector.at("magnitude").get<double>());
    ASSERT_TRUE(encoded);
    EXPECT_EQ(hex(encoded->report), vector.at("hex"));
    EXPECT_EQ(encoded->magnitude, vector.at("magnitude").get<int>());
    EXPECT_FALSE(encoded->saturated);
  });
}

TEST(OpenFfboardCodec, MagnitudesSaturateAndAreRounded) {
  for (const auto& [asked, sent] : {std::pair{40000.0, 32767},
                                    {-40000.0, -32767},
                                    {1e300, 32767},
                                    {-32768.0, -32767},
                                    {32767.5, 32767}}) {
    const auto encoded = encode_magnitude(1, asked);
    ASSERT_TRUE(encoded);
    EXPECT_EQ(encoded->magnitude, sent);
    EXPECT_TRUE(encoded->saturated) << asked;
  }
  EXPECT_EQ(encode_magnitude(1, -0.5)->magnitude, -1);
  EXPECT_FALSE(encode_magnitude(1, 32767.4)->saturated);
}

TEST(OpenFfboardCodec, RefusesWhatIsNoNumberAndNoEffect) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    EXPECT_FALSE(encode_magnitude(1, bad));
  EXPECT_FALSE(encode_magnitude(0, 0));
}

/// What this codec has for a report of the session, by the report's id.
std::string of_session(const usb::Bytes& report) {
  switch (report.at(0)) {
    case 0x11:
      return hex(kCreateConstantForce);
    case 0x0a:
      return hex(report.at(2) == 1 ? start_effect(report[1], report.at(3))
                                   : stop_effect(report[1]));
    case 0x0c:
      return hex(device_control(static_cast<Control>(report.at(1))));
    case 0x0d:
      return hex(device_gain(report.at(1)));
    default:
      return "no such report is sent";
  }
}

TEST(OpenFfboardCodec, SaysWhatTheSessionSays) {
  each_vector("pid_session", [](const Json& vector) {
    const auto report = bytes(vector, "hex");
    if (report.at(0) == 0x12) {
      const auto load = decode_block_load(report);
      ASSERT_TRUE(load);
      EXPECT_EQ(load->effect, vector.at("idx").get<int>());
      EXPECT_EQ(static_cast<int>(load->status), vector.at("status").get<int>());
      EXPECT_EQ(load->free_bytes, vector.at("ram").get<int>());
    } else if (report.at(0) == 0x02) {
      const auto state = decode_state(report);
      ASSERT_TRUE(state);
      EXPECT_EQ(*state, (State{.paused = vector.at("paused").get<bool>(),
                               .actuators_enabled = vector.at("actuators_enabled").get<bool>(),
                               .safety = vector.at("safety").get<bool>(),
                               .power = vector.at("power").get<bool>(),
                               .playing = vector.at("playing").get<bool>()}));
    } else {
      EXPECT_EQ(of_session(report), vector.at("hex"));
    }
  });
}

TEST(OpenFfboardCodec, ControlIsABitEach) {
  EXPECT_EQ(hex(device_control(Control::enable_actuators)), "0c01");
  EXPECT_EQ(hex(device_control(Control::disable_actuators)), "0c02");
  EXPECT_EQ(hex(device_control(Control::stop_all)), "0c04");
  EXPECT_EQ(hex(device_control(Control::reset)), "0c08");
}

TEST(OpenFfboardCodec, ABlockLoadMustNameAnEffect) {
  EXPECT_FALSE(decode_block_load(bytes("120001300c")));
  EXPECT_FALSE(decode_block_load(bytes("120100300c")));
  EXPECT_FALSE(decode_block_load(bytes("120104300c")));
  EXPECT_FALSE(decode_block_load(bytes("12010130")));
  const auto full = decode_block_load(bytes("1200020000"));
  ASSERT_TRUE(full);
  EXPECT_EQ(full->status, LoadStatus::full);
}

TEST(OpenFfboardCodec, SetEffectFillsTheLengthOfTheDescriptor) {
  usb::Bytes report(20, 0xee);
  ASSERT_TRUE(encode_set_effect({.effect = 2, .duration_ms = 100}, 1, report));
  EXPECT_EQ(hex(report), "0102016400000000000000ff0002282300000000");
  ASSERT_TRUE(encode_set_effect({}, 2, report));
  EXPECT_EQ(report[3], 0xff);
  EXPECT_EQ(report[4], 0xff);
  EXPECT_EQ(report[13], 4);
}

TEST(OpenFfboardCodec, SetEffectRefusesWhatItCannotSay) {
  usb::Bytes report(18);
  EXPECT_FALSE(encode_set_effect({.effect = 0}, 1, report));
  EXPECT_FALSE(encode_set_effect({.direction_centidegrees = 36000}, 1, report));
  EXPECT_FALSE(encode_set_effect({}, 0, report));
  EXPECT_FALSE(encode_set_effect({}, 3, report));
  EXPECT_FALSE(encode_set_effect({}, 1, std::span(report).first(15)));
  EXPECT_TRUE(encode_set_effect({}, 1, std::span(report).first(16)));
  EXPECT_FALSE(encode_set_effect({}, 2, std::span(report).first(17)));
  usb::Bytes too_long(65);
  EXPECT_FALSE(encode_set_effect({}, 1, too_long));
}

}  // namespace
}  // namespace hapticd::hid::openffboard
