#include "drivers/hid/openffboard_talk.h"

#include <algorithm>
#include <string>

namespace hapticd::hid::openffboard {
namespace {

constexpr std::int64_t kAnswer_ns = 100'000'000, kSent_ns = 100'000'000;
constexpr int kTries = 3;
/// In the time of an answer: a device of 8 kHz sends fewer.
constexpr int kMostReports = 2000;

/// What is set, and to what. In this order: the spring that acts while no force is on is the first that goes.
struct Setting {
  Class of;
  std::uint32_t command;
  std::int64_t neutral;
  const char* name;
};
constexpr Setting of_axis(AxisCommand command, std::int64_t neutral, const char* name) {
  return {Class::axis, static_cast<std::uint32_t>(command), neutral, name};
}
constexpr std::array kOfAxis{of_axis(AxisCommand::idle_spring, 0, "idlespring"),
                             of_axis(AxisCommand::damper, 0, "axisdamper"),
                             of_axis(AxisCommand::friction, 0, "axisfriction"),
                             of_axis(AxisCommand::inertia, 0, "axisinertia"),
                             of_axis(AxisCommand::exponent, 0, "expo"),
                             of_axis(AxisCommand::effect_ratio, 255, "fxratio")};
/// The board makes half its rate of what is more, whatever its rate is; from there on it does not filter
/// (EffectsCalculator.cpp, checkFilterCoeff and calcComponentForce).
constexpr Setting kConstantFilter{Class::effects,
                                  static_cast<std::uint32_t>(EffectsCommand::constant_filter_Hz),
                                  0xffff, "filterCfFreq"};
constexpr std::size_t kFilterIndex = kOfAxis.size();

const Setting& setting_at(std::size_t index) {
  return index == kFilterIndex ? kConstantFilter : kOfAxis[index];
}

Command command_of(const Setting& setting, std::uint8_t axis, Type type, std::int64_t data = 0) {
  return {.type = type,
          .class_id = static_cast<std::uint16_t>(setting.of),
          .instance = axis,
          .command = setting.command,
          .data = data};
}

}  // namespace

tl::unexpected<usb::NotOpened> not_opened(std::string text) {
  return tl::unexpected(
      usb::NotOpened{.absent = false, .error = {std::move(text), ExitCode::unavailable}});
}

tl::unexpected<usb::NotOpened> not_opened(usb::Status status, std::string_view when) {
  std::string text = status == usb::Status::gone      ? "was unplugged while "
                     : status == usb::Status::stalled ? "refuses transfers (stalled) while "
                                                      : "does not take transfers while ";
  auto error = not_opened(text.append(when));
  error.value().absent = status == usb::Status::gone;
  return error;
}

usb::Opened<void> Talk::in_time() const {
  if (words_.abandoned()) return not_opened("its set-up was given up");
  if (host_.now_ns() < until_ns_) return {};
  return not_opened(
      "its set-up takes too long: expected an end within 5 s; unplug it and plug it in again");
}

usb::Opened<void> Talk::tell(std::span<const std::uint8_t> report) {
  if (auto good = in_time(); !good) return good;
  usb::Status status = port_.send(report);
  if (status == usb::Status::ok) status = port_.flush(host_.now_ns() + kSent_ns);
  if (status == usb::Status::ok) return {};
  return not_opened(status, "it is set up");
}

usb::Opened<std::optional<std::int64_t>> Talk::ask(const Command& question, std::string_view what) {
  for (int i = 0; i < kTries; ++i) {
    const std::int64_t begin_ns = host_.now_ns();
    if (auto told = tell(encode(question)); !told) return tl::unexpected(told.error());
    const auto reply = answer(question);
    if (!reply) return tl::unexpected(reply.error());
    if (!*reply) continue;
    took_ns_ = std::max<std::int64_t>(host_.now_ns() - begin_ns, 0);
    if ((*reply)->type == Type::not_found) return std::optional<std::int64_t>{};
    if ((*reply)->type != Type::error) return std::optional((*reply)->data);
    return not_opened(std::string("it answers an error to ").append(what) +
                      "; look at it with the board's configurator");
  }
  return not_opened(std::string("expected an answer to ").append(what) +
                    ", found none in three times 0.1 s; is its firmware an OpenFFBoard's, with the "
                    "HID command channel?");
}

/// Nothing: none came in time.
usb::Opened<std::optional<Command>> Talk::answer(const Command& question) {
  const std::int64_t until_ns = std::min(until_ns_, host_.now_ns() + kAnswer_ns);
  for (int i = 0; i < kMostReports && host_.now_ns() < until_ns; ++i) {
    const usb::Arrival arrival = port_.receive(until_ns);
    if (arrival.status != usb::Status::ok && arrival.status != usb::Status::nothing)
      return not_opened(arrival.status, "it is set up");
    if (arrival.status != usb::Status::ok) continue;
    const auto reply = decode_command(arrival.bytes);
    if (reply && answers(*reply, question)) return reply;
  }
  return std::optional<Command>{};
}

usb::Opened<void> Settings::neutralise(Talk& talk, std::size_t axes) {
  count_ = 0;
  for (std::size_t axis = 0; axis < axes; ++axis)
    for (std::size_t i = 0; i < kOfAxis.size(); ++i)
      if (auto done = neutralise(talk, i, static_cast<std::uint8_t>(axis)); !done) return done;
  return neutralise(talk, kFilterIndex, 0);
}

usb::Opened<void> Settings::neutralise(Talk& talk, std::size_t index, std::uint8_t axis) {
  const Setting& setting = setting_at(index);
  const auto read = command_of(setting, axis, Type::read);
  const auto old = talk.ask(read, setting.name);
  if (!old) return tl::unexpected(old.error());
  if (!*old || **old == setting.neutral) return {};
  changed_[count_++] = {command_of(setting, axis, Type::write, **old)};
  const auto set = talk.ask(command_of(setting, axis, Type::write, setting.neutral), setting.name);
  if (!set) return tl::unexpected(set.error());
  if (index == kFilterIndex) return {};
  const auto now = talk.ask(read, setting.name);
  if (!now) return tl::unexpected(now.error());
  if (*now == setting.neutral) return {};
  return not_opened(std::string("expected ") + setting.name + " " +
                    std::to_string(setting.neutral) + " once set so, found " +
                    std::to_string(now->value_or(0)) +
                    "; is another program setting the board up?");
}

/// The last first, so that the spring returns when all else has. Each has its share of the time for an answer: the board takes
/// one after the other.
void Settings::restore(usb::HidPort& port, usb::Host& host, std::int64_t until_ns) {
  for (; count_ > 0; --count_) {
    const Command& write = changed_[count_ - 1].write;
    const std::int64_t now_ns = host.now_ns();
    if (now_ns >= until_ns) break;
    const std::int64_t share_ns = now_ns + (until_ns - now_ns) / static_cast<std::int64_t>(count_);
    if (port.send(encode(write)) != usb::Status::ok) break;
    if (port.flush(share_ns) == usb::Status::gone) break;
    for (int i = 0; i < kMostReports && host.now_ns() < share_ns; ++i) {
      const usb::Arrival arrival = port.receive(share_ns);
      if (arrival.status != usb::Status::ok && arrival.status != usb::Status::nothing) break;
      const auto reply = decode_command(arrival.bytes);
      if (reply && answers(*reply, write)) break;
    }
  }
  count_ = 0;
}

}  // namespace hapticd::hid::openffboard
