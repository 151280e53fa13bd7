#include "drivers/hid/report_map.h"

#include <cmath>
#include <random>

#include "tests/unit/usb/vectors.h"

namespace hapticd::hid {
namespace {

using usb::bytes;
using usb::each_vector;
using usb::hex;
using usb::Json;

TEST(ReportMap, DecodesTheVectors) {
  each_vector("report_map_decode", [](const Json& vector) {
    const auto report = bytes(vector, "report_hex");
    const InputMap map = usb::input_map_of(vector, report.size());
    EXPECT_EQ(check(map), (Problem{Fault::none, kMostFields}));
    const Reading reading = decode(map, report);
    ASSERT_EQ(reading.received, Received::ok);
    for (std::size_t i = 0; i < map.fields.size(); ++i) {
      const Json& expected =
          vector.at("values").at(vector.at("fields").at(i).at("name").get<std::string>());
      EXPECT_EQ(reading.raw[i], expected.at("raw").get<std::int64_t>());
      EXPECT_NEAR(reading.value[i], expected.at("value").get<double>(), 1e-12);
    }
  });
}

TEST(ReportMap, EncodesTheVectors) {
  each_vector("report_map_encode", [](const Json& vector) {
    const auto report = bytes(vector, "report_hex");
    const OutputMap map = usb::output_map_of(vector, report.size());
    EXPECT_EQ(check(map), (Problem{Fault::none, kMostFields}));
    std::vector<double> values;
    for (const Json& field : vector.at("fields"))
      values.push_back(vector.at("values").at(field.at("name").get<std::string>()).get<double>());
    const auto encoded = encode(map, values, 0);
    ASSERT_TRUE(encoded);
    EXPECT_EQ(hex(encoded->report()), vector.at("report_hex"));
    for (std::size_t i = 0; i < map.fields.size(); ++i) {
      const Json& expected =
          vector.at("raw").at(vector.at("fields").at(i).at("name").get<std::string>());
      EXPECT_EQ(encoded->raw[i], expected.at("raw").get<std::int64_t>());
      EXPECT_EQ(((encoded->saturated >> i) & 1) != 0, expected.at("saturated").get<bool>());
    }
    std::array<std::uint8_t, kMostReportBytes + 1> buffer{};
    EXPECT_EQ(hex(for_hidapi(*encoded, map.report_id.has_value(), buffer)),
              vector.at("hidapi_write_hex"));
  });
}

TEST(ReportMap, IsWoodenHapticsBothWays) {
  each_vector("woodenhaptics_in", [](const Json& vector) {
    const Reading reading = decode(usb::woodenhaptics_in(), bytes(vector, "hex"));
    ASSERT_EQ(reading.received, Received::ok);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(reading.raw[i], vector.at("encoders").at(i).get<std::int64_t>());
    EXPECT_EQ(reading.sequence, vector.at("seq").get<std::uint64_t>());
  });
  each_vector("woodenhaptics_out", [](const Json& vector) {
    OutputMap map = usb::woodenhaptics_out();
    const unsigned debug = vector.at("debug").get<std::uint16_t>();
    map.constants = {{.at = 6, .value = static_cast<std::uint8_t>(debug & 255)},
                     {.at = 7, .value = static_cast<std::uint8_t>(debug >> 8)}};
    EXPECT_EQ(check(map).fault, Fault::none);
    std::vector<double> current_A;
    for (const Json& mA : vector.at("mA")) current_A.push_back(mA.get<double>() / 1000);
    const auto encoded = encode(map, current_A, 0);
    ASSERT_TRUE(encoded);
    std::array<std::uint8_t, kMostReportBytes + 1> buffer{};
    EXPECT_EQ(hex(for_hidapi(*encoded, false, buffer)), vector.at("hidapi_write_hex"));
  });
}

TEST(ReportMap, WhatIsNoNumberIsRefusedAndTheSafeReportIsZero) {
  each_vector("nonfinite_force", [](const Json& vector) {
    EXPECT_EQ(vector.at("expect"), "zero output and fault flag");
    EXPECT_FALSE(encode(usb::woodenhaptics_out(),
                        std::array{std::stod(vector.at("value").get<std::string>()), 0.0, 0.0}, 0));
  });
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    EXPECT_FALSE(encode(usb::woodenhaptics_out(), std::array{0.0, 0.0, bad}, 0));
  EXPECT_EQ(hex(safe_report(usb::woodenhaptics_out(), 0).report()), "0000000000000000");
}

TEST(ReportMap, RefusesAnotherNumberOfValues) {
  EXPECT_FALSE(encode(usb::woodenhaptics_out(), std::array{0.0, 0.0}, 0));
  EXPECT_FALSE(encode(usb::woodenhaptics_out(), std::array{0.0, 0.0, 0.0, 0.0}, 0));
}

TEST(ReportMap, TakesNoOtherLengthAndNoOtherId) {
  InputMap map{.report_id = 3, .report_bytes = 3, .fields = {{.place = usb::int16_at(8)}}};
  ASSERT_EQ(check(map).fault, Fault::none);
  EXPECT_EQ(decode(map, bytes("03e803")).raw[0], 1000);
  EXPECT_EQ(decode(map, bytes("02e803")).received, Received::ignore);
  EXPECT_EQ(decode(map, bytes("02")).received, Received::ignore);
  for (const char* other : {"", "03", "03e8", "03e80300"})
    EXPECT_EQ(decode(map, bytes(other)).received, Received::malformed) << other;
}

TEST(ReportMap, SafeReportsAreAsGivenWithTheHeartbeat) {
  OutputMap map = usb::woodenhaptics_out();
  map.heartbeat = Place{.offset_bits = 48, .width_bits = 4};
  map.constants = {{.at = 7, .value = 0xa5}};
  EXPECT_EQ(check(map).fault, Fault::none);
  EXPECT_EQ(hex(safe_report(map, 0x13).report()), "00000000000003a5");
  map.safe = bytes("0100010001001000");  // a step of each
  EXPECT_EQ(check(map).fault, Fault::none);
  const Encoded safe = safe_report(map, 0x1f);
  EXPECT_EQ(hex(safe.report()), "0100010001001f00");
  EXPECT_EQ(safe.raw[2], 1);
  map.safe = bytes("0100010002001000");
  EXPECT_EQ(check(map).fault, Fault::safe_report) << "it asks for a force";
  map.safe = bytes("0100010001001000");
  map.safe.pop_back();
  EXPECT_EQ(check(map), (Problem{Fault::safe_report, kMostFields}));
  OutputMap numbered{.report_id = 2, .report_bytes = 2, .safe = bytes("0100")};
  EXPECT_EQ(check(numbered).fault, Fault::safe_report);
  numbered.safe = bytes("0200");
  EXPECT_EQ(check(numbered).fault, Fault::none);
}

TEST(ReportMap, ANumberedReportGoesToHidapiAsItIs) {
  const OutputMap map{.report_id = 9, .report_bytes = 3, .fields = {{.place = usb::int16_at(8)}}};
  const auto encoded = encode(map, std::array{-2.0}, 0);
  ASSERT_TRUE(encoded);
  std::array<std::uint8_t, kMostReportBytes + 1> buffer{};
  EXPECT_EQ(hex(for_hidapi(*encoded, true, buffer)), "09feff");
}

TEST(ReportMap, LimitsClipBeforeTheConversion) {
  const auto encoded = encode(usb::woodenhaptics_out(), std::array{5.0, -1e300, 2.9999}, 0);
  ASSERT_TRUE(encoded);
  EXPECT_EQ(encoded->raw[0], 3000);
  EXPECT_EQ(encoded->raw[1], -3000);
  EXPECT_EQ(encoded->raw[2], 3000);
  EXPECT_EQ(encoded->saturated, 3U) << "the third was rounded, not clipped";
}

TEST(ReportMap, EveryWidthSaturatesAtItsOwnEnds) {
  for (std::uint32_t width = 1; width <= 64; ++width) {
    const double half = std::ldexp(1.0, static_cast<int>(width) - 1);
    const std::uint64_t ones = width == 64 ? ~0ULL : (1ULL << width) - 1;
    const auto sent = [&](bool is_signed, double value) {
      const OutputMap map{
          .report_bytes = 9,
          .fields = {{.place = {.offset_bits = 3, .width_bits = width, .is_signed = is_signed}}}};
      const auto encoded = encode(map, std::array{value}, 0);
      EXPECT_TRUE(encoded);
      return std::pair(read_bits(encoded->report(), map.fields[0].place), encoded->saturated != 0);
    };
    using Sent = std::pair<std::uint64_t, bool>;
    for (const double high : {half, 1e300}) EXPECT_EQ(sent(true, high), Sent(ones >> 1, true));
    EXPECT_EQ(sent(true, -half), Sent((ones >> 1) + 1, false));
    EXPECT_EQ(sent(true, -2 * half - 2048 * half / 512), Sent((ones >> 1) + 1, true));
    EXPECT_EQ(sent(true, -1e300), Sent((ones >> 1) + 1, true));
    for (const double high : {2 * half, 1e300}) EXPECT_EQ(sent(false, high), Sent(ones, true));
    for (const double low : {-1.0, -1e300}) EXPECT_EQ(sent(false, low), Sent(0, true));
    if (width <= 53) {
      EXPECT_EQ(sent(false, 2 * half - 1), Sent(ones, false));
      EXPECT_EQ(sent(true, half - 1), Sent(ones >> 1, false));
    }
  }
}

TEST(ReportMap, UnsignedNumbersOf64BitsHaveTheirValue) {
  const InputMap map{.report_bytes = 8, .fields = {{.place = {.width_bits = 64}}}};
  const Reading reading = decode(map, bytes("ffffffffffffffff"));
  EXPECT_EQ(reading.raw[0], -1);
  EXPECT_EQ(reading.value[0], 18446744073709551616.0);
}

TEST(ReportMap, CountersGoOnOverTheirEnd) {
  each_vector("counter_unwrap16", [](const Json& vector) {
    Unwrap unwrap;
    Json counted = Json::array();
    for (const Json& raw : vector.at("raw16"))
      counted.push_back(unwrap.step(raw.get<std::int64_t>(), 65536));
    EXPECT_EQ(counted, vector.at("unwrapped"));
  });
  Unwrap turn;
  for (const auto& [raw, count] : {std::pair{3990, 3990},
                                   {10, 4010},
                                   {3990, 3990},
                                   {2500, 2500},
                                   {510, 510},
                                   {3000, -1000},
                                   {2000, -2000}})
    EXPECT_EQ(turn.step(raw, 4000), count);
}

TEST(ReportMap, CountersOfAllModulesFollowSmallSteps) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 2000; ++i) {
    const std::uint64_t modulus = 3 + random() % ((1ULL << (2 + random() % 31)) - 2);
    const auto m = static_cast<std::int64_t>(modulus);
    const bool is_signed = random() % 2 == 0;
    Unwrap unwrap;
    std::int64_t truth = is_signed ? 0 : static_cast<std::int64_t>(random() % modulus);
    for (int step = 0; step < 50; ++step) {
      const std::int64_t rest = ((truth % m) + m) % m;
      const std::int64_t raw = is_signed && rest >= (m + 1) / 2 ? rest - m : rest;
      ASSERT_EQ(unwrap.step(raw, modulus), truth) << modulus;
      truth += static_cast<std::int64_t>(random() % modulus) / 2 * (random() % 2 == 0 ? 1 : -1);
    }
  }
}

TEST(ReportMap, SequenceNumbersTellLossRepetitionAndGoingBack) {
  each_vector("sequence_loss", [](const Json& vector) {
    Sequence sequence;
    std::uint64_t lost = 0, repeated = 0;
    for (const Json& number : vector.at("seq")) {
      const auto step =
          sequence.step(number.get<std::uint64_t>(), vector.at("modulus").get<std::uint64_t>());
      lost += step.lost;
      repeated += step.order == Sequence::Order::repeated ? 1 : 0;
    }
    EXPECT_EQ(lost, vector.at("lost").get<std::uint64_t>());
    EXPECT_EQ(repeated, vector.at("repeated").get<std::uint64_t>());
  });
  Sequence sequence;
  using Order = Sequence::Order;
  EXPECT_EQ(sequence.step(254, 256).order, Order::first);
  EXPECT_EQ(sequence.step(255, 256).order, Order::next);
  EXPECT_EQ(sequence.step(0, 256).order, Order::next);
  EXPECT_EQ(sequence.step(0, 256).order, Order::repeated);
  EXPECT_EQ(sequence.step(128, 256).lost, 127U);
  EXPECT_EQ(sequence.step(127, 256).order, Order::back);
  sequence.restart();
  EXPECT_EQ(sequence.step(5, 256).order, Order::first);
}

TEST(ReportMap, FollowingAMapUnwrapsItsCountersAndReadsItsSequence) {
  const InputMap map = usb::woodenhaptics_in();
  InputState state;
  Reading reading = decode(map, bytes("ff7f00800000ffff"));
  EXPECT_EQ(follow(map, state, reading).order, Sequence::Order::first);
  reading = decode(map, bytes("0180ff7f00000200"));
  const auto step = follow(map, state, reading);
  EXPECT_EQ(step.order, Sequence::Order::lost);
  EXPECT_EQ(step.lost, 2U);
  EXPECT_EQ(reading.value[0], 32769);
  EXPECT_EQ(reading.value[1], -32769);
  EXPECT_EQ(reading.raw[0], -32767);
}

TEST(ReportMap, ACounterBeyondItsModulusIsNoReading) {
  InputMap map = usb::woodenhaptics_in();
  map.fields[0].modulus = 4000;
  map.sequence->modulus = 100;
  ASSERT_EQ(check(map).fault, Fault::none);
  EXPECT_EQ(decode(map, bytes("9f0f000000006300")).received, Received::ok);
  EXPECT_EQ(decode(map, bytes("a00f000000006300")).received, Received::out_of_range);
  EXPECT_EQ(decode(map, bytes("9f0f000000006400")).received, Received::out_of_range);
}

}  // namespace
}  // namespace hapticd::hid
