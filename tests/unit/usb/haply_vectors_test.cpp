// Haply's boards speak over a serial line. Their reports are fields of single precision all the same: maps have to be able to
// say them, since many boards of one's own send such ones over HID.
#include "tests/unit/usb/vectors.h"

namespace hapticd::hid {
namespace {

using usb::bytes;
using usb::each_vector;
using usb::hex;
using usb::Json;

Place single_at(std::size_t byte) {
  return {.offset_bits = static_cast<std::uint32_t>(8 * byte), .width_bits = 32, .is_float = true};
}

TEST(HaplyVectors, AnglesAreReadThroughAMap) {
  each_vector("haply_hapi_serial_read", [](const Json& vector) {
    const auto report = bytes(vector, "hex");
    const Json& values = vector.at("values");
    InputMap map{.report_bytes = report.size(), .fields = {{.place = {.width_bits = 8}}}};
    for (std::size_t i = 0; i < values.size(); ++i)
      map.fields.push_back({.place = single_at(1 + 4 * i)});
    ASSERT_EQ(check(map).fault, Fault::none);
    const Reading reading = decode(map, report);
    ASSERT_EQ(reading.received, Received::ok);
    EXPECT_EQ(reading.raw[0], vector.at("device_id").get<std::int64_t>());
    for (std::size_t i = 0; i < values.size(); ++i)
      EXPECT_EQ(reading.value[1 + i], static_cast<double>(values.at(i).get<float>()));
  });
}

TEST(HaplyVectors, TorquesAreWrittenThroughAMap) {
  each_vector("haply_hapi_serial_write", [](const Json& vector) {
    constexpr std::uint8_t kWrite = 2;
    const auto report = bytes(vector, "hex");
    OutputMap map{.report_bytes = report.size(),
                  .constants = {{.at = 0, .value = kWrite},
                                {.at = 1, .value = vector.at("device_id").get<std::uint8_t>()}}};
    for (const Json& pwm : vector.at("pwm"))
      map.constants.push_back({.at = map.constants.size(), .value = pwm.get<std::uint8_t>()});
    std::vector<double> torques;
    for (const Json& torque : vector.at("torques")) {
      map.fields.push_back({.place = single_at(map.constants.size() + 4 * torques.size())});
      torques.push_back(torque.get<double>());
    }
    ASSERT_EQ(check(map).fault, Fault::none);
    const auto encoded = encode(map, torques, 0);
    ASSERT_TRUE(encoded);
    EXPECT_EQ(hex(encoded->report()), vector.at("hex"));
  });
}

}  // namespace
}  // namespace hapticd::hid
