#include "sim/usb/openffboard.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/usb/descriptors.h"

namespace hapticd::sim::usb {
namespace {

using Type = OpenffboardCommand::Type;

enum BoardClass : std::uint16_t { kMainClass = 0x01, kAxisClass = 0xa01, kEffectsClass = 0xa02 };
constexpr std::uint32_t kEffectsActive = 0, kEmergency = 10;  // of the main class
constexpr std::uint32_t kFilterFrequency = 0, kFilterQ = 1;   // of the effects
constexpr std::uint8_t kEveryInstance = 0xff;
constexpr std::size_t kMostReplies = 50, kMostEchoes = 10;
constexpr std::int64_t kCycle_ns = 1'000'000;
constexpr int kCyclesAtMost = 100, kCyclesForReplies = 2;

enum HidRequest : std::uint8_t {
  kGet = 0x01,
  kGetIdleRate = 0x02,
  kSet = 0x09,
  kSetIdleRate = 0x0a
};
constexpr int kOutputType = 2, kFeatureType = 3;

bool is(std::uint8_t id, OpenffboardReport report) {
  return id == static_cast<std::uint8_t>(report);
}

}  // namespace

Openffboard::Openffboard(const OpenffboardOptions& options)
    : options_(options), effects_(options.axes) {
  for (std::size_t i = 0; i < options_.axes; ++i) axes_.emplace_back(options_.axis);
  next_cycle_ns_ = std::llround(1e9 * options_.cycle_phase_s);
}

std::vector<std::uint8_t> Openffboard::device_descriptor() const {
  return make_device_descriptor(options_.vendor, options_.product_id, !options_.serial.empty(),
                                true);
}

std::vector<std::uint8_t> Openffboard::configuration_descriptor() const {
  using Kind = ConfigurationDescriptor::Kind;
  constexpr std::uint8_t kCdc = 2, kAbstractModel = 2, kCdcData = 10, kHidClass = 3;
  return ConfigurationDescriptor()
      .raw({8, 0x0b, 0, 2, kCdc, kAbstractModel, 0, 0})  // interfaces 0 and 1 belong together
      .interface(0, 1, kCdc, kAbstractModel)
      .raw({5, 0x24, 0x00, 0x20, 0x01})
      .raw({5, 0x24, 0x01, 0, 1})
      .raw({4, 0x24, 0x02, 2})
      .raw({5, 0x24, 0x06, 0, 1})
      .endpoint(0x82, Kind::interrupt, 8, 16)
      .interface(1, 2, kCdcData)
      .endpoint(0x01, Kind::bulk, 64, 0)
      .endpoint(0x81, Kind::bulk, 64, 0)
      .interface(kHid, 2, kHidClass)
      .hid(report_descriptor(kHid).size())
      .endpoint(kOut, Kind::interrupt, 64, 1)
      .endpoint(0x80 | kIn, Kind::interrupt, 64, 1)
      .bytes();
}

Names Openffboard::names() const {
  return {.manufacturer = "Open FFBoard", .product = options_.product, .serial = options_.serial};
}

std::vector<std::uint8_t> Openffboard::report_descriptor(int interface) const {
  if (interface != kHid) return {};
  return openffboard_report_descriptor(axes_.size());
}

Answer Openffboard::control(const Setup& setup, std::span<const std::uint8_t> data,
                            std::int64_t now_ns) {
  constexpr int kClassToInterface = 0x21, kDirection = 0x80;
  if ((setup.request_type & ~kDirection) != kClassToInterface) return {.kind = Answer::Kind::stall};
  if ((setup.index & 0xff) == kHid) return hid_request(setup, data, now_ns);
  constexpr std::uint8_t kSetLineCoding = 0x20, kGetLineCoding = 0x21, kSetLineState = 0x22;
  if (setup.request == kGetLineCoding) return {.bytes = {0x00, 0xc2, 0x01, 0x00, 0, 0, 8}};
  const bool known = setup.request == kSetLineCoding || setup.request == kSetLineState;
  return known ? Answer{} : Answer{.kind = Answer::Kind::stall};
}

Answer Openffboard::hid_request(const Setup& setup, std::span<const std::uint8_t> data,
                                std::int64_t now_ns) {
  const auto id = static_cast<std::uint8_t>(setup.value & 0xff);
  const int type = setup.value >> 8;
  switch (setup.request) {
    case kSetIdleRate:
      return {};
    case kGetIdleRate:
      return {.bytes = {0}};
    case kGet:
      return type == kFeatureType ? feature(id) : Answer{.kind = Answer::Kind::stall};
    case kSet:
      // An output report that comes here reaches the firmware without its id, and it reads the wrong bytes.
      if (type == kOutputType) return {};
      if (type != kFeatureType || !is(id, OpenffboardReport::create_effect) || data.size() < 2)
        return {.kind = Answer::Kind::stall};
      heard_ns_ = now_ns;
      effects_.create(data[1]);
      send_state();
      return {};
    default:
      return {.kind = Answer::Kind::stall};
  }
}

Answer Openffboard::feature(std::uint8_t id) const {
  if (is(id, OpenffboardReport::block_load)) return {.bytes = effects_.block_load()};
  if (is(id, OpenffboardReport::pool)) return {.bytes = effects_.pool()};
  return {.kind = Answer::Kind::stall};
}

/// Lost if the endpoint is not free.
void Openffboard::send_state() {
  if (slot_.empty()) slot_ = effects_.state();
}

Answer Openffboard::out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                        std::int64_t now_ns) {
  if (endpoint == kOut && !bytes.empty()) take(bytes, now_ns);
  return {};
}

void Openffboard::take(std::span<const std::uint8_t> report, std::int64_t now_ns) {
  heard_ns_ = now_ns;
  if (const auto effect = openffboard_set_effect(report)) {
    effects_.set(*effect);
    send_state();
  } else if (const auto force = openffboard_constant(report)) {
    effects_.set(*force);
  } else if (const auto operation = openffboard_operation(report)) {
    effects_.operate(*operation, tick_ms(now_ns));
  } else if (const auto asked = openffboard_command(report)) {
    command(*asked);
  } else if (report.size() >= 2) {
    if (is(report[0], OpenffboardReport::block_free)) effects_.free(report[1]);
    if (is(report[0], OpenffboardReport::device_control)) effects_.control(report[1]);
    if (is(report[0], OpenffboardReport::device_gain)) effects_.set_gain(report[1]);
  }
}

/// Who it is for.
void Openffboard::command(const OpenffboardCommand& asked) {
  const std::size_t instances = asked.class_id == kAxisClass ? axes_.size() : 1;
  const bool known = asked.class_id == kAxisClass || asked.class_id == kMainClass ||
                     asked.class_id == kEffectsClass;
  if (!known || (asked.instance != kEveryInstance && asked.instance >= instances))
    return answer(asked, Type::not_found, asked.data, asked.address);
  for (std::size_t i = 0; i < instances; ++i)
    if (asked.instance == kEveryInstance || asked.instance == i)
      answer_one(asked, static_cast<std::uint8_t>(i));
}

void Openffboard::answer_one(OpenffboardCommand asked, std::uint8_t instance) {
  if (!knows(asked)) return answer(asked, Type::not_found, asked.data, asked.address);
  asked.instance = instance;
  const bool writes = asked.type == Type::write || asked.type == Type::write_at;
  if (writes) {
    if (replies_.size() > kMostEchoes) return (void)write(asked);
    if (!write(asked)) return answer(asked, Type::error, 0, 0);
    // The value that was asked for, as if it had been read; whether it was taken is another thing.
    if (asked.type == Type::write) return answer(asked, Type::read, asked.data, 0);
    return answer(asked, Type::read_at, asked.data, asked.address);
  }
  if (asked.type != Type::read && asked.type != Type::read_at) return;
  const auto value = read(asked);
  answer(asked, value ? Type::read : Type::ack, value.value_or(0), 0);
}

void Openffboard::answer(const OpenffboardCommand& asked, Type type, std::int64_t data,
                         std::int64_t address) {
  if (replies_.size() >= kMostReplies) return;
  replies_.push_back(asked);
  replies_.back().type = type;
  replies_.back().data = data;
  replies_.back().address = address;
}

bool Openffboard::knows(const OpenffboardCommand& asked) const {
  switch (asked.class_id) {
    case kAxisClass:
      return axes_.front().knows(asked.command);
    case kMainClass:
      return asked.command == kEffectsActive || asked.command == kEmergency;
    default:
      return asked.command == kFilterFrequency || asked.command == kFilterQ;
  }
}

std::optional<std::int64_t> Openffboard::read(const OpenffboardCommand& asked) const {
  switch (asked.class_id) {
    case kAxisClass:
      return axes_[asked.instance].read(asked.command);
    case kMainClass:
      if (asked.command == kEmergency) return emergency_;
      return emergency_ ? -1 : effects_.active();
    default:
      return asked.command == kFilterQ ? effects_.filter_q() : effects_.filter_Hz();
  }
}

bool Openffboard::write(const OpenffboardCommand& asked) {
  switch (asked.class_id) {
    case kAxisClass:
      return axes_[asked.instance].write(asked.command, asked.data);
    case kMainClass:
      if (asked.command != kEmergency) return false;
      emergency_ = asked.data != 0;
      return true;
    default:
      if (asked.command == kFilterQ)
        effects_.set_filter_q(asked.data);
      else
        effects_.set_filter_Hz(asked.data);
      return true;
  }
}

Answer Openffboard::in(std::uint8_t endpoint, std::size_t, std::int64_t) {
  if (endpoint != kIn || slot_.empty()) return {.kind = Answer::Kind::nak};
  return {.bytes = std::exchange(slot_, {})};
}

void Openffboard::advance(std::int64_t now_ns) {
  for (; next_cycle_ns_ <= now_ns; next_cycle_ns_ += kCycle_ns) cycle(next_cycle_ns_);
}

void Openffboard::cycle(std::int64_t now_ns) {
  const std::int64_t silence_ns = std::llround(1e9 * options_.silence_s);
  if (silence_ns > 0 && now_ns - heard_ns_ > silence_ns) effects_.switch_on(false);
  for (OpenffboardAxis& axis : axes_) axis.measure();
  const auto forces = effects_.forces(tick_ms(now_ns));
  send_report();
  for (std::size_t i = 0; i < axes_.size(); ++i)
    axes_[i].drive(effects_.active(), emergency_, forces[i]);
}

/// Replies go first, but not more than two cycles on end; the pad only if it changed, or after 100 cycles.
void Openffboard::send_report() {
  if (!slot_.empty()) return;
  if (!replies_.empty() && cycles_since_pad_++ < kCyclesForReplies) return send_reply();
  if (replies_.empty()) ++cycles_since_pad_;
  OpenffboardPad pad{.buttons = buttons_};
  for (std::size_t i = 0; i < axes_.size(); ++i) pad.axes[i] = axes_[i].pad();
  if (pad == sent_ && cycles_since_pad_ <= kCyclesAtMost) {
    if (!replies_.empty()) send_reply();
    return;
  }
  slot_ = openffboard_pad(pad);
  sent_ = pad;
  cycles_since_pad_ = 0;
}

void Openffboard::send_reply() {
  slot_ = openffboard_command(replies_.front());
  replies_.pop_front();
}

std::uint32_t Openffboard::tick_ms(std::int64_t now_ns) const {
  return static_cast<std::uint32_t>((now_ns - boot_ns_) / kCycle_ns);
}

void Openffboard::replug(bool power_lost, std::int64_t now_ns) {
  slot_.clear();
  replies_.clear();
  effects_.switch_on(false);
  effects_.reset();
  if (power_lost) {
    effects_ = OpenffboardEffects(axes_.size());
    for (OpenffboardAxis& axis : axes_) axis.power_up();
    boot_ns_ = now_ns;
    emergency_ = false;
  }
  for (OpenffboardAxis& axis : axes_) axis.plugged_in();
  const std::int64_t phase_ns = std::llround(1e9 * options_.cycle_phase_s);
  next_cycle_ns_ = std::max(next_cycle_ns_, (now_ns / kCycle_ns) * kCycle_ns + phase_ns);
}

}  // namespace hapticd::sim::usb
