// Configs of the seam tests of USB devices, and the electronics that fit them. Each has a wall, and a hand that presses
// against it once forces are on.
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "sim/usb/falcon.h"
#include "sim/usb/openffboard.h"
#include "sim/usb/report_board.h"
#include "tests/drivers/can_rig.h"
#include "tests/drivers/usb_rig.h"

namespace hapticd::test {

/// Bulk transfers of the emulated host wait for a frame each way, which a real one does not.
inline constexpr const char* kFalconUsb = "{arrival_age_s: 0.0025, max_age_s: 0.004}";

/// A Falcon held over a floor of 100 N/m.
inline std::string falcon_text(const std::string& falcon = "{}") {
  std::string axes, truth;
  for (const char* name : {"one", "two", "three"}) {
    truth +=
        "\n        - {inertia_kgm2: 1.0e-4, damping_Nms_rad: 0.003, position_rad: 0.4174482307}";
    axes += std::string("\n      - {name: ") + name +
            ", kind: rotary, encoder: {counts_per_rev: 9880.7, bits: 16, offset_rad: 0.6109}, "
            "actuator: {max_torque_Nm: 0.4}, homing: {by: device}}";
  }
  return std::string("version: 1\ndevices:\n  - name: falcon\n    driver: falcon\n    usb: ") +
         kFalconUsb + "\n    falcon: " + falcon +
         "\n    latency_s: 0.0065\n    sim:\n      axes:" + truth + R"(
      linkage: {tip_kg: 0.1}
      hand: {mass_kg: 0.1, stiffness_N_m: 200, damping_Ns_m: 5, direction: [0, -1, 0],
             script: [{at_s: 0, position_m: 0}, {at_s: 0.3, position_m: 0.02}]}
    kinematics: {delta: {}}
    pose: {position_m: [-0.12, 0, 0], rotation_quaternion: [0.5, 0.5, 0.5, 0.5]}
    axes:)" +
         axes + R"(
scene:
  - plane: {name: floor, normal: [0, 0, 1], offset_m: -0.01, stiffness_N_m: 100}
stability: {require: none}
guard: {max_force_N: 5, max_velocity_rad_s: 20, ramp_s: 0.1}
)";
}

/// One axis on a board of 8-byte reports with a counter of 16 bits.
inline std::string report_text(const std::string& out_keys = "") {
  return R"(version: 1
devices:
  - name: board
    driver: hid_report
    usb: {id: "1234:0006", transport: libusb}
    report:
      in:
        bytes: 8
        positions: [{offset_bits: 0, width_bits: 16, signed: true, unwrap: true}]
        buttons: [{offset_bits: 16, width_bits: 1}]
        sequence: {offset_bits: 48, width_bits: 16}
      out:
        bytes: 8
        efforts: [{offset_bits: 0, width_bits: 16, signed: true, scale: 0.001}])" +
         out_keys + R"(
    latency_s: 0.005
    kinematics: {cartesian: {directions: [x]}}
    sim:
      axes: [{mass_kg: 0.05, damping_Ns_m: 1.37, position_m: 0.002}]
      hand: {mass_kg: 0.1, damping_Ns_m: 3, script: [{at_s: 0, force_N: -1}]}
    axes:
      - {name: x, encoder: {counts_per_m: 163840, bits: 0}, actuator: {max_force_N: 8}}
scene:
  - plane: {name: wall, devices: [board], normal: [1, 0, 0], offset_m: 0, stiffness_N_m: 300}
stability: {require: none}
guard: {max_force_N: 6, ramp_s: 0.1}
)";
}

/// A wheel whose rim, 0.1 m from its axis, meets a wall.
inline std::string openffboard_text() {
  return R"(version: 1
devices:
  - name: wheel
    driver: openffboard
    usb: {transport: libusb}
    openffboard: {full_torque_Nm: 2}
    latency_s: 0.012
    kinematics: {serial: {joints: [{a_m: 0.1}]}}
    sim:
      axes: [{inertia_kgm2: 0.002, damping_Nms_rad: 0.02, position_rad: 0.02}]
      linkage: {}
      hand: {mass_kg: 0.1, damping_Ns_m: 5, direction: [0, 1, 0], script: [{at_s: 0, force_N: -1}]}
    axes:
      - {name: turn, kind: rotary, encoder: {counts_per_rev: 26214.4, bits: 0},
         actuator: {max_torque_Nm: 1.5}}
scene:
  - plane: {name: wall, devices: [wheel], normal: [0, 1, 0], offset_m: 0, stiffness_N_m: 200}
stability: {require: none}
guard: {max_force_N: 6, max_velocity_rad_s: 20, ramp_s: 0.1}
)";
}

/// An image of a firmware, in a file that nobody else may write.
inline std::string firmware_file(
    const std::vector<std::uint8_t>& image = sim::usb::made_up_firmware()) {
  const std::string path = testing::TempDir() + "falcon_" + std::to_string(::getpid()) + ".bin";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(image.data()),
             static_cast<std::streamsize>(image.size()));
  std::filesystem::permissions(path, std::filesystem::perms::owner_read);
  return path;
}

struct UsbCase {
  const char* name;
  std::string (*text)();
  std::unique_ptr<sim::usb::Device> (*electronics)();
  double held_N;  ///< what the hand presses with in the end
  /// Ticks that the electronics hold the last force at most, when nobody can reach them any more: an OpenFFBoard's effects
  /// end by themselves; the others are without power once they are unplugged.
  int hold_ticks = 0;
};

inline std::string usb_case_name(const testing::TestParamInfo<UsbCase>& info) {
  return info.param.name;
}

inline sim::usb::FalconOptions falcon_electronics(bool loaded = true) {
  sim::usb::FalconOptions options;
  options.board.loaded = loaded;
  options.board.home_after_s = 0.05;
  return options;
}
inline sim::usb::ReportBoardOptions report_electronics() {
  sim::usb::ReportBoardOptions options;
  options.product = "one axis";
  options.positions = {{.offset_bits = 0, .width_bits = 16}};
  options.buttons = {{.offset_bits = 16, .width_bits = 1, .is_signed = false}};
  options.sequence = {{.offset_bits = 48, .width_bits = 16, .is_signed = false}};
  options.efforts = {{.field = {.offset_bits = 0, .width_bits = 16}, .per_raw = 1e-3}};
  options.watchdog_s = 0.5;
  return options;
}
inline sim::usb::OpenffboardOptions openffboard_electronics() {
  sim::usb::OpenffboardOptions options;
  options.axes = 1;
  options.axis.full_torque_Nm = 2;
  // Its own spring and damper act whenever hapticd does not hold it; here every torque is to be hapticd's.
  options.axis.idlespring = options.axis.damper = 0;
  return options;
}

inline const UsbCase kUsbCases[] = {
    {"falcon", [] { return falcon_text("{firmware: " + firmware_file() + "}"); },
     []() -> std::unique_ptr<sim::usb::Device> {
       return std::make_unique<sim::usb::Falcon>(falcon_electronics());
     },
     // The hand's 200 N/m from 20 mm and the floor's 100 N/m from 10 mm on are in balance at 16.7 mm.
     2.0 / 3},
    {"hid_report", [] { return report_text(); },
     []() -> std::unique_ptr<sim::usb::Device> {
       return std::make_unique<sim::usb::ReportBoard>(report_electronics());
     },
     1},
    {"openffboard", [] { return openffboard_text(); },
     []() -> std::unique_ptr<sim::usb::Device> {
       return std::make_unique<sim::usb::Openffboard>(openffboard_electronics());
     },
     1, 110}};

/// Counts of a motor as the config says of its axis.
inline std::vector<sim::EmulatedDevice::Joint> joints_of(const config::Compiled& compiled,
                                                         sim::usb::Device& electronics) {
  std::vector<sim::EmulatedDevice::Joint> joints;
  const auto& axes = compiled.usb.at(0)->axes;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const double counts = axes[i].counts_per_unit;
    joints.push_back({.motor = &electronics.motor(i),
                      .turns_per_unit = counts,
                      .offset_turns = -counts * compiled.simulated.at(0).axes[i].zero_m});
  }
  return joints;
}

inline std::unique_ptr<UsbRig> usb_rig(const std::string& text,
                                       std::unique_ptr<sim::usb::Device> electronics,
                                       const sim::usb::WireOptions& wire = {}) {
  auto compiled = compile_text(text);
  const auto joints = joints_of(compiled, *electronics);
  return std::make_unique<UsbRig>(std::move(compiled), std::move(electronics), joints, wire);
}

}  // namespace hapticd::test
