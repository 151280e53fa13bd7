#include "drivers/can/moteus_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/can/moteus_formats.h"

namespace hapticd::can::moteus {
namespace {

constexpr std::uint8_t kWrite = 0x00, kRead = 0x10, kNop = 0x50;
constexpr std::uint32_t kAsksForReply = 0x8000;

std::uint16_t number(Register which) noexcept {
  return static_cast<std::uint16_t>(which);
}

/// Towards zero, saturated; NaN is the most negative number.
template <class Integer>
Integer in_steps(double value, double step) noexcept {
  using Limits = std::numeric_limits<Integer>;
  if (std::isnan(value)) return Limits::min();
  const double most = Limits::max();
  return static_cast<Integer>(std::clamp(std::trunc(value / step), -most, most));
}
}  // namespace

Frame to_servo(const Address& address, bool reply) noexcept {
  Frame frame;
  frame.id = (std::uint32_t{address.prefix} << 16) | (reply ? kAsksForReply : 0) |
             (std::uint32_t{address.source} << 8) | address.servo;
  frame.extended = frame.id >= 0x800;
  frame.fd = frame.fast = true;
  return frame;
}

bool is_reply(const Frame& frame, const Address& address) noexcept {
  const std::uint32_t id =
      (std::uint32_t{address.prefix} << 16) | (std::uint32_t{address.servo} << 8) | address.source;
  return !frame.error && !frame.remote && frame.id == id && frame.extended == (id >= 0x800);
}

bool Writer::extends(bool reads, std::uint16_t which, Format format) const noexcept {
  return run_.count > 0 && run_.reads == reads && run_.format == format &&
         which == run_.first + run_.count && run_.bytes + size_of(format) <= run_.values.size();
}

void Writer::begin(bool reads, std::uint16_t which, Format format) noexcept {
  flush();
  run_ = {.reads = reads, .format = format, .first = which};
}

Writer& Writer::write(Register which, Format format, double value) noexcept {
  using Single = std::numeric_limits<float>;
  if (std::isinf(value) || (format == Format::real && std::abs(value) > Single::max()))
    good_ = false;
  if (!extends(false, number(which), format)) begin(false, number(which), format);
  const double step = step_of(number(which), format);
  const auto keep = [&](auto raw) {
    std::memcpy(run_.values.data() + run_.bytes, &raw, sizeof raw);
    run_.bytes += sizeof raw;
  };
  switch (format) {
    case Format::int8:
      keep(in_steps<std::int8_t>(value, step));
      break;
    case Format::int16:
      keep(in_steps<std::int16_t>(value, step));
      break;
    case Format::int32:
      keep(in_steps<std::int32_t>(value, step));
      break;
    case Format::real:
      keep(static_cast<float>(value));
      break;
  }
  ++run_.count;
  return *this;
}

Writer& Writer::read(Register which, Format format) noexcept {
  if (!extends(true, number(which), format)) begin(true, number(which), format);
  ++run_.count;
  return *this;
}

void Writer::flush() noexcept {
  if (run_.count == 0) return;
  const auto head = static_cast<std::uint8_t>((run_.reads ? kRead : kWrite) |
                                              (static_cast<int>(run_.format) << 2));
  append(run_.count <= 3 ? static_cast<std::uint8_t>(head | run_.count) : head);
  if (run_.count > 3) append_varuint(run_.count);
  append_varuint(run_.first);
  for (std::size_t i = 0; i < run_.bytes; ++i) append(run_.values[i]);
  run_ = {};
}

void Writer::append(std::uint8_t byte) noexcept {
  if (size_ == frame_.data.size()) {
    good_ = false;
    return;
  }
  frame_.data[size_++] = byte;
}

void Writer::append_varuint(std::uint32_t value) noexcept {
  for (; value >= 0x80; value >>= 7) append(static_cast<std::uint8_t>(value | 0x80));
  append(static_cast<std::uint8_t>(value));
}

std::optional<Frame> Writer::finish() noexcept {
  flush();
  if (!good_) return std::nullopt;
  frame_.size = fd_length(size_);
  std::fill(frame_.data.begin() + static_cast<std::ptrdiff_t>(size_),
            frame_.data.begin() + frame_.size, kNop);
  return frame_;
}

namespace {

void add(Writer& writer, const Query& query) noexcept {
  writer.read(Register::mode, Format::int8).read(Register::position, Format::real);
  if (query.motion)
    writer.read(Register::velocity, Format::real).read(Register::torque, Format::real);
  if (query.supply)
    writer.read(Register::voltage, Format::int8).read(Register::temperature, Format::int8);
  writer.read(Register::fault, Format::int8);
  if (query.settings)
    writer.read(Register::maximum_torque, Format::real)
        .read(Register::watchdog_timeout, Format::real);
  if ((query.tag & 1) != 0)
    writer.read(Register::millisecond_counter, query.settings ? Format::int32 : Format::int8);
  if ((query.tag & 2) != 0) writer.read(Register::register_map_version, Format::int8);
}

}  // namespace

std::optional<Frame> torque_command(const Address& address, const TorqueCommand& command,
                                    const std::optional<Query>& query) noexcept {
  if (!std::isfinite(command.torque_Nm) || !std::isfinite(command.maximum_torque_Nm) ||
      !std::isfinite(command.watchdog_s))
    return std::nullopt;
  Writer writer(to_servo(address, query.has_value()));
  writer.write(Register::mode, Format::int8, static_cast<double>(Mode::position))
      .write(Register::command_position, Format::int8, std::nan(""))
      .write(Register::command_velocity, Format::int8, 0)
      .write(Register::feedforward_torque, Format::real, command.torque_Nm)
      .write(Register::kp_scale, Format::int8, 0)
      .write(Register::kd_scale, Format::int8, 0)
      .write(Register::maximum_torque, Format::real, command.maximum_torque_Nm)
      .write(Register::watchdog_timeout, Format::real, command.watchdog_s)
      .write(Register::ilimit_scale, Format::int8, 0);
  if (command.ignore_position_bounds)
    writer.write(Register::ignore_position_bounds, Format::int8, 1);
  if (query) add(writer, *query);
  return writer.finish();
}

TorqueCommands::TorqueCommands(const Address& address, const TorqueCommand& settings,
                               bool asks) noexcept {
  TorqueCommand command = settings;
  command.torque_Nm = 0;
  for (int tag = 0; tag < 4; ++tag) {
    const auto query = asks ? std::optional(Query{.tag = tag}) : std::nullopt;
    frames_[static_cast<std::size_t>(tag)] = torque_command(address, command, query);
  }
}

std::optional<Frame> TorqueCommands::with(double torque_Nm, int tag) const noexcept {
  // Behind the mode (3 bytes), position and velocity (4), and the head of its own subframe (2).
  constexpr std::size_t kTorqueAt = 9;
  std::optional<Frame> frame = frames_[static_cast<std::size_t>(tag & 3)];
  if (!(std::abs(torque_Nm) <= std::numeric_limits<float>::max())) return std::nullopt;
  if (frame) put(*frame, kTorqueAt, static_cast<float>(torque_Nm));
  return frame;
}

Frame stop(const Address& address, const std::optional<Query>& query) noexcept {
  Writer writer(to_servo(address, query.has_value()));
  writer.write(Register::mode, Format::int8, static_cast<double>(Mode::stopped));
  if (query) add(writer, *query);
  return *writer.finish();
}

Frame ask(const Address& address, const Query& query) noexcept {
  Writer writer(to_servo(address, true));
  add(writer, query);
  return *writer.finish();
}

Frame ask_identity(const Address& address) noexcept {
  Writer writer(to_servo(address, true));
  writer.read(Register::register_map_version, Format::int32)
      .read(Register::serial_number, Format::int32)
      .read(Register::millisecond_counter, Format::int32);
  return *writer.finish();
}

}  // namespace hapticd::can::moteus
