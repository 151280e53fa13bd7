// Fields of IEEE 754 binary32: 1.0 is 3f800000, 0.1 is 3dcccccd, the largest 7f7fffff (IEEE 754-2008, table 3.5).
#include <cfloat>
#include <cmath>
#include <random>

#include "tests/unit/usb/vectors.h"

namespace hapticd::hid {
namespace {

using usb::bytes;
using usb::hex;

constexpr Place kLittle{.offset_bits = 0, .width_bits = 32, .is_float = true};
constexpr Place kBig{.offset_bits = 32, .width_bits = 32, .endian = Endian::big, .is_float = true};

InputMap floats_in() {
  return {.report_bytes = 8, .fields = {{.place = kLittle}, {.place = kBig}}};
}
OutputMap floats_out(double scale = 1) {
  return {.report_bytes = 8,
          .fields = {{.place = kLittle, .scale = scale}, {.place = kBig, .scale = scale}}};
}
std::string sent(const OutputMap& map, double first, double second) {
  const auto encoded = encode(map, std::array{first, second}, 0);
  return encoded ? hex(encoded->report()) : "refused";
}

TEST(ReportMapFloat, AreReadAndWrittenInBothOrders) {
  ASSERT_EQ(check(floats_in()).fault, Fault::none);
  ASSERT_EQ(check(floats_out()).fault, Fault::none);
  const Reading reading = decode(floats_in(), bytes("0000803f3dcccccd"));
  ASSERT_EQ(reading.received, Received::ok);
  EXPECT_EQ(reading.value[0], 1.0);
  EXPECT_EQ(reading.value[1], 0x1.99999ap-4);
  EXPECT_EQ(reading.raw[1], 0x3dcccccd);
  EXPECT_EQ(sent(floats_out(), 1.0, 0.1), "0000803f3dcccccd");
  EXPECT_EQ(sent(floats_out(), -2.5, -0.2), "000020c0be4ccccd");
}

TEST(ReportMapFloat, ScaleAndOffsetHoldForThemToo) {
  InputMap in = floats_in();
  in.fields[0] = {.place = kLittle, .scale = -2, .offset = 1};
  EXPECT_EQ(decode(in, bytes("000020410000000000")).received, Received::malformed);
  EXPECT_EQ(decode(in, bytes("0000204100000000")).value[0], -19);  // 10
  OutputMap out = floats_out();
  out.fields[0] = {.place = kLittle, .scale = -2, .offset = 1, .least = -5, .most = 3};
  EXPECT_EQ(sent(out, 1, 0), "0000000000000000") << "a zero without sign";
  EXPECT_EQ(sent(out, -99, 0), "0000404000000000");  // 3
  EXPECT_EQ(carried(out.fields[0], -99), -5);
}

TEST(ReportMapFloat, WhatIsNoNumberIsNoReadingAndIsNeverSent) {
  for (const char* bad : {"0000807f00000000", "000080ff00000000", "0000c07f00000000",
                          "000000007f800001", "00000000ffc00000", "00000000ff800000"})
    EXPECT_EQ(decode(floats_in(), bytes(bad)).received, Received::out_of_range) << bad;
  EXPECT_EQ(decode(floats_in(), bytes("ffff7f7fff7fffff")).received, Received::ok);
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    EXPECT_EQ(sent(floats_out(), 0, bad), "refused");
}

TEST(ReportMapFloat, TooLargeOnesAreTheLargest) {
  for (const double large : {1e39, 1e308, std::nextafter(double{FLT_MAX}, 1e39)}) {
    const auto encoded = encode(floats_out(), std::array{large, -large}, 0);
    ASSERT_TRUE(encoded);
    EXPECT_EQ(hex(encoded->report()), "ffff7f7fff7fffff");
    EXPECT_EQ(encoded->saturated, 3U);
  }
  EXPECT_EQ(encode(floats_out(), std::array{double{FLT_MAX}, 0.0}, 0)->saturated, 0U);
  EXPECT_EQ(sent(floats_out(1e-300), 1e300, 0), "ffff7f7f00000000");
}

TEST(ReportMapFloat, HaveThirtyTwoBitsInWholeBytesAndDoNotCount) {
  const auto fault = [](Place place) {
    place.is_float = true;
    return check(InputMap{.report_bytes = 9, .fields = {{.place = place}}}).fault;
  };
  EXPECT_EQ(fault({.offset_bits = 8, .width_bits = 32}), Fault::none);
  for (const std::uint32_t width : {1U, 16U, 24U, 31U, 33U, 64U})
    EXPECT_EQ(fault({.width_bits = width}), Fault::width) << width;
  for (const std::uint32_t offset : {1U, 4U, 7U, 9U, 39U})
    EXPECT_EQ(fault({.offset_bits = offset, .width_bits = 32}), Fault::alignment) << offset;
  EXPECT_EQ(fault({.offset_bits = 48, .width_bits = 32}), Fault::overrun);
  InputMap counting = floats_in();
  counting.fields[0].modulus = 4000;
  EXPECT_EQ(check(counting), (Problem{Fault::modulus, 0}));
  InputMap numbered = floats_in();
  numbered.report_bytes = 12;
  numbered.sequence = SequenceField{
      .place = {.offset_bits = 64, .width_bits = 32, .is_float = true}, .modulus = 100};
  EXPECT_EQ(check(numbered), (Problem{Fault::modulus, kMostFields}));
  OutputMap beating = floats_out();
  beating.report_bytes = 12;
  beating.heartbeat = numbered.sequence->place;
  EXPECT_EQ(check(beating), (Problem{Fault::width, kMostFields}));
  OutputMap steep = floats_out(1e300);
  EXPECT_EQ(check(steep), (Problem{Fault::scale, 0})) << "a value would be infinite";
}

TEST(ReportMapFloat, TheSafeReportIsZeroWhateverTheScale) {
  EXPECT_EQ(hex(safe_report(floats_out(-3), 0).report()), "0000000000000000");
  OutputMap map = floats_out();
  map.safe = bytes("0000803f00000000");
  EXPECT_EQ(safe_report(map, 0).raw[0], 0x3f800000);
}

TEST(ReportMapFloat, CarriedIsWhatTheWireSays) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 50000; ++i) {
    const bool is_float = i % 2 == 0;
    const double scale = std::ldexp(uniform(random), static_cast<int>(random() % 60) - 30);
    const double offset = is_float ? uniform(random) : 0;
    const OutputField field{
        .place = {.width_bits = is_float ? 32U : 1 + static_cast<std::uint32_t>(random() % 64),
                  .is_signed = random() % 2 == 0,
                  .is_float = is_float},
        .scale = scale,
        .offset = offset};
    const double value = std::ldexp(uniform(random), static_cast<int>(random() % 80) - 40);
    const auto encoded = encode({.report_bytes = 8, .fields = {field}}, std::span(&value, 1), 0);
    ASSERT_TRUE(encoded);
    const InputMap back{.report_bytes = 8,
                        .fields = {{.place = field.place, .scale = scale, .offset = offset}}};
    const Reading reading = decode(back, encoded->report());
    ASSERT_EQ(reading.received, Received::ok);
    ASSERT_EQ(reading.value[0], carried(field, value));
    ASSERT_EQ(reading.raw[0], encoded->raw[0]);
    if (is_float && encoded->saturated == 0) {
      ASSERT_NEAR(reading.value[0], value,
                  std::ldexp(std::abs(value - offset) + std::abs(offset), -23));
    }
  }
}

}  // namespace
}  // namespace hapticd::hid
