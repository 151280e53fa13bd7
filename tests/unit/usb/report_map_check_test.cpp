#include <cmath>

#include "drivers/hid/report_map.h"
#include "tests/unit/usb/vectors.h"

namespace hapticd::hid {
namespace {

using usb::bytes;
using usb::each_vector;
using usb::Json;

/// Where the vectors give no other reason, any will do.
void expect_refused(const Problem& problem, const std::string& why) {
  if (why == "zero width") {
    EXPECT_EQ(problem.fault, Fault::width);
  } else if (why == "field runs past report length") {
    EXPECT_EQ(problem.fault, Fault::overrun);
  } else {
    EXPECT_NE(problem.fault, Fault::none);
  }
}

TEST(ReportMapCheck, RefusesTheMapsOfTheVectors) {
  each_vector("report_map_config_reject", [](const Json& vector) {
    const auto size = vector.at("report_bytes").get<std::size_t>();
    expect_refused(check(usb::input_map_of(vector, size)), vector.at("why"));
    expect_refused(check(usb::output_map_of(vector, size)), vector.at("why"));
  });
}

Fault fault_of(Place place, std::size_t report_bytes = 8,
               std::optional<std::uint8_t> id = std::nullopt) {
  return check(
             InputMap{.report_id = id, .report_bytes = report_bytes, .fields = {{.place = place}}})
      .fault;
}

TEST(ReportMapCheck, PlacesAreInsideTheReport) {
  EXPECT_EQ(fault_of({.offset_bits = 0, .width_bits = 64}), Fault::none);
  EXPECT_EQ(fault_of({.offset_bits = 1, .width_bits = 64}), Fault::overrun);
  EXPECT_EQ(fault_of({.offset_bits = 63, .width_bits = 1}), Fault::none);
  EXPECT_EQ(fault_of({.offset_bits = 64, .width_bits = 1}), Fault::overrun);
  EXPECT_EQ(fault_of({.offset_bits = 0xffffffff, .width_bits = 64}), Fault::overrun);
  EXPECT_EQ(fault_of({.offset_bits = 0, .width_bits = 65}), Fault::width);
  EXPECT_EQ(fault_of({.offset_bits = 0, .width_bits = 0xffffffff}), Fault::width);
  EXPECT_EQ(fault_of({.offset_bits = 4, .width_bits = 8, .endian = Endian::big}), Fault::alignment);
  EXPECT_EQ(fault_of({.offset_bits = 8, .width_bits = 12, .endian = Endian::big}),
            Fault::alignment);
  EXPECT_EQ(fault_of({.offset_bits = 8, .width_bits = 24, .endian = Endian::big}), Fault::none);
}

TEST(ReportMapCheck, ReportsHaveALengthAndAnIdOrNone) {
  const Place bit{.offset_bits = 8, .width_bits = 1};
  EXPECT_EQ(fault_of(bit, 0), Fault::report_length);
  EXPECT_EQ(fault_of(bit, 65), Fault::report_length);
  EXPECT_EQ(fault_of(bit, 64), Fault::none);
  EXPECT_EQ(fault_of(bit, 1, std::uint8_t{1}), Fault::report_length);
  EXPECT_EQ(fault_of(bit, 2, std::uint8_t{1}), Fault::none);
  EXPECT_EQ(fault_of(bit, 2, std::uint8_t{0}), Fault::report_id);
  EXPECT_EQ(fault_of({.offset_bits = 7, .width_bits = 1}, 2, std::uint8_t{1}), Fault::overlap);
  InputMap many{.report_bytes = 64};
  for (std::uint32_t i = 0; i < 17; ++i)
    many.fields.push_back({.place = {.offset_bits = i, .width_bits = 1}});
  EXPECT_EQ(check(many), (Problem{Fault::too_many_fields, kMostFields}));
}

TEST(ReportMapCheck, NoBitIsUsedTwice) {
  InputMap in = usb::woodenhaptics_in();
  EXPECT_EQ(check(in).fault, Fault::none);
  in.fields[1].place.offset_bits = 31;
  EXPECT_EQ(check(in), (Problem{Fault::overlap, 2}));
  in = usb::woodenhaptics_in();
  in.sequence->place.offset_bits = 47;
  EXPECT_EQ(check(in), (Problem{Fault::overlap, kMostFields}));
  OutputMap out = usb::woodenhaptics_out();
  out.constants = {{.at = 5, .value = 1}};
  EXPECT_EQ(check(out), (Problem{Fault::overlap, kMostFields}));
  out.constants = {{.at = 8, .value = 1}};
  EXPECT_EQ(check(out).fault, Fault::overrun);
  out.constants = {{.at = 6, .value = 1}};
  EXPECT_EQ(check(out).fault, Fault::none);
  out.heartbeat = Place{.offset_bits = 48, .width_bits = 8};
  EXPECT_EQ(check(out).fault, Fault::overlap);
  out.heartbeat = Place{.offset_bits = 56, .width_bits = 8};
  EXPECT_EQ(check(out).fault, Fault::none);
}

TEST(ReportMapCheck, NumbersStayFinite) {
  for (const double scale : {0.0, std::nan(""), HUGE_VAL, 1e308}) {
    InputMap in = usb::woodenhaptics_in();
    in.fields[1].scale = scale;
    EXPECT_EQ(check(in), (Problem{Fault::scale, 1})) << scale;
    OutputMap out = usb::woodenhaptics_out();
    out.fields[2].scale = scale;
    EXPECT_EQ(check(out), (Problem{Fault::scale, 2})) << scale;
  }
  InputMap in = usb::woodenhaptics_in();
  in.fields[0].offset = std::nan("");
  EXPECT_EQ(check(in), (Problem{Fault::scale, 0}));
}

TEST(ReportMapCheck, ModulesAreWhatTheBitsCanCount) {
  const auto with = [](std::uint64_t modulus) {
    InputMap map = usb::woodenhaptics_in();
    map.fields[0].modulus = modulus;
    return check(map).fault;
  };
  for (const std::uint64_t bad : {0ULL, 1ULL, 65537ULL, ~0ULL})
    EXPECT_EQ(with(bad), Fault::modulus);
  for (const std::uint64_t good : {2ULL, 4000ULL, 65536ULL}) EXPECT_EQ(with(good), Fault::none);
  InputMap wide{.report_bytes = 8,
                .fields = {{.place = {.width_bits = 33}, .modulus = std::uint64_t{1} << 32}}};
  EXPECT_EQ(check(wide).fault, Fault::modulus);
  InputMap counted{.report_bytes = 8, .sequence = SequenceField{.place = {.width_bits = 64}}};
  EXPECT_EQ(check(counted).fault, Fault::modulus);
  counted.sequence->place = {.width_bits = 8, .is_signed = true};
  EXPECT_EQ(check(counted).fault, Fault::modulus);
  counted.sequence->place = {.width_bits = 1};
  EXPECT_EQ(check(counted).fault, Fault::none);
}

TEST(ReportMapCheck, ThereIsAWayToSayZero) {
  const auto with = [](OutputField field) {
    return check(OutputMap{.report_bytes = 2, .fields = {field}});
  };
  const Place byte{.offset_bits = 0, .width_bits = 8};
  EXPECT_EQ(with({.place = byte}).fault, Fault::none);
  EXPECT_EQ(with({.place = byte, .offset = 1}), (Problem{Fault::no_zero, 0}));
  EXPECT_EQ(with({.place = byte, .offset = -128}).fault, Fault::none);
  EXPECT_EQ(with({.place = byte, .offset = -256}).fault, Fault::no_zero);
  EXPECT_EQ(with({.place = byte, .least = 1, .most = 2}).fault, Fault::no_zero);
  EXPECT_EQ(with({.place = byte, .least = 2, .most = 1}).fault, Fault::limits);
  EXPECT_EQ(with({.place = byte, .least = std::nan("")}).fault, Fault::limits);
}

TEST(ReportMapCheck, EveryFaultHasWords) {
  EXPECT_TRUE(words(Fault::none).empty());
  for (int fault = 1; fault <= static_cast<int>(Fault::safe_report); ++fault)
    EXPECT_FALSE(words(static_cast<Fault>(fault)).empty()) << fault;
}

}  // namespace
}  // namespace hapticd::hid
