// Random maps against a reference that knows nothing but single bits.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/unit/usb/vectors.h"

namespace hapticd::hid {
namespace {

using Random = std::mt19937_64;

/// Bit `i` of the number at `place`, the lowest first, as a bit of the report.
std::size_t bit_of(const Place& place, std::uint32_t i) {
  if (place.endian == Endian::little) return place.offset_bits + i;
  const std::uint32_t byte_from_last = i / 8;
  return place.offset_bits + place.width_bits - 8 * (byte_from_last + 1) + i % 8;
}
bool bit_at(std::span<const std::uint8_t> report, std::size_t bit) {
  return ((report[bit / 8] >> (bit % 8)) & 1) != 0;
}
std::uint64_t reference_bits(std::span<const std::uint8_t> report, const Place& place) {
  std::uint64_t bits = 0;
  for (std::uint32_t i = 0; i < place.width_bits; ++i)
    if (bit_at(report, bit_of(place, i))) bits |= 1ULL << i;
  return bits;
}
std::int64_t reference_raw(std::span<const std::uint8_t> report, const Place& place) {
  std::uint64_t bits = reference_bits(report, place);
  const bool negative = place.is_signed && bit_at(report, bit_of(place, place.width_bits - 1));
  for (std::uint32_t i = place.width_bits; negative && i < 64; ++i) bits |= 1ULL << i;
  return static_cast<std::int64_t>(bits);
}
void reference_write(usb::Bytes& report, const Place& place, std::uint64_t bits) {
  for (std::uint32_t i = 0; i < place.width_bits; ++i) {
    const std::size_t bit = bit_of(place, i);
    const auto one = static_cast<std::uint8_t>(1U << (bit % 8));
    const bool set = ((bits >> i) & 1) != 0;
    report[bit / 8] =
        static_cast<std::uint8_t>(set ? report[bit / 8] | one : report[bit / 8] & ~one);
  }
}

Place any_place(Random& random, std::uint32_t least_bit) {
  Place place{.offset_bits = least_bit + static_cast<std::uint32_t>(random() % 12),
              .width_bits = 1 + static_cast<std::uint32_t>(random() % 64),
              .is_signed = random() % 2 == 0,
              .endian = random() % 3 == 0 ? Endian::big : Endian::little};
  if (place.endian == Endian::big) {
    place.offset_bits = (place.offset_bits + 7) / 8 * 8;
    place.width_bits = (place.width_bits + 7) / 8 * 8;
  }
  return place;
}
/// Places one after the other with gaps, as many as there is room for.
std::vector<Place> any_places(Random& random, std::uint32_t from_bit, std::size_t report_bytes) {
  std::vector<Place> places;
  while (places.size() < kMostFields) {
    const Place place = any_place(random, from_bit);
    from_bit = place.offset_bits + place.width_bits;
    if (from_bit > report_bytes * 8) break;
    places.push_back(place);
  }
  std::shuffle(places.begin(), places.end(), random);
  return places;
}

struct Maps {
  InputMap in;
  OutputMap out;
};
Maps any_maps(Random& random) {
  Maps maps;
  const bool numbered = random() % 2 == 0;
  const std::size_t size = (numbered ? 2 : 1) + random() % 63;
  if (numbered) maps.in.report_id = static_cast<std::uint8_t>(1 + random() % 255);
  maps.in.report_bytes = maps.out.report_bytes = size;
  maps.out.report_id = maps.in.report_id;
  for (const Place& place : any_places(random, numbered ? 8 : 0, size)) {
    maps.in.fields.push_back({.place = place});
    maps.out.fields.push_back({.place = place});
  }
  return maps;
}

/// A whole number that the place holds, and a double too.
double any_number(Random& random, const Place& place) {
  const std::uint32_t bits = std::min<std::uint32_t>(place.width_bits, 53);
  const auto number = static_cast<std::int64_t>(random() >> (64 - bits));
  return static_cast<double>(place.is_signed ? number - (1LL << (bits - 1)) : number);
}

TEST(ReportMapRandom, ReadsTheBitsThatTheReferenceReads) {
  Random random(11);
  std::size_t fields = 0;
  for (int i = 0; i < 20000; ++i) {
    const InputMap map = any_maps(random).in;
    ASSERT_EQ(check(map).fault, Fault::none);
    usb::Bytes report(map.report_bytes);
    for (std::uint8_t& byte : report) byte = static_cast<std::uint8_t>(random());
    if (map.report_id) report[0] = *map.report_id;
    const Reading reading = decode(map, report);
    ASSERT_EQ(reading.received, Received::ok);
    for (std::size_t at = 0; at < map.fields.size(); ++at, ++fields)
      ASSERT_EQ(reading.raw[at], reference_raw(report, map.fields[at].place)) << usb::hex(report);
  }
  EXPECT_GT(fields, 60000U);
}

TEST(ReportMapRandom, WritesTheBitsThatTheReferenceWritesAndNoOthers) {
  Random random(12);
  for (int i = 0; i < 20000; ++i) {
    const Place place = any_place(random, static_cast<std::uint32_t>(random() % 400));
    usb::Bytes report(64);
    for (std::uint8_t& byte : report) byte = static_cast<std::uint8_t>(random());
    usb::Bytes expected = report;
    const std::uint64_t bits = random();
    write_bits(report, place, bits);
    reference_write(expected, place, bits);
    ASSERT_EQ(report, expected) << place.offset_bits << " " << place.width_bits;
  }
}

TEST(ReportMapRandom, EveryNumberComesBack) {
  Random random(13);
  for (int i = 0; i < 20000; ++i) {
    const Maps maps = any_maps(random);
    ASSERT_EQ(check(maps.out).fault, Fault::none);
    std::vector<double> values;
    usb::Bytes expected(maps.out.report_bytes);
    if (maps.out.report_id) expected[0] = *maps.out.report_id;
    for (const OutputField& field : maps.out.fields) {
      values.push_back(any_number(random, field.place));
      reference_write(expected, field.place,
                      static_cast<std::uint64_t>(static_cast<std::int64_t>(values.back())));
    }
    const auto encoded = encode(maps.out, values, 0);
    ASSERT_TRUE(encoded);
    ASSERT_EQ(encoded->saturated, 0U);
    ASSERT_EQ(usb::hex(encoded->report()), usb::hex(expected));
    const Reading reading = decode(maps.in, encoded->report());
    ASSERT_EQ(reading.received, Received::ok);
    for (std::size_t at = 0; at < values.size(); ++at) {
      ASSERT_EQ(reading.value[at], values[at]);
      ASSERT_EQ(reading.raw[at], encoded->raw[at]);
    }
  }
}

TEST(ReportMapRandom, WhatIsSentIsWithinHalfAStepOrClipped) {
  Random random(14);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::size_t clipped = 0, exact = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto width = static_cast<std::uint32_t>(2 + random() % 31);
    const double scale = std::ldexp(uniform(random), static_cast<int>(random() % 20) - 10);
    const OutputField field{.place = {.offset_bits = static_cast<std::uint32_t>(random() % 8),
                                      .width_bits = width,
                                      .is_signed = true},
                            .scale = scale};
    const OutputMap map{.report_bytes = 9, .fields = {field}};
    ASSERT_EQ(check(map).fault, Fault::none);
    const double value = 1.2 * uniform(random) * std::ldexp(scale, static_cast<int>(width) - 1);
    const auto encoded = encode(map, std::span(&value, 1), 0);
    ASSERT_TRUE(encoded);
    const double sent = static_cast<double>(encoded->raw[0]) * scale;
    if (encoded->saturated != 0) {
      ASSERT_LE(std::abs(sent), std::abs(value));
      ++clipped;
    } else {
      ASSERT_LE(std::abs(sent - value), 0.5 * std::abs(scale) * (1 + 1e-6));
      ++exact;
    }
    ASSERT_GE(sent * value, 0) << "no force against the one that was asked for";
  }
  EXPECT_GT(clipped, 10000U);
  EXPECT_GT(exact, 50000U);
}

}  // namespace
}  // namespace hapticd::hid
