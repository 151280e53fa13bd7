#include "daemon/hapticctl_emulate_usb_kinds.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "sim/usb/falcon.h"
#include "sim/usb/openffboard.h"
#include "sim/usb/report_board.h"

namespace hapticd::daemon {
namespace {

using Joint = sim::EmulatedDevice::Joint;
using Truth = sim::DeviceOptions;

constexpr double kHomes_s = 0.3;  ///< a hand pulls the grip out and pushes it in
/// So many keep-alives may be missing.
constexpr double kWatchdogPerReport = 10;

/// A motor that counts as the config has it, and makes its torques in the axis' own unit.
Joint joint_of(sim::Motor& motor, const usb::AxisOptions& axis, double zero,
               double effort_per_torque = 1) {
  return {.motor = &motor,
          .turns_per_unit = axis.counts_per_unit,
          .offset_turns = -axis.counts_per_unit * zero,
          .effort_per_torque = effort_per_torque};
}

/// Nothing: it cannot be read.
std::optional<std::vector<std::uint8_t>> content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) return std::nullopt;
  return bytes;
}

// -- Falcon

Result<EmulatedUsbDevice> falcon(const usb::DeviceOptions& options, const Truth& truth) {
  sim::usb::FalconOptions falcon{.vendor = options.selection.vendor,
                                 .product = options.selection.product};
  if (!options.selection.serial.empty()) falcon.serial = options.selection.serial;
  falcon.bridge.acts_on_event_char = options.falcon.flush_on_bracket;
  falcon.board.torque_per_command_Nm = 1 / options.falcon.counts_per_Nm;
  falcon.board.home_after_s = kHomes_s;
  falcon.board.loaded = options.falcon.firmware.empty();
  if (!falcon.board.loaded) {
    auto image = content_of(options.falcon.firmware);
    if (!image)
      return fail(ExitCode::no_input, "device " + options.name + ": cannot read its firmware " +
                                          options.falcon.firmware);
    falcon.board.firmware = std::move(*image);
  }
  auto device = std::make_unique<sim::usb::Falcon>(falcon);
  EmulatedUsbDevice made{.falcon = device.get(), .own_supply = true};
  for (std::size_t i = 0; i < options.axes.size() && i < device->motors(); ++i)
    made.joints.push_back(joint_of(device->motor(i), options.axes[i], truth.axes[i].zero_m));
  made.device = std::move(device);
  return made;
}

// -- a board with reports of its own

tl::unexpected<Error> not_emulated(const usb::DeviceOptions& options, const std::string& what) {
  return fail(ExitCode::no, "device " + options.name + ": the emulated board has no " + what);
}

sim::usb::ReportField field_of(const hid::Place& place, bool numbered) {
  return {.offset_bits = place.offset_bits - (numbered ? 8U : 0U),
          .width_bits = place.width_bits,
          .is_signed = place.is_signed,
          .big_endian = place.endian == hid::Endian::big};
}

/// Does it begin anew where its bits do?
bool wraps_at_width(std::uint64_t modulus, std::uint32_t width_bits) {
  return modulus == 0 || (width_bits < 64 && modulus == std::uint64_t{1} << width_bits);
}

Result<sim::usb::ReportBoardOptions> board_of(const usb::DeviceOptions& options) {
  const usb::Selection& selection = options.selection;
  const hid::InputMap& in = options.report.in;
  const hid::OutputMap& out = options.report.out;
  if (selection.interface.value_or(0) != 0) return not_emulated(options, "interface but 0");
  sim::usb::ReportBoardOptions board{
      .vendor = selection.vendor, .product_id = selection.product, .serial = selection.serial};
  auto& reports = board.interfaces[0];
  if (selection.usage) {
    reports.usage_page = static_cast<std::uint16_t>(*selection.usage >> 16);
    reports.usage = static_cast<std::uint16_t>(*selection.usage & 0xffff);
  }
  reports.in_id = in.report_id;
  reports.out_id = out.report_id;
  reports.in_bytes = in.report_bytes - (in.report_id ? 1 : 0);
  reports.out_bytes = out.report_bytes - (out.report_id ? 1 : 0);

  const std::size_t axes = options.axes.size(), analogue = axes + options.report.buttons;
  for (std::size_t i = 0; i < in.fields.size(); ++i) {
    if (!wraps_at_width(in.fields[i].modulus.value_or(0), in.fields[i].place.width_bits))
      return not_emulated(options, "counter that begins anew before its bits are used up");
    auto& to = i < axes ? board.positions : i < analogue ? board.buttons : board.analogue;
    to.push_back(field_of(in.fields[i].place, in.report_id.has_value()));
  }
  if (in.sequence) {
    if (!wraps_at_width(in.sequence->modulus, in.sequence->place.width_bits))
      return not_emulated(options, "sequence number that begins anew before its bits are used up");
    board.sequence = field_of(in.sequence->place, in.report_id.has_value());
  }
  for (const hid::OutputField& field : out.fields) {
    if (field.offset != 0) return not_emulated(options, "effort with an offset");
    board.efforts.push_back(
        {.field = field_of(field.place, out.report_id.has_value()), .per_raw = field.scale});
  }
  if (out.heartbeat) board.heartbeat = field_of(*out.heartbeat, out.report_id.has_value());
  board.watchdog_s = kWatchdogPerReport * options.report.every_s;
  return board;
}

Result<EmulatedUsbDevice> report_board(const usb::DeviceOptions& options, const Truth& truth) {
  auto board = board_of(options);
  if (!board) return tl::unexpected(board.error());
  EmulatedUsbDevice made{.device = std::make_unique<sim::usb::ReportBoard>(*board)};
  for (std::size_t i = 0; i < options.axes.size(); ++i) {
    Joint joint = joint_of(made.device->motor(i), options.axes[i], truth.axes[i].zero_m);
    // counts = scale * raw + offset
    const hid::InputField& field = options.report.in.fields[i];
    joint.turns_per_unit /= field.scale;
    joint.offset_turns = (joint.offset_turns - field.offset) / field.scale;
    made.joints.push_back(joint);
  }
  return made;
}

// -- OpenFFBoard

/// Its counts are 65536 over the range that it has been given.
std::uint16_t degrees_of(const usb::AxisOptions& axis) {
  const double degrees = 65536 / std::abs(axis.counts_per_unit) * 180 / std::numbers::pi;
  return static_cast<std::uint16_t>(std::clamp(std::round(degrees), 1.0, 65535.0));
}

Result<EmulatedUsbDevice> openffboard(const usb::DeviceOptions& options, const Truth& truth) {
  sim::usb::OpenffboardOptions board{.vendor = options.selection.vendor,
                                     .product_id = options.selection.product,
                                     .axes = options.axes.size()};
  if (!options.selection.serial.empty()) board.serial = options.selection.serial;
  board.axis.full_torque_Nm = options.openffboard.full_torque_Nm;
  board.axis.degrees = degrees_of(options.axes[0]);
  EmulatedUsbDevice made{.device = std::make_unique<sim::usb::Openffboard>(board),
                         .interface = sim::usb::Openffboard::kHid,
                         .in_address = 0x80 | sim::usb::Openffboard::kIn};
  for (std::size_t i = 0; i < options.axes.size(); ++i)
    made.joints.push_back(joint_of(made.device->motor(i), options.axes[i], truth.axes[i].zero_m,
                                   options.axes[i].counts_per_unit < 0 ? -1 : 1));
  return made;
}

}  // namespace

Result<EmulatedUsbDevice> emulate_usb(const usb::DeviceOptions& options,
                                      const sim::DeviceOptions& truth) {
  switch (options.kind) {
    case usb::Kind::falcon:
      return falcon(options, truth);
    case usb::Kind::hid_report:
      return report_board(options, truth);
    case usb::Kind::openffboard:
      return openffboard(options, truth);
  }
  return fail(ExitCode::software, "no emulated device of that kind");
}

}  // namespace hapticd::daemon
