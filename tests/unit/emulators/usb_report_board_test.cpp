// Emulated raw HID boards: layouts against the vectors, and how they take reports.
#include <gtest/gtest.h>

#include "sim/usb/report_board.h"
#include "tests/unit/emulators/usb_host.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::usb;

ReportField field_of(const Json& field) {
  return {.offset_bits = field.at("bit_offset").get<std::size_t>(),
          .width_bits = field.at("bit_width").get<unsigned>(),
          .is_signed = field.at("signed").get<bool>(),
          .big_endian = field.at("endian") == "big"};
}

TEST(ReportVectors, FieldsAreReadAndWritten) {
  for (const char* group : {"report_map_decode", "report_map_encode"})
    each_usb_vector(group, [group](const Json& vector) {
      const bool numbered = vector.contains("report_id") && !vector.at("report_id").is_null();
      const UsbBytes report = usb_bytes(vector, "report_hex");
      const auto body = std::span(report).subspan(numbered ? 1 : 0);
      UsbBytes again(body.size());
      for (const Json& field : vector.at("fields")) {
        const std::string name = field.at("name").get<std::string>();
        const Json& raw =
            vector.at(std::string(group).ends_with("decode") ? "values" : "raw").at(name);
        const auto value = raw.at("raw").get<std::int64_t>();
        EXPECT_EQ(get_field(body, field_of(field)), value) << name;
        put_field(again, field_of(field), value);
        EXPECT_EQ(get_field(again, field_of(field)), value) << name;
      }
      if (std::string(group).ends_with("encode")) {
        EXPECT_EQ(hex_of(again), hex_of(body));
      }
    });
}

TEST(ReportVectors, WoodenHapticsReports) {
  each_usb_vector("woodenhaptics_in", [](const Json& vector) {
    ReportBoard board(wooden_haptics());
    for (std::size_t i = 0; i < 3; ++i)
      board.motor(i).move_to(vector.at("encoders")[i].get<double>(), 0);
    UsbHost host(board);
    std::optional<UsbBytes> report;
    for (int i = 0; i <= vector.at("seq").get<int>(); ++i) report = host.read(1);
    ASSERT_TRUE(report);
    EXPECT_EQ(hex_of(*report), vector.at("hex").get<std::string>());
  });
  each_usb_vector("woodenhaptics_out", [](const Json& vector) {
    ReportBoard board(wooden_haptics());
    UsbHost host(board);
    UsbBytes bytes = usb_bytes(vector, "hidapi_write_hex");
    bytes.erase(bytes.begin());  // hidapi's 0 for "no report id" is not sent
    host.write(1, bytes);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(board.motor(i).torque(), 1e-3 * vector.at("mA")[i].get<double>(), 1e-12);
  });
}

TEST(ReportVectors, CountersWrap) {
  each_usb_vector("counter_unwrap16", [](const Json& vector) {
    ReportBoard board(wooden_haptics());
    UsbHost host(board);
    const Json& counts = vector.at("unwrapped");
    for (std::size_t i = 0; i < counts.size(); ++i) {
      board.motor(0).move_to(counts[i].get<double>(), 0);
      const auto report = host.read(1);
      ASSERT_TRUE(report);
      EXPECT_EQ(get_field(*report, {}), vector.at("raw16")[i].get<std::int64_t>());
    }
  });
}

TEST(ReportBoard, OneReportAFrameWithTheNewestCounts) {
  ReportBoard board(wooden_haptics());
  UsbHost host(board);
  for (int i = 0; i < 10; ++i) host.in(1);
  for (int i = 0; i < 10; ++i) {
    board.motor(2).move_to(100 * i, 0);
    host.run_to(i * 1'000'000);
    ASSERT_EQ(host.all.size(), static_cast<std::size_t>(i) + 1);
    EXPECT_EQ(get_field(host.all.back().bytes, {.offset_bits = 32}), 100 * i);
    EXPECT_EQ(get_field(host.all.back().bytes, {.offset_bits = 48}), i);
  }
}

TEST(ReportBoard, TheWatchdogTakesThePower) {
  ReportBoard board(wooden_haptics());
  UsbHost host(board);
  EXPECT_FALSE(board.motor(0).enabled());
  host.write(1, {0xe8, 0x03, 0, 0, 0, 0, 0, 0});
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 1);
  host.run_for(0.498);
  EXPECT_TRUE(board.power_on());
  host.run_for(0.002);
  EXPECT_FALSE(board.power_on());
  EXPECT_EQ(board.motor(0).torque(), 0);
  host.write(1, {0xe8, 0x03, 0, 0, 0, 0, 0, 0});
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 1);
}

TEST(ReportBoard, CurrentsBeyondTheLimitSaturate) {
  ReportBoard board(wooden_haptics());
  UsbHost host(board);
  host.write(1, {0xff, 0x7f, 0x00, 0x80, 0, 0, 0, 0});
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 3);
  EXPECT_DOUBLE_EQ(board.motor(1).torque(), -3);
}

TEST(ReportBoard, TheOldestReportIsTakenFirst) {
  ReportBoard board(wooden_haptics());
  const std::int64_t at_ns = 5'000'000;
  board.advance(at_ns);
  const auto send = [&board](std::uint8_t mA, std::int64_t now_ns) {
    return usb_acked(board.out(1, UsbBytes{mA, 0, 0, 0, 0, 0, 0, 0}, now_ns));
  };
  EXPECT_TRUE(send(1, at_ns));
  EXPECT_TRUE(send(2, at_ns));
  EXPECT_FALSE(send(3, at_ns));  // no room
  board.advance(at_ns);
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 0.001);
  EXPECT_TRUE(send(4, at_ns));
  board.advance(at_ns + 999'999);
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 0.001);
  board.advance(at_ns + 1'000'000);
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 0.002);
  board.advance(at_ns + 2'000'000);
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 0.004);
}

TEST(ReportBoard, AReportOfAnotherSizeOrIdIsIgnored) {
  ReportBoardOptions options = wooden_haptics();
  options.interfaces[0].out_id = 5;
  ReportBoard board(options);
  UsbHost host(board);
  host.write(1, UsbBytes(8, 1));
  host.write(1, UsbBytes{6, 1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(board.reports_taken(), 0u);
  host.write(1, UsbBytes{5, 1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(board.reports_taken(), 1u);
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 0.001);
}

TEST(ReportBoard, WithoutAnOutEndpointReportsComeByRequest) {
  ReportBoardOptions options = wooden_haptics();
  options.interfaces[0].out_endpoint = 0;
  options.oldest_first = false;
  ReportBoard board(options);
  UsbHost host(board);
  EXPECT_TRUE(usb_acked(host.ask({0x21, 9, 0x0200, 0, 8}, UsbBytes{0xe8, 3, 0, 0, 0, 0, 0, 0})));
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 1);
  EXPECT_EQ(host.ask({0xa1, 1, 0x0100, 0, 64}).bytes.size(), 8u);
  EXPECT_TRUE(usb_acked(host.ask({0x21, 0x0a, 0, 0, 0})));
  EXPECT_TRUE(usb_stalled(host.ask({0x21, 9, 0x0300, 0, 8}, UsbBytes(8))));
  const auto id = host.out(1, UsbBytes(8));
  host.run_for(1e-3);
  ASSERT_NE(host.done(id), nullptr);
  EXPECT_EQ(host.done(id)->end, End::stalled);
}

TEST(ReportBoard, ANumberedInputReportBeginsWithItsId) {
  ReportBoardOptions options = wooden_haptics();
  options.interfaces[0].in_id = 9;
  ReportBoard board(options);
  board.motor(0).move_to(258, 0);
  UsbHost host(board);
  const auto report = host.read(1);
  ASSERT_TRUE(report);
  EXPECT_EQ(hex_of(*report), "090201000000000000");
  const auto bits = usb_report_bits(board.report_descriptor(0));
  EXPECT_EQ(bits.at({0x80, 9}), 64u);
}

TEST(ReportBoard, OnlyABeatingHeartFeedsTheWatchdog) {
  ReportBoard board(teensy_raw_hid());
  UsbHost host(board);
  UsbBytes report(64);
  report[0] = 0x64;
  host.write(4, report);
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 0.1);
  for (int i = 0; i < 98; ++i) host.write(4, report);
  EXPECT_TRUE(board.power_on());
  host.write(4, report);
  host.write(4, report);
  EXPECT_FALSE(board.power_on());
  report[63] = 1;
  host.write(4, report);
  EXPECT_TRUE(board.power_on());
}

TEST(ReportBoard, TheTeensyHasASecondInterfaceOfAnotherUsage) {
  ReportBoard board(teensy_raw_hid());
  board.set_button(3, true);
  board.motor(1).move_to(-70000, 0);
  UsbHost host(board);
  const UsbBytes raw = host.ask({0x81, 6, 0x2200, 0, 255}).bytes;
  const UsbBytes serial = host.ask({0x81, 6, 0x2200, 1, 255}).bytes;
  EXPECT_EQ(hex_of(std::span(raw).first(6)), "06abff0a0002");
  EXPECT_EQ(hex_of(std::span(serial).first(5)), "06c9ff0904");
  EXPECT_EQ(usb_report_bits(raw).at({0x80, 0}), 512u);
  EXPECT_EQ(usb_report_bits(raw).at({0x90, 0}), 512u);
  EXPECT_EQ(usb_report_bits(serial).at({0x90, 0}), 256u);
  const auto silent = host.in(1);
  const auto report = host.read(3);
  ASSERT_TRUE(report);
  ASSERT_EQ(report->size(), 64u);
  EXPECT_EQ(get_field(*report, {.offset_bits = 64, .width_bits = 32}), -70000);
  EXPECT_EQ(report->at(40), 8);
  EXPECT_EQ(host.done(silent), nullptr);
}

TEST(ReportBoard, UnpluggedTheFirmwareRunsOnUnlessItHadItsPowerFromThere) {
  ReportBoardOptions options = wooden_haptics();
  options.watchdog_s = 0;
  ReportBoard board(options);
  UsbHost host(board);
  host.write(1, {0xe8, 0x03, 0, 0, 0, 0, 0, 0});
  host.wire.unplug();
  host.run_for(1);
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 1);
  host.wire.plug(false, host.now_ns);
  EXPECT_DOUBLE_EQ(board.motor(0).torque(), 1);
  host.wire.unplug();
  host.wire.plug(true, host.now_ns);
  EXPECT_EQ(board.motor(0).torque(), 0);
}

}  // namespace
}  // namespace hapticd::test::emulator
