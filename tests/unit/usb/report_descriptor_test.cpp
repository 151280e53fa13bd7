#include "drivers/hid/report_descriptor.h"

#include <random>

#include "tests/unit/usb/vectors.h"

namespace hapticd::hid {
namespace {

using usb::bytes;

/// Raw HID as the Teensy has it: 64 bytes each way, without ids.
const char* const kRawHid =
    "06abff0a0002a1017508150026ff009540"
    "09018102"
    "95400902"
    "9102c0";
/// A gamepad with ids: report 1 of 64 buttons and 8 axes of 16 bits in, report 5 of two fields out, feature 0x12.
const char* const kGamepadDescriptor =
    "05010904a101"
    "8501050919012940150025017501954081020501"
    "160180"
    "26ff7f"
    "75109508"
    "0930093109320933093409350937093681"
    "02"
    "050f0921a1028505150125287508950109229102"
    "0970160180"
    "26ff7f751095019102c0"
    "09aba102851209227508950415002628"
    "00b102c0"
    "c0";

ReportDescriptor parsed(const char* text) {
  auto descriptor = parse_descriptor(bytes(text));
  EXPECT_TRUE(descriptor) << (descriptor ? "" : descriptor.error().text);
  return descriptor.value_or(ReportDescriptor{});
}
std::string refusal(const std::string& text) {
  const auto descriptor = parse_descriptor(bytes(text));
  return descriptor ? "taken" : descriptor.error().text;
}
std::string in_collection(const std::string& items) {
  return "a101" + items + "c0";
}
const std::string kByte = "750895018102";  // one input of 8 bits

TEST(ReportDescriptor, RawHidHas64BytesEachWay) {
  const ReportDescriptor raw = parsed(kRawHid);
  EXPECT_FALSE(raw.numbered);
  EXPECT_EQ(raw.report_bytes(ReportKind::input, 0), 64U);
  EXPECT_EQ(raw.report_bytes(ReportKind::output, 0), 64U);
  EXPECT_EQ(raw.report_bytes(ReportKind::feature, 0), 0U);
  EXPECT_EQ(raw.report_bytes(ReportKind::input, 1), 0U);
  EXPECT_EQ(raw.applications, std::vector<Usage>{0xffab0200});
  EXPECT_EQ(raw.fields.at(0).usages.at(0).first, 0xffab0001U);
}

TEST(ReportDescriptor, NumberedReportsCountTheirId) {
  const ReportDescriptor pad = parsed(kGamepadDescriptor);
  EXPECT_TRUE(pad.numbered);
  EXPECT_EQ(pad.report_bytes(ReportKind::input, 1), 25U);
  EXPECT_EQ(pad.report_bytes(ReportKind::output, 5), 4U);
  EXPECT_EQ(pad.report_bytes(ReportKind::feature, 0x12), 5U);
  EXPECT_EQ(pad.report_bytes(ReportKind::output, 1), 0U);
  EXPECT_EQ(pad.applications, std::vector<Usage>{0x00010004});
}

TEST(ReportDescriptor, FindsUsagesWhereTheyLie) {
  const ReportDescriptor pad = parsed(kGamepadDescriptor);
  const auto x = find(pad, ReportKind::input, 0x00010030);
  ASSERT_TRUE(x);
  EXPECT_EQ(x->report_id, 1);
  EXPECT_EQ(x->place, usb::int16_at(72));
  EXPECT_EQ(find(pad, ReportKind::input, 0x00010036)->place, usb::int16_at(72 + 7 * 16));
  const auto button = find(pad, ReportKind::input, 0x00090007);
  ASSERT_TRUE(button);
  EXPECT_EQ(button->place, (Place{.offset_bits = 14, .width_bits = 1}));
  EXPECT_EQ(find(pad, ReportKind::output, 0x000f0070)->place, usb::int16_at(16));
  EXPECT_FALSE(find(pad, ReportKind::output, 0x00010030));
  EXPECT_FALSE(find(pad, ReportKind::input, 0x00090041));
}

TEST(ReportDescriptor, MapsMustFitTheirReport) {
  const ReportDescriptor pad = parsed(kGamepadDescriptor);
  InputMap map{.report_id = 1, .report_bytes = 25, .fields = {{.place = usb::int16_at(72)}}};
  EXPECT_EQ(fit(pad, map), Fit::ok);
  map.report_id = 2;
  EXPECT_EQ(fit(pad, map), Fit::no_such_report);
  map.report_id.reset();
  EXPECT_EQ(fit(pad, map), Fit::no_such_report);
  map.report_id = 1;
  map.report_bytes = 24;
  EXPECT_EQ(fit(pad, map), Fit::report_length);
  OutputMap out{.report_id = 5, .report_bytes = 4, .fields = {{.place = usb::int16_at(16)}}};
  EXPECT_EQ(fit(pad, out), Fit::ok);
  out.report_id = 1;
  EXPECT_EQ(fit(pad, out), Fit::no_such_report);
  EXPECT_EQ(fit(parsed(kRawHid), usb::woodenhaptics_in()), Fit::report_length);
  const ReportDescriptor eight = parsed("06abff0a0002a1017508150026ff0095080901810209029102c0");
  EXPECT_EQ(fit(eight, usb::woodenhaptics_in()), Fit::ok);
  EXPECT_EQ(fit(eight, usb::woodenhaptics_out()), Fit::ok);
}

TEST(ReportDescriptor, FieldsLieWithinTheDeclaredBits) {
  // 12 bits in and 12 out: two bytes each, of which the last four bits are nothing.
  const ReportDescriptor twelve =
      parsed((in_collection("0901750c95018102") + in_collection("0901750c95019102")).c_str());
  EXPECT_EQ(twelve.report_bytes(ReportKind::input, 0), 2U);
  InputMap in{.report_bytes = 2, .fields = {{.place = {.offset_bits = 0, .width_bits = 12}}}};
  EXPECT_EQ(fit(twelve, in), Fit::ok);
  in.fields[0].place.offset_bits = 1;
  EXPECT_EQ(fit(twelve, in), Fit::outside);
  in.fields.clear();
  in.sequence = SequenceField{.place = {.offset_bits = 12, .width_bits = 1}};
  EXPECT_EQ(fit(twelve, in), Fit::outside);
  OutputMap out{.report_bytes = 2, .heartbeat = Place{.offset_bits = 8, .width_bits = 8}};
  EXPECT_EQ(fit(twelve, out), Fit::outside);
  out.heartbeat = Place{.offset_bits = 8, .width_bits = 4};
  EXPECT_EQ(fit(twelve, out), Fit::ok);
}

TEST(ReportDescriptor, PushPopLongItemsAndAlternativesAreUnderstood) {
  const ReportDescriptor pushed = parsed(in_collection("75089501a4751095028102b48102").c_str());
  EXPECT_EQ(pushed.report_bytes(ReportKind::input, 0), 5U);
  const ReportDescriptor with_long = parsed(in_collection("fe03f0c0c0c0" + kByte).c_str());
  EXPECT_EQ(with_long.report_bytes(ReportKind::input, 0), 1U);
  const ReportDescriptor either = parsed(in_collection("0501a9010930"
                                                       "0931a9000932"
                                                       "750895028102")
                                             .c_str());
  EXPECT_EQ(find(either, ReportKind::input, 0x00010030)->place.offset_bits, 0U);
  EXPECT_FALSE(find(either, ReportKind::input, 0x00010031));
  EXPECT_EQ(find(either, ReportKind::input, 0x00010032)->place.offset_bits, 8U);
}

TEST(ReportDescriptor, PaddingAndArraysHaveNoUsageOfTheirOwn) {
  // X as padding, X as an array, X as itself.
  const ReportDescriptor padded = parsed(in_collection("050175089501"
                                                       "09308103"
                                                       "09308100"
                                                       "09308102")
                                             .c_str());
  EXPECT_EQ(padded.report_bytes(ReportKind::input, 0), 3U);
  EXPECT_EQ(find(padded, ReportKind::input, 0x00010030)->place.offset_bits, 16U);
}

TEST(ReportDescriptor, RefusesWhatIsMalformed) {
  EXPECT_EQ(refusal(in_collection(kByte)), "taken");
  const std::vector<std::pair<std::string, std::string>> bad{
      {"", "no report has a field"},
      {in_collection(""), "no report has a field"},
      {"a101" + kByte, "not closed"},
      {kByte, "outside"},
      {in_collection(kByte) + "c0", "not open"},
      {in_collection("8500" + kByte), "not 1 to 255"},
      {in_collection("860001" + kByte), "not 1 to 255"},
      {in_collection(kByte + "8501" + kByte), "after fields without"},
      {in_collection("a48501b4" + kByte), "without report id"},
      {in_collection("b4" + kByte), "pop without push"},
      {in_collection("760101"
                     "95018102"),
       "more than 256 bits"},
      {in_collection("75ff"
                     "97ffffffff8102"),
       "more elements"},
      {in_collection("7508"
                     "9601108102"),
       "4096 bytes"},
      {in_collection("2905" + kByte), "without minimum"},
      {in_collection("19052901" + kByte), "do not match"},
      {in_collection("1905"
                     "2b00000100" +
                     kByte),
       "do not match"},
      {in_collection("0700000100" + kByte), "usage page"},
      {in_collection(kByte) + "fe", "cut off"},
      {in_collection(kByte) + "fe05f000", "cut off"},
      {in_collection(kByte) + "77010203", "cut off"},
  };
  for (const auto& [text, why] : bad)
    EXPECT_NE(refusal(text).find(why), std::string::npos) << text << ": " << refusal(text);
}

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(ReportDescriptor, RefusesWhatIsTooMuch) {
  EXPECT_NE(refusal(repeated("a101", 17)).find("deep"), std::string::npos);
  EXPECT_NE(refusal(repeated("a4", 17)).find("deep"), std::string::npos);
  EXPECT_NE(refusal(in_collection(repeated("0901", 257) + kByte)).find("usages"),
            std::string::npos);
  EXPECT_EQ(refusal(in_collection("75019501" + repeated("8102", 256))), "taken");
  EXPECT_NE(refusal(in_collection("75019501" + repeated("8102", 257))).find("256 fields"),
            std::string::npos);
  EXPECT_NE(refusal(repeated("00", 4097)).find("4096 bytes"), std::string::npos);
}

/// What holds of everything that is taken, however it came about.
void expect_sound(const ReportDescriptor& descriptor) {
  ASSERT_LE(descriptor.fields.size(), kMostDescribedFields);
  for (const ReportField& field : descriptor.fields) {
    ASSERT_EQ(descriptor.numbered, field.report_id != 0);
    const std::size_t end = field.offset_bits + std::size_t{field.element_bits} * field.count;
    ASSERT_GE(field.offset_bits, descriptor.numbered ? 8U : 0U);
    ASSERT_LE((end + 7) / 8, descriptor.report_bytes(field.kind, field.report_id));
    ASSERT_LE(end, kMostReportBits);
    for (const UsageRange& range : field.usages) {
      const auto found = find(descriptor, field.kind, range.last);
      if (!found) continue;
      ASSERT_LE((found->place.offset_bits + found->place.width_bits + 7) / 8,
                descriptor.report_bytes(field.kind, found->report_id));
    }
  }
}

TEST(ReportDescriptor, IsSoundOrRefusedWhereverItIsCutOff) {
  for (const char* text : {kRawHid, kGamepadDescriptor}) {
    const auto all = bytes(text);
    for (std::size_t size = 0; size < all.size(); ++size)
      ASSERT_FALSE(parse_descriptor(std::span(all).first(size))) << size;
    expect_sound(parsed(text));
  }
}

TEST(ReportDescriptor, IsSoundOrRefusedWhateverChanges) {
  std::mt19937 random(15);
  int taken = 0;
  for (int i = 0; i < 100000; ++i) {
    auto changed = bytes(i % 2 == 0 ? kRawHid : kGamepadDescriptor);
    for (unsigned n = 1 + random() % 4; n > 0; --n)
      changed[random() % changed.size()] = static_cast<std::uint8_t>(random());
    const auto descriptor = parse_descriptor(changed);
    if (!descriptor) continue;
    ++taken;
    expect_sound(*descriptor);
  }
  EXPECT_GT(taken, 10000);
}

TEST(ReportDescriptor, IsSoundOrRefusedWithAnyBytes) {
  std::mt19937 random(16);
  for (int i = 0; i < 20000; ++i) {
    usb::Bytes any(random() % 200);
    for (std::uint8_t& byte : any) byte = static_cast<std::uint8_t>(random());
    const auto descriptor = parse_descriptor(any);
    if (descriptor) expect_sound(*descriptor);
  }
}

}  // namespace
}  // namespace hapticd::hid
