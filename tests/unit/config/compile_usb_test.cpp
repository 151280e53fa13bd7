// Devices on USB: which ones, what their drivers are told, and what cannot be. Reports: compile_report_test.cpp.
#include <nlohmann/json.hpp>
#include <numbers>

#include "config/print.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

/// The latency is on line 7.
const std::string kFalcon = R"(version: 1
loop: {rate_Hz: 1000}
devices:
  - name: grip
    driver: falcon
    kinematics: {delta: {}}
    latency_s: 0.005
    axes:
      - name: a
        kind: rotary
        encoder: {counts_per_rev: 9880.7, bits: 16}
        actuator: {max_torque_Nm: 0.4}
        homing: {by: device}
      - {name: b, kind: rotary, encoder: {counts_per_rev: 9880.7, bits: 16}, actuator: {max_torque_Nm: 0.3}, homing: {by: device}}
      - {name: c, kind: rotary, encoder: {counts_per_rev: 9880.7, bits: 16}, actuator: {max_torque_Nm: 0.2}, homing: {by: device}}
stability: {require: none}
guard: {max_force_N: 2}
)";

/// The board is on line 5, its axis on line 8.
const std::string kWheel = R"(version: 1
devices:
  - name: wheel
    driver: openffboard
    openffboard: {full_torque_Nm: 5}
    kinematics: {serial: {joints: [{a_m: 0.15}]}}
    latency_s: 0.0135
    axes: [{name: q, kind: rotary, encoder: {counts_per_rev: 26214, bits: 0}, actuator: {max_torque_Nm: 4}}]
stability: {require: none}
guard: {max_force_N: 2}
)";

/// `text` with a line of the device's before its kinematics.
std::string with_device_line(const std::string& text, const std::string& line) {
  return replaced(text, "    kinematics:", "    " + line + "\n    kinematics:");
}

TEST(CompileUsb, AFalconNeedsNothingButItsAxes) {
  const Compiled compiled = compiled_of(kFalcon);
  ASSERT_TRUE(compiled.usb.at(0));
  const usb::DeviceOptions& device = *compiled.usb[0];
  EXPECT_EQ(device.name, "grip");
  EXPECT_EQ(device.kind, usb::Kind::falcon);
  EXPECT_EQ(device.selection.vendor, 0x0403);
  EXPECT_EQ(device.selection.product, 0xcb48);
  EXPECT_EQ(device.selection.transport, usb::Transport::libusb);
  EXPECT_EQ(device.period_s, 0.001);
  EXPECT_EQ(device.arrival_age_s, 0.001);
  EXPECT_EQ(device.worst_sample_age_s, 0.0025);
  EXPECT_EQ(device.send_s, 0.002);
  EXPECT_EQ(device.drive_delay_s, 1e-4);
  EXPECT_EQ(device.watchdog_s, 0.02);
  EXPECT_EQ(device.silence_s, 0.1);
  EXPECT_EQ(device.priority, 70);
  EXPECT_EQ(device.falcon.counts_per_Nm, -10000);
  EXPECT_EQ(device.falcon.firmware, "");
}

TEST(CompileUsb, AxesAreNamedAndCountBackwardsWhereTheyAreReversed) {
  const std::vector<usb::AxisOptions> axes = compiled_of(kFalcon).usb.at(0)->axes;
  ASSERT_EQ(axes.size(), 3U);
  EXPECT_EQ(axes[1].name, "grip.b");
  EXPECT_NEAR(axes[0].counts_per_unit, 9880.7 / (2 * std::numbers::pi), 1e-9);
  EXPECT_EQ(axes[2].max_effort, 0.2);
  const Compiled wheel = compiled_of(replaced(kWheel, "bits: 0", "bits: 0, reversed: true"));
  EXPECT_NEAR(wheel.usb.at(0)->axes.at(0).counts_per_unit, -26214 / (2 * std::numbers::pi), 1e-9);
  EXPECT_LT(wheel.program->plan().axes[0].unit_per_raw, 0) << "samples come as they are counted";
}

TEST(CompileUsb, DriversAreToldWhatTheConfigSays) {
  const std::string digest = "0123456789ABCDEF0123456789abcdef0123456789abcdef0123456789abcdef";
  const Compiled compiled = compiled_of(with_device_line(
      kFalcon,
      "usb: {id: '0403:CB49', serial: ff2, path: 1-2.3, reads: 4, arrival_age_s: 0.0005, "
      "max_age_s: 0.0016, send_s: 0.0009, drive_delay_s: 0.0002, watchdog_s: 0.03, silence_s: 0.2}"
      "\n    falcon: {firmware: fw/nova.bin, sha256: '" +
          digest +
          "', upload_tries: 3, counts_per_Nm: 9000, max_command: 5000, "
          "flush_on_bracket: true}"));
  const usb::DeviceOptions& device = compiled.usb.at(0).value();
  EXPECT_EQ(device.selection.product, 0xcb49);
  EXPECT_EQ(device.selection.serial, "ff2");
  EXPECT_EQ(device.selection.path, "1-2.3");
  EXPECT_EQ(device.selection.reads, 4);
  EXPECT_EQ(device.arrival_age_s, 0.0005);
  EXPECT_EQ(device.worst_sample_age_s, 0.0016);
  EXPECT_EQ(device.send_s, 0.0009);
  EXPECT_EQ(device.drive_delay_s, 0.0002);
  EXPECT_EQ(device.watchdog_s, 0.03);
  EXPECT_EQ(device.silence_s, 0.2);
  EXPECT_EQ(device.falcon.firmware, "fw/nova.bin") << "beside test.yaml";
  EXPECT_EQ(device.falcon.sha256.substr(10, 6), "abcdef") << "as digests are printed";
  EXPECT_EQ(device.falcon.upload_tries, 3);
  EXPECT_EQ(device.falcon.counts_per_Nm, 9000);
  EXPECT_EQ(device.falcon.max_command, 5000);
  EXPECT_TRUE(device.falcon.flush_on_bracket);
}

TEST(CompileUsb, FirmwareIsLookedForBesideTheConfig) {
  auto document =
      read_text(with_device_line(kFalcon, "falcon: {firmware: nova.bin}"), "/etc/hapticd/f.yaml");
  ASSERT_TRUE(document);
  const auto compiled = compile(std::move(*document));
  ASSERT_TRUE(compiled) << listed(compiled.error());
  EXPECT_EQ(compiled->usb.at(0)->falcon.firmware, "/etc/hapticd/nova.bin");
}

TEST(CompileUsb, AnOpenFfboardIsAHidDeviceThatMayBeSilent) {
  const Compiled compiled = compiled_of(replaced(kWheel, "Nm: 5}", "Nm: 5, dead_man_s: 0.2}"));
  const usb::DeviceOptions& device = compiled.usb.at(0).value();
  EXPECT_EQ(device.kind, usb::Kind::openffboard);
  EXPECT_EQ(device.selection.vendor, 0x1209);
  EXPECT_EQ(device.selection.product, 0xffb0);
  EXPECT_EQ(device.selection.transport, usb::Transport::hidapi);
  EXPECT_EQ(device.send_s, 0.003);
  EXPECT_EQ(device.silence_s, 0.15);
  EXPECT_EQ(device.openffboard.full_torque_Nm, 5);
  EXPECT_EQ(device.openffboard.dead_man_s, 0.2);
  const Compiled quick = compiled_of(with_device_line(
      kWheel, "usb: {transport: libusb, usage: '0001:0004', interface: 2, reads: 3}"));
  EXPECT_EQ(quick.usb.at(0)->send_s, 0.003);
  EXPECT_EQ(quick.usb[0]->selection.usage, 0x0001'0004U);
  EXPECT_EQ(quick.usb[0]->selection.interface, 2);
  EXPECT_EQ(quick.usb[0]->selection.reads, 3);
}

TEST(CompileUsb, TheThreadStaysBelowTheLoopAndAboveNothing) {
  const std::string text = replaced(kFalcon, "rate_Hz: 1000", "rate_Hz: 1000, priority: 7");
  EXPECT_EQ(compiled_of(text).usb.at(0)->priority, 1);
}

TEST(CompileUsb, KeysStandWithTheirDriver) {
  const auto expect = [](const std::string& text, const std::string& path,
                         const std::string& word) {
    const std::string errors = listed(errors_of(text));
    EXPECT_NE(errors.find(path + ": "), std::string::npos) << errors;
    EXPECT_NE(errors.find(word), std::string::npos) << errors;
  };
  expect(with_device_line(kSmall, "usb: {}"), "devices[0].usb", "not with driver: sim");
  expect(with_device_line(kWheel, "falcon: {}"), "devices[0].falcon", "not with driver");
  expect(with_device_line(kFalcon, "openffboard: {full_torque_Nm: 1}"), "devices[0].openffboard",
         "not with driver: falcon");
  expect(replaced(kWheel, "    openffboard: {full_torque_Nm: 5}\n", ""), "devices[0].openffboard",
         "missing; expected here with driver: openffboard");
  expect(with_device_line(kFalcon, "can: {interface: can0, watchdog_s: 0.02}"), "devices[0].can",
         "driver: falcon has no CAN bus");
}

TEST(CompileUsb, AKeyThatDoesNothingIsRefused) {
  for (const char* key : {"interface: 1", "usage: 'ffab:0200'", "transport: libusb"}) {
    const std::string text = with_device_line(kFalcon, "usb: {" + std::string(key) + "}");
    const auto errors = errors_of(text);
    ASSERT_EQ(errors.size(), 1U) << key << listed(errors);
    EXPECT_NE(errors[0].message.find("a key of HID devices"), std::string::npos) << key;
  }
  expect_error(with_device_line(kWheel, "usb: {reads: 3}"), "6:18", "devices[0].usb.reads",
               {"transport: libusb"});
}

TEST(CompileUsb, IdsPortsAndDigestsHaveTheirForm) {
  const auto refused = [](const std::string& line, const std::string& word) {
    const auto errors = errors_of(with_device_line(kFalcon, line));
    ASSERT_EQ(errors.size(), 1U) << line << listed(errors);
    EXPECT_NE(errors[0].message.find(word), std::string::npos) << to_string(errors[0]);
  };
  for (const char* id : {"403:cb48", "0403-cb48", "0403:cb4g", "0x0403:0xcb48", "04030:cb48"})
    refused("usb: {id: '" + std::string(id) + "'}", "four hexadecimal digits");
  for (const char* port : {"1", "1-", "-2", "1-2.", "1-2..3", "usb1", "1-2:1.0"})
    refused("usb: {path: '" + std::string(port) + "'}", "1-2.3");
  refused("falcon: {firmware: a, sha256: '0123'}", "64 hexadecimal digits");
  EXPECT_TRUE(errors_of(with_device_line(kFalcon, "usb: {path: 12-3.4.10}")).empty());
}

/// 2.5 ms, two frames out, 0.1 ms in the drive, 50 us in the loop.
TEST(CompileUsb, LatencyCoversSampleAgeWireAndDrive) {
  EXPECT_TRUE(errors_of(replaced(kFalcon, "0.005", "0.00465")).empty());
  expect_error(replaced(kFalcon, "0.005", "0.0046"), "7:16", "devices[0].latency_s",
               {"at least 0.00465 s", "0.0025 s old (usb.max_age_s)", "usb.send_s 0.002 s", "50 us",
                "found 0.0046 s"});
  expect_error(replaced(kWheel, "0.0135", "0.0111"), "7:16", "devices[0].latency_s",
               {"at least 0.01115 s", "0.008 s old", "usb.send_s 0.003 s"});
}

/// Beside a device on CAN that is sampled in phase the loop waits for that.
TEST(CompileUsb, LatencyCoversWaitingForOthers) {
  const std::string text = replaced(kFalcon, "stability:", R"(  - name: arm
    driver: odrive
    can: {interface: can0, watchdog_s: 0.02, timing: in_phase}
    kinematics: {cartesian: {directions: [x]}}
    latency_s: 0.003
    axes: [{name: x, can: {node: 3, counts_per_turn: 8192}, encoder: {counts_per_m: 163840}, actuator: {max_force_N: 8}}]
stability:)");
  EXPECT_TRUE(errors_of(replaced(text, "0.005", "0.00515")).empty()) << listed(errors_of(text));
  expect_error(replaced(text, "0.005", "0.0051"), "7:16", "devices[0].latency_s",
               {"at least 0.00515 s", "waits for devices in phase for 0.0005 s"});
}

TEST(CompileUsb, TheCheckKnowsThatTheLatencyVaries) {
  EXPECT_TRUE(compiled_of(kFalcon).assumed.at(0).latency_varies);
}

TEST(CompileUsb, TimesFitEachOther) {
  expect_error(with_device_line(kFalcon, "usb: {max_age_s: 0.0019}"), "6:22",
               "devices[0].usb.max_age_s", {"at least 0.002 s", "1 ms later", "found 0.0019 s"});
  EXPECT_TRUE(errors_of(with_device_line(kFalcon, "usb: {max_age_s: 0.002}")).empty());
  expect_error(with_device_line(kFalcon, "usb: {watchdog_s: 0.0029}"), "6:23",
               "devices[0].usb.watchdog_s", {"at least 3 ticks, 0.003 s"});
  EXPECT_TRUE(errors_of(with_device_line(kFalcon, "usb: {watchdog_s: 0.003}")).empty());
  expect_error(with_device_line(kFalcon, "usb: {silence_s: 0.0025}"), "6:22",
               "devices[0].usb.silence_s", {"more than usb.max_age_s, 0.0025 s"});
  expect_error(with_device_line(kWheel, "usb: {silence_s: 0.11}"), "6:22",
               "devices[0].usb.silence_s", {"at least 0.12 s", "every 0.1 s"});
  EXPECT_TRUE(errors_of(with_device_line(kWheel, "usb: {silence_s: 0.12}")).empty());
}

TEST(CompileUsb, AFalconIsThreeTurningAxesThatFindTheirZero) {
  const auto third = kFalcon.find("      - {name: c");
  const std::string two = replaced(kFalcon.substr(0, third) + "stability: {require: none}\n",
                                   "{delta: {}}", "{serial: {joints: [{a_m: 1}, {a_m: 1}]}}");
  const std::string errors = listed(errors_of(two + "guard: {max_force_N: 2}\n"));
  EXPECT_NE(errors.find("a Falcon has 3 axes, found 2"), std::string::npos) << errors;
  expect_error(replaced(kFalcon, "homing: {by: device}", "homing: {by: none}"), "13:17",
               "devices[0].axes[0].homing", {"expected homing: {by: device}"});
  expect_error(replaced(kFalcon, "homing: {by: device}", "homing: {by: index}"), "13:22",
               "devices[0].axes[0].homing.by", {"is told of no index"});
  expect_error(replaced(kFalcon, "bits: 16}", "bits: 16, reversed: true}"), "11:63",
               "devices[0].axes[0].encoder.reversed", {"the wrong way"});
}

/// 4096 / 10000.
TEST(CompileUsb, AFalconDeliversWhatItsWireCarries) {
  EXPECT_TRUE(errors_of(replaced(kFalcon, "Nm: 0.4", "Nm: 0.4096")).empty());
  expect_error(replaced(kFalcon, "Nm: 0.4", "Nm: 0.41"), "12:35",
               "devices[0].axes[0].actuator.max_torque_Nm",
               {"at most 0.4096 N m", "falcon.max_command", "found 0.41"});
  expect_error(with_device_line(kFalcon, "falcon: {counts_per_Nm: 0}"), "6:29",
               "devices[0].falcon.counts_per_Nm", {"any number but 0"});
}

TEST(CompileUsb, ADigestIsOfAFile) {
  const std::string digest(64, 'a');
  expect_error(with_device_line(kFalcon, "falcon: {sha256: " + digest + "}"), "6:22",
               "devices[0].falcon.sha256", {"falcon.firmware"});
  expect_error(with_device_line(kFalcon, "falcon: {firmware: ''}"), "6:24",
               "devices[0].falcon.firmware", {"an empty text"});
}

TEST(CompileUsb, AnOpenFfboardIsOneOrTwoTurningAxesWithinItsTorque) {
  expect_error(replaced(kWheel, "max_torque_Nm: 4", "max_torque_Nm: 5.1"), "8:105",
               "devices[0].axes[0].actuator.max_torque_Nm",
               {"at most 5 N m", "openffboard.full_torque_Nm"});
  expect_error(replaced(kWheel, ", bits: 0", ""), "8:45", "devices[0].axes[0].encoder.bits",
               {"expected 0", "found 32"});
  expect_error(replaced(kWheel, "actuator:", "homing: {by: device}, actuator:"), "8:92",
               "devices[0].axes[0].homing.by", {"is told of no zero"});
  const std::string three = replaced(
      replaced(kWheel, "[{a_m: 0.15}]", "[{a_m: 0.15}, {a_m: 0.1}, {a_m: 0.1}]"), "axes: [",
      "axes: [{name: a, kind: rotary, encoder: {counts_per_rev: 26214, bits: 0}, actuator: "
      "{max_torque_Nm: 4}}, {name: b, kind: rotary, encoder: {counts_per_rev: 26214, bits: 0}, "
      "actuator: {max_torque_Nm: 4}}, ");
  expect_error(three, "8:11", "devices[0].axes", {"1 or 2 axes, found 3"});
}

TEST(CompileUsb, InputsAndSensorsAreThoseThatTheDeviceHas) {
  EXPECT_TRUE(errors_of(with_device_line(kFalcon, "enable_inputs: [{bit: 3}]")).empty());
  expect_error(with_device_line(kFalcon, "enable_inputs: [{bit: 4}]"), "6:27",
               "devices[0].enable_inputs[0].bit", {"0 to 3", "found 4"});
  EXPECT_TRUE(errors_of(with_device_line(kWheel, "enable_inputs: [{bit: 31}]")).empty());
  expect_error(with_device_line(kFalcon, "force_sensor: {directions: [x]}"), "6:32",
               "devices[0].force_sensor.directions", {"driver: falcon has no force sensor"});
}

/// Two Falcons, `first` and `second` in their `usb`.
std::string two_falcons(const std::string& first, const std::string& second) {
  const auto begin = kFalcon.find("  - name: grip"), end = kFalcon.find("stability:");
  const std::string device = kFalcon.substr(begin, end - begin);
  return kFalcon.substr(0, begin) + with_device_line(device, "usb: {" + first + "}") +
         with_device_line(replaced(device, "grip", "other"), "usb: {" + second + "}") +
         kFalcon.substr(end);
}

TEST(CompileUsb, TwoDevicesAreToldApart) {
  EXPECT_TRUE(errors_of(two_falcons("serial: a", "serial: b")).empty());
  EXPECT_TRUE(errors_of(two_falcons("path: 1-1", "path: 1-2, serial: b")).empty());
  EXPECT_TRUE(errors_of(two_falcons("id: '0403:cb49'", "")).empty());
  for (const auto& [first, second] :
       {std::pair("serial: a", ""), std::pair("", ""), std::pair("serial: a", "serial: a"),
        std::pair("serial: a", "path: 1-1")}) {
    const auto errors = errors_of(two_falcons(first, second));
    ASSERT_EQ(errors.size(), 1U) << first << second << listed(errors);
    EXPECT_EQ(errors[0].path, "devices[1].usb");
    EXPECT_NE(errors[0].message.find("the device of 'grip', too, 0403:cb48"), std::string::npos)
        << errors[0].message;
  }
}

TEST(CompileUsb, ThePlanSaysWhichDeviceAndHowOldSamplesGet) {
  const Compiled compiled =
      compiled_of(with_device_line(kWheel, "usb: {serial: s7, path: 1-2, usage: '0001:0004'}"));
  const std::string text = describe_plan(compiled);
  for (const char* part :
       {"usb: 1209:ffb0, serial s7, at port 1-2, usage 0001:0004; by hidapi", "0.003 s old when",
        "0.008 s when they are used", "sent within 0.003 s", "a latency of 0.01115 s",
        "zero force after 0.02 s", "lost after 0.15 s"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  EXPECT_NE(describe_plan(compiled_of(kFalcon)).find("by libusb, 2 reads in flight"),
            std::string::npos);
  const auto json = nlohmann::json::parse(plan_json(compiled))["devices"][0]["usb"];
  EXPECT_EQ(json["id"], "1209:ffb0");
  EXPECT_EQ(json["serial"], "s7");
  EXPECT_EQ(json["usage"], "0001:0004");
  EXPECT_TRUE(json["interface"].is_null());
  EXPECT_EQ(json["transport"], "hidapi");
  EXPECT_EQ(json["max_age_s"], 0.008);
  EXPECT_NEAR(json["least_latency_s"].get<double>(), 0.01115, 1e-12);
  EXPECT_TRUE(nlohmann::json::parse(plan_json(compiled_of(kSmall)))["devices"][0]["usb"].is_null());
}

/// As of a device on CAN: what `hapticctl emulate` moves.
TEST(CompileUsb, SimIsTheTruthForEmulation) {
  EXPECT_TRUE(compiled_of(kWheel).simulated.at(0).axes.empty());
  const Compiled compiled =
      compiled_of(with_device_line(kWheel, "sim: {axes: [{inertia_kgm2: 0.02}]}"));
  ASSERT_EQ(compiled.simulated.at(0).axes.size(), 1U);
  EXPECT_EQ(compiled.simulated[0].axes[0].mass_kg, 0.02);
}

}  // namespace
}  // namespace hapticd::config::test
