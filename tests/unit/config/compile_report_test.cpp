// Reports of a HID device of one's own: which bits drivers are told, and what is wrong with them.
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

/// The reports are on lines 5 to 7, the axis' encoder on line 13.
const std::string kReport = R"(version: 1
devices:
  - name: own
    driver: hid_report
    report:
      in: {bytes: 8, positions: [{offset_bits: 0, width_bits: 16, signed: true, unwrap: true}]}
      out: {bytes: 8, efforts: [{offset_bits: 0, width_bits: 16, signed: true, scale: 0.001}]}
    usb: {id: '1234:0006', transport: libusb}
    kinematics: {cartesian: {directions: [x]}}
    latency_s: 0.005
    axes:
      - name: x
        encoder: {counts_per_m: 10000}
        actuator: {max_force_N: 8}
stability: {require: none}
guard: {max_force_N: 2}
)";

/// More keys of `in` or of `out`.
std::string with_in(const std::string& keys) {
  return replaced(kReport, "in: {bytes: 8, ", "in: {bytes: 8, " + keys + ", ");
}
std::string with_out(const std::string& keys) {
  return replaced(kReport, "out: {bytes: 8, ", "out: {bytes: 8, " + keys + ", ");
}
/// The only error.
void expect_refused(const std::string& text, const std::string& path,
                    const std::vector<std::string>& words) {
  const auto errors = errors_of(text);
  ASSERT_EQ(errors.size(), 1U) << listed(errors) << text;
  EXPECT_EQ(errors[0].path, "devices[0]." + path) << to_string(errors[0]);
  EXPECT_EQ(errors[0].line == 0, false);
  for (const std::string& word : words)
    EXPECT_NE(errors[0].message.find(word), std::string::npos) << to_string(errors[0]) << word;
}

TEST(CompileReport, MapsAreWhatTheKeysSay) {
  const Compiled compiled = compiled_of(replaced(
      replaced(
          kReport, "in: {bytes: 8, positions: [{offset_bits: 0,",
          "in: {id: 3, bytes: 20, buttons: [{offset_bits: 24}, {offset_bits: 25, width_bits: "
          "3}], analogue: [{offset_bits: 32, width_bits: 16, endian: big, signed: true, scale: "
          "0.5, offset: -1}, {offset_bits: 64, width_bits: 32, float: true}], sequence: "
          "{offset_bits: 48, width_bits: 8, modulus: 100}, positions: [{offset_bits: 8, "
          "modulus: 4096, scale: 2, offset: 7,"),
      "out: {bytes: 8, efforts: [{offset_bits: 0,",
      "out: {id: 4, bytes: 9, constants: [{byte: 1, value: 200}], heartbeat: {offset_bits: 16, "
      "width_bits: 4}, safe: [4, 1, 2, 3, 254, 12, 6, 7, 255], every_s: 0.004, watchdog_s: 0.02, "
      "efforts: [{offset_bits: 32, endian: big, offset: 0.5, least: -9, most: 10,"));
  ASSERT_TRUE(compiled.usb.at(0));
  const usb::ReportOptions& report = compiled.usb[0]->report;
  EXPECT_EQ(report.buttons, 2U);
  EXPECT_EQ(report.every_s, 0.004);
  EXPECT_EQ(report.in.report_id, 3);
  EXPECT_EQ(report.in.report_bytes, 20U);
  ASSERT_EQ(report.in.fields.size(), 5U) << "position, buttons, analogue";
  EXPECT_EQ(report.in.fields[0].place,
            (hid::Place{.offset_bits = 8, .width_bits = 16, .is_signed = true}));
  EXPECT_EQ(report.in.fields[0].modulus, 4096U);
  EXPECT_EQ(report.in.fields[0].scale, 2);
  EXPECT_EQ(report.in.fields[0].offset, 7);
  EXPECT_EQ(report.in.fields[1].place, (hid::Place{.offset_bits = 24, .width_bits = 1}));
  EXPECT_EQ(report.in.fields[2].place, (hid::Place{.offset_bits = 25, .width_bits = 3}));
  EXPECT_EQ(
      report.in.fields[3].place,
      (hid::Place{
          .offset_bits = 32, .width_bits = 16, .is_signed = true, .endian = hid::Endian::big}));
  EXPECT_EQ(report.in.fields[3].offset, -1);
  EXPECT_FALSE(report.in.fields[3].modulus);
  EXPECT_TRUE(report.in.fields[4].place.is_float);
  ASSERT_TRUE(report.in.sequence);
  EXPECT_EQ(report.in.sequence->steps(), 100U);
  EXPECT_EQ(report.out.report_id, 4);
  ASSERT_EQ(report.out.fields.size(), 1U);
  EXPECT_EQ(report.out.fields[0].place.endian, hid::Endian::big);
  EXPECT_EQ(report.out.fields[0].scale, 0.001);
  EXPECT_EQ(report.out.fields[0].offset, 0.5);
  EXPECT_EQ(report.out.fields[0].least, -9);
  EXPECT_EQ(report.out.fields[0].most, 10);
  ASSERT_EQ(report.out.constants.size(), 1U);
  EXPECT_EQ(report.out.constants[0].at, 1U);
  EXPECT_EQ(report.out.constants[0].value, 200);
  EXPECT_EQ(report.out.heartbeat, (hid::Place{.offset_bits = 16, .width_bits = 4}));
  EXPECT_EQ(report.out.safe.back(), 255);
}

TEST(CompileReport, ACounterBeginsAnewAfterItsBits) {
  const auto fields = compiled_of(kReport).usb.at(0)->report.in.fields;
  EXPECT_EQ(fields.at(0).modulus, 65536U);
  EXPECT_FALSE(
      compiled_of(replaced(replaced(kReport, ", unwrap: true", ""), "10000}", "10000, bits: 16}"))
          .usb.at(0)
          ->report.in.fields.at(0)
          .modulus);
}

TEST(CompileReport, TheDriverNeedsItsReportsAndWhichDevice) {
  expect_error(replaced(kReport, "id: '1234:0006', ", ""), "8:10", "devices[0].usb.id",
               {"missing; expected here with driver: hid_report"});
  EXPECT_NE(
      listed(errors_of(replaced(kReport, "    usb: {id: '1234:0006', transport: libusb}\n", "")))
          .find("devices[0].usb: missing"),
      std::string::npos);
  const auto from = kReport.find("    report:"), to = kReport.find("    usb:");
  EXPECT_NE(listed(errors_of(kReport.substr(0, from) + kReport.substr(to)))
                .find("devices[0].report: missing; expected here with driver: hid_report"),
            std::string::npos);
}

TEST(CompileReport, EachAxisHasAPositionAndAnEffort) {
  const std::string another = "{offset_bits: 32, width_bits: 8, scale: 1}, ";
  expect_refused(replaced(kReport, "positions: [", "positions: [" + another), "report.in.positions",
                 {"each of the 1 axes, found 2"});
  expect_refused(replaced(kReport, "efforts: [", "efforts: [" + another), "report.out.efforts",
                 {"each of the 1 axes, found 2"});
}

TEST(CompileReport, AFaultIsNamedAtItsKey) {
  expect_refused(replaced(kReport, "in: {bytes: 8", "in: {bytes: 1"),
                 "report.in.positions[0].offset_bits", {"runs beyond", "bits 0 to 15 of 8"});
  expect_refused(with_in("buttons: [{offset_bits: 3}]"), "report.in.buttons[0].offset_bits",
                 {"used twice", "bits 3 to 3 of 64"});
  expect_refused(with_in("analogue: [{offset_bits: 20, width_bits: 16, endian: big}]"),
                 "report.in.analogue[0].offset_bits", {"whole bytes"});
  expect_refused(with_in("analogue: [{offset_bits: 16, width_bits: 16, scale: 0}]"),
                 "report.in.analogue[0].scale", {"not 0"});
  expect_refused(with_in("analogue: [{offset_bits: 16, width_bits: 16, float: true}]"),
                 "report.in.analogue[0].width_bits", {"32"});
  expect_refused(with_in("id: 3"), "report.in.positions[0].offset_bits",
                 {"an id takes bits 0 to 7"});
  expect_refused(with_in("sequence: {offset_bits: 8, width_bits: 16}"),
                 "report.in.sequence.offset_bits", {"used twice"});
  expect_refused(with_in("sequence: {offset_bits: 16, width_bits: 4, modulus: 17}"),
                 "report.in.sequence.modulus", {"a modulus is"});
  expect_refused(replaced(kReport, "unwrap: true", "unwrap: true, modulus: 65537"),
                 "report.in.positions[0].modulus", {"a modulus is"});
}

TEST(CompileReport, AFaultOfTheReportThatIsSentIsNamedAtItsKey) {
  expect_refused(with_out("constants: [{byte: 1, value: 3}]"), "report.out.constants",
                 {"used twice"});
  expect_refused(with_out("constants: [{byte: 9, value: 3}]"), "report.out.constants",
                 {"runs beyond"});
  expect_refused(with_out("heartbeat: {offset_bits: 15, width_bits: 2}"),
                 "report.out.heartbeat.offset_bits", {"used twice"});
  expect_refused(with_out("safe: [0, 0]"), "report.out.safe", {"another length"});
  expect_refused(replaced(kReport, "scale: 0.001", "scale: 0.001, least: 3, most: 2"),
                 "report.out.efforts[0].most", {"not in order"});
  expect_refused(replaced(kReport, "scale: 0.001", "scale: 0.001, offset: 40"),
                 "report.out.efforts[0].offset", {"0 cannot be sent"});
  expect_refused(replaced(kReport, "scale: 0.001", "scale: 0"), "report.out.efforts[0].scale",
                 {"not 0"});
}

TEST(CompileReport, SixteenFieldsAreAll) {
  std::string buttons = "buttons: [";
  for (int i = 16; i < 31; ++i)
    buttons += (i > 16 ? ", " : "") + ("{offset_bits: " + std::to_string(i) + "}");
  EXPECT_TRUE(errors_of(with_in(buttons + "]")).empty())
      << listed(errors_of(with_in(buttons + "]")));
  expect_refused(with_in(buttons + ", {offset_bits: 31}]"), "report.in.buttons",
                 {"at most 16 fields"});
}

/// 16 bits with sign: 32767 steps of 1 mN.
TEST(CompileReport, AnAxisDeliversWhatItsFieldCarries) {
  EXPECT_TRUE(errors_of(replaced(kReport, "max_force_N: 8", "max_force_N: 32.767")).empty());
  const auto expect = [](const std::string& from, const std::string& to, const std::string& most) {
    expect_refused(replaced(replaced(kReport, "max_force_N: 8", "max_force_N: 33"), from, to),
                   "axes[0].actuator.max_force_N",
                   {"at most " + most + " N", "report.out.efforts[0]", "found 33"});
  };
  expect("scale: 0.001", "scale: 0.001", "32.767");
  expect("scale: 0.001", "scale: -0.001", "32.767");
  expect("scale: 0.001", "scale: 0.002, most: 20", "20");
  expect("scale: 0.001", "scale: 0.002, least: -10, most: 20", "10");
  expect("signed: true, scale: 0.001", "scale: 0.001, offset: -16", "16");
  EXPECT_TRUE(errors_of(replaced(replaced(kReport, "max_force_N: 8", "max_force_N: 33"),
                                 "width_bits: 16, signed: true, scale: 0.001",
                                 "width_bits: 32, float: true, scale: 1"))
                  .empty());
}

TEST(CompileReport, OneOfDriverAndLoopCountsOn) {
  const std::string plain = replaced(kReport, ", unwrap: true", "");
  const auto bits = [](const std::string& text, int count) {
    return replaced(text, "10000}", "10000, bits: " + std::to_string(count) + "}");
  };
  EXPECT_TRUE(errors_of(bits(kReport, 0)).empty());
  expect_refused(bits(kReport, 16), "axes[0].encoder.bits", {"expected 0", "unwrap counts on"});
  expect_refused(plain, "axes[0].encoder.bits", {"expected 16", "unwrap: true", "found 32"});
  EXPECT_TRUE(errors_of(bits(plain, 16)).empty());
  EXPECT_TRUE(errors_of(bits(plain, 0)).empty());
  const std::string halves = replaced(plain, "width_bits: 16,", "width_bits: 16, scale: 0.5,");
  expect_refused(bits(halves, 16), "axes[0].encoder.bits", {"scaled by 0.5"});
  EXPECT_TRUE(errors_of(bits(halves, 0)).empty());
  const std::string real =
      replaced(plain, "width_bits: 16, signed: true", "width_bits: 32, float: true");
  expect_refused(real, "axes[0].encoder.bits", {"expected 0", "floating-point"});
  EXPECT_TRUE(errors_of(bits(real, 0)).empty());
  expect_refused(replaced(replaced(kReport, "width_bits: 16, signed: true, unwrap: true",
                                   "width_bits: 32, float: true, unwrap: true"),
                          "10000}", "10000, bits: 0}"),
                 "report.in.positions[0].modulus", {"floating-point number has none"});
}

TEST(CompileReport, KeysThatDoNothingAreRefused) {
  expect_refused(
      replaced(replaced(kReport, "unwrap: true", "modulus: 1000"), "10000}", "10000, bits: 0}"),
      "report.in.positions[0].modulus", {"unwrap: true alone"});
  expect_refused(
      with_in("analogue: [{offset_bits: 16, width_bits: 32, float: true, signed: true}]"),
      "report.in.analogue[0].signed", {"sign of its own"});
}

/// At 1.5 m/s and 1 kHz 10 ticks are 150 counts.
TEST(CompileReport, ACounterIsLongEnoughToBeCountedOn) {
  const auto of = [](int modulus) {
    return replaced(kReport, "unwrap: true", "unwrap: true, modulus: " + std::to_string(modulus));
  };
  EXPECT_TRUE(errors_of(of(301)).empty());
  expect_refused(of(300), "report.in.positions[0].modulus",
                 {"max_velocity_m_s 1.5", "300 steps", "150 in 10 ticks"});
  expect_refused(replaced(kReport, "width_bits: 16, signed: true, unwrap: true",
                          "width_bits: 8, unwrap: true"),
                 "report.in.positions[0].width_bits", {"256 steps"});
}

TEST(CompileReport, ReportsGoOutWellWithinTheDevicesWatchdog) {
  EXPECT_TRUE(errors_of(with_out("watchdog_s: 0.015")).empty());
  expect_refused(with_out("watchdog_s: 0.0149"), "report.out.every_s", {"a third of watchdog_s"});
}

TEST(CompileReport, InputsAndSensorsAreThoseOfTheReport) {
  const auto with = [](const std::string& text, const std::string& line) {
    return replaced(text, "    kinematics:", "    " + line + "\n    kinematics:");
  };
  const std::string button = with_in("buttons: [{offset_bits: 16}]");
  EXPECT_TRUE(errors_of(with(button, "enable_inputs: [{bit: 0}]")).empty());
  expect_refused(with(button, "enable_inputs: [{bit: 1}]"), "enable_inputs[0].bit",
                 {"0 to 0", "1 input", "found 1"});
  expect_refused(with(kReport, "enable_inputs: [{bit: 0}]"), "enable_inputs[0].bit",
                 {"report.in.buttons names no input"});
  const std::string channel = with_in("analogue: [{offset_bits: 16, width_bits: 16}]");
  EXPECT_TRUE(errors_of(with(channel, "force_sensor: {directions: [x]}")).empty());
  expect_refused(with(channel, "force_sensor: {directions: [x, y]}"), "force_sensor.directions",
                 {"2 directions and 1 channel"});
}

}  // namespace
}  // namespace hapticd::config::test
