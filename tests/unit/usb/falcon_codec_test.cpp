#include "drivers/usb/falcon_codec.h"

#include <cmath>
#include <limits>

#include "tests/unit/usb/falcon_packets.h"

namespace hapticd::usb::falcon {
namespace {

Command command_of(const Json& vector) {
  const int led = vector.at("led").get<int>();
  return {.motor_counts = vector.at("motor").get<std::array<double, 3>>(),
          .homing = vector.at("homing_mode").get<bool>(),
          .green = (led & 2) != 0,
          .blue = (led & 4) != 0,
          .red = (led & 8) != 0};
}

TEST(FalconCodec, EncodesTheVectors) {
  each_vector("falcon_encode", [](const Json& vector) {
    const auto encoded = encode(command_of(vector));
    ASSERT_TRUE(encoded);
    EXPECT_EQ(hex(encoded->packet), vector.at("hex"));
    EXPECT_FALSE(encoded->saturated);
  });
}

TEST(FalconCodec, SaturatesAndNeverWraps) {
  each_vector("falcon_encode_saturate_policy", [](const Json& vector) {
    const auto encoded = encode(command_of(vector));
    ASSERT_TRUE(encoded);
    EXPECT_EQ(hex(encoded->packet), vector.at("hex"));
    EXPECT_NE(hex(encoded->packet), vector.at("unsafe_wrap_hex"));
    EXPECT_EQ(Json(encoded->motor_counts), vector.at("expect_motor"));
    EXPECT_TRUE(encoded->saturated);
  });
  const auto huge = encode({.motor_counts = {1e300, -1e300, 32767.4}});
  ASSERT_TRUE(huge);
  EXPECT_EQ(huge->motor_counts, (std::array<std::int16_t, 3>{32767, -32768, 32767}));
}

TEST(FalconCodec, RoundsHalfAwayFromZero) {
  const auto encoded = encode({.motor_counts = {0.5, -0.5, 2.4}});
  ASSERT_TRUE(encoded);
  EXPECT_EQ(encoded->motor_counts, (std::array<std::int16_t, 3>{1, -1, 2}));
}

TEST(FalconCodec, RefusesWhatIsNoNumber) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    for (std::size_t leg = 0; leg < 3; ++leg) {
      Command command;
      command.motor_counts[leg] = bad;
      EXPECT_FALSE(encode(command)) << bad;
    }
}

TEST(FalconCodec, DecodesTheVectors) {
  each_vector("falcon_decode", [](const Json& vector) {
    const auto sample = decode(bytes(vector, "hex"));
    ASSERT_TRUE(sample);
    EXPECT_EQ(Json(sample->encoder_counts), vector.at("encoders"));
    EXPECT_EQ(sample->homed, vector.at("homing_bits").get<int>());
    EXPECT_EQ(sample->buttons, vector.at("grip_bits").get<int>());
    for (unsigned leg = 0; leg < 3; ++leg)
      EXPECT_EQ(((sample->homed >> leg) & 1) != 0, vector.at("homed").at(leg).get<bool>());
    const Json& buttons = vector.at("buttons");
    EXPECT_EQ((sample->buttons & kPlus) != 0, buttons.at("plus").get<bool>());
    EXPECT_EQ((sample->buttons & kForward) != 0, buttons.at("forward").get<bool>());
    EXPECT_EQ((sample->buttons & kCentre) != 0, buttons.at("center").get<bool>());
    EXPECT_EQ((sample->buttons & kMinus) != 0, buttons.at("minus").get<bool>());
    EXPECT_EQ(hex(sent_by_device(*sample)), vector.at("hex"));
  });
}

TEST(FalconCodec, RejectsTheVectors) {
  each_vector("falcon_decode_reject",
              [](const Json& vector) { EXPECT_FALSE(decode(bytes(vector, "hex"))); });
}

TEST(FalconCodec, TakesNoByteThatAPacketDoesNotHaveThere) {
  const Bytes good = sent_by_device({.encoder_counts = {1234, -1234, -4000}, .homed = 7});
  for (std::size_t at = 0; at < good.size(); ++at) {
    int taken = 0;
    for (int value = 0; value < 256; ++value) {
      Bytes changed = good;
      changed[at] = static_cast<std::uint8_t>(value);
      taken += decode(changed) ? 1 : 0;
    }
    const int legal = at == 0 || at == 15 ? 1 : at == 13 ? 128 : at == 14 ? 254 : 16;
    EXPECT_EQ(taken, legal) << "byte " << at;
  }
}

TEST(FalconCodec, TakesNoOtherLength) {
  const Bytes good = sent_by_device({});
  for (std::size_t size = 0; size < 16; ++size) EXPECT_FALSE(decode(std::span(good).first(size)));
  Bytes longer = good;
  longer.push_back('>');
  EXPECT_FALSE(decode(longer));
}

TEST(FalconCodec, EverySampleComesBack) {
  std::mt19937 random(1);
  for (int i = 0; i < 10000; ++i) {
    const Sample sample = any_sample(random);
    ASSERT_EQ(decode(sent_by_device(sample)), sample);
  }
}

TEST(FalconCodec, ACommandIsAPacketInForm) {
  std::mt19937 random(2);
  for (int i = 0; i < 10000; ++i) {
    const Sample motors = any_sample(random);
    const auto encoded = encode({.motor_counts = {static_cast<double>(motors.encoder_counts[0]),
                                                  static_cast<double>(motors.encoder_counts[1]),
                                                  static_cast<double>(motors.encoder_counts[2])}});
    ASSERT_TRUE(encoded);
    const auto read = decode(encoded->packet);
    ASSERT_TRUE(read);
    ASSERT_EQ(read->encoder_counts, motors.encoder_counts);
  }
}

template <std::size_t... kSizes>
Json requests_of(const std::array<ControlRequest, kSizes>&... parts) {
  Json all = Json::array();
  const auto append = [&](const auto& part) {
    for (const ControlRequest& request : part) all.push_back({request.request, request.value});
  };
  (append(parts), ...);
  return all;
}

TEST(FalconBoot, SaysWhatTheTranscriptSays) {
  each_vector("falcon_boot_transcript", [](const Json& vector) {
    Json requests = Json::array(), said = Json::array();
    for (const Json& step : vector.at("steps")) {
      if (step.contains("hex")) said.push_back(step.at("hex"));
      if (!step.contains("bRequest")) continue;
      EXPECT_EQ(step.at("bmRequestType").get<int>(), kVendorRequestType);
      EXPECT_EQ(step.at("wIndex").get<int>(), 0);
      EXPECT_EQ(step.at("wLength").get<int>(), 0);
      requests.push_back({step.at("bRequest"), step.at("wValue")});
    }
    EXPECT_EQ(requests, requests_of(kBeforeGreeting, kBeforeUpload, kBeforeRun));
    EXPECT_EQ(said,
              Json({hex(kGreeting), hex(kGreetingAnswer), hex(kStartUpload), hex(kStartUpload)}));
  });
}

TEST(FalconBoot, DivisorsAreTheBaudsOfTheVectors) {
  each_vector("ftdi_baud", [](const Json& vector) {
    const bool exact = vector.contains("divisor");
    const auto divisor = static_cast<std::uint16_t>(std::stoul(
        vector.at(exact ? "divisor" : "divisor_used_by_public_driver").get<std::string>(), nullptr,
        16));
    const double baud = vector.at(exact ? "baud" : "actual_baud").get<double>();
    EXPECT_NEAR(baud_of(divisor), baud, 1e-6);
    EXPECT_TRUE(divisor == kBaud9600.value || divisor == kBaudBoot.value ||
                divisor == kBaudRun.value);
  });
}

TEST(FalconBoot, AnswersAreComparedByteByByte) {
  EXPECT_EQ(greeting_answer({}), Answer::incomplete);
  EXPECT_EQ(greeting_answer(bytes("00")), Answer::incomplete);
  EXPECT_EQ(greeting_answer(bytes("0a442c")), Answer::incomplete);
  EXPECT_EQ(greeting_answer(bytes("0a442c0d")), Answer::right);
  EXPECT_EQ(greeting_answer(bytes("000a442c0d")), Answer::right);
  EXPECT_EQ(greeting_answer(bytes("0a442c0d4142")), Answer::right);
  EXPECT_EQ(greeting_answer(bytes("0a430d")), Answer::wrong);
  EXPECT_EQ(greeting_answer(bytes("410a442c0d")), Answer::wrong);
  EXPECT_EQ(echo(kStartUpload, {}), Answer::incomplete);
  EXPECT_EQ(echo(kStartUpload, bytes("41")), Answer::right);
  EXPECT_EQ(echo(kStartUpload, bytes("4141")), Answer::wrong);
  EXPECT_EQ(echo(bytes("010203"), bytes("0102")), Answer::incomplete);
  EXPECT_EQ(echo(bytes("010203"), bytes("0103")), Answer::wrong);
}

TEST(FalconBoot, ChunksAreTheWholeFile) {
  for (const std::size_t size : {0U, 1U, 61U, 62U, 63U, 124U, 7914U}) {
    Bytes firmware(size);
    for (std::size_t i = 0; i < size; ++i) firmware[i] = static_cast<std::uint8_t>(i * 7);
    Bytes sent;
    for (std::size_t i = 0; !chunk(firmware, i).empty(); ++i) {
      const auto next = chunk(firmware, i);
      EXPECT_LE(next.size(), kChunkBytes);
      sent.insert(sent.end(), next.begin(), next.end());
    }
    EXPECT_EQ(sent, firmware);
    EXPECT_TRUE(chunk(firmware, std::numeric_limits<std::size_t>::max()).empty());
  }
}

}  // namespace
}  // namespace hapticd::usb::falcon
