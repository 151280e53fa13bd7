#include "sim/usb/falcon_board.h"

#include <algorithm>
#include <cmath>

namespace hapticd::sim::usb {
namespace {

constexpr std::uint32_t kGreeting = 0x0a430d;
constexpr std::uint8_t kGreetingAnswer[] = {0x00, 0x0a, 0x44, 0x2c, 0x0d};
constexpr std::uint8_t kStartUpload = 0x41;
constexpr std::size_t kChunkBytes = 62;
constexpr std::uint8_t kAllHomed = 7;

std::int64_t after(std::int64_t since_ns, double time_s) {
  return since_ns + std::int64_t{std::llround(1e9 * time_s)};
}

}  // namespace

std::vector<std::uint8_t> made_up_firmware(std::size_t bytes) {
  std::vector<std::uint8_t> image(bytes);
  std::uint32_t state = 1;
  for (std::uint8_t& byte : image) {
    state = state * 1664525u + 1013904223u;
    byte = static_cast<std::uint8_t>(state >> 24);
  }
  return image;
}

FalconBoard::FalconBoard(const FalconBoardOptions& options, FtdiBridge& bridge)
    : options_(options), bridge_(bridge) {
  power_up(0);
}

void FalconBoard::power_up(std::int64_t now_ns) {
  mode_ = options_.loaded ? Mode::running : Mode::asleep;
  was_dtr_ = bridge_.dtr();
  heard_ = 0;
  greetings_ = 0;
  uploaded_ = 0;
  frames_ = {};
  command_ = {};
  homed_ = 0;
  stale_ = false;
  commanded_ns_ = now_ns;
  homing_since_ns_ = kNever;
  for (Leg& leg : legs_) {
    leg.zero_counts_ = leg.frozen_counts_ = leg.counts_;
    leg.torque_Nm_ = 0;
    leg.enabled_ = false;
  }
}

void FalconBoard::bridge_reset() {
  was_dtr_ = bridge_.dtr();
  frames_ = {};
}

double FalconBoard::baud() const {
  if (mode_ == Mode::running) return kRunBaud;
  return mode_ == Mode::asleep || mode_ == Mode::awake ? kRomBaud : kLoaderBaud;
}

void FalconBoard::advance(std::int64_t now_ns) {
  follow_pins(now_ns);
  for (FtdiBridge::LineByte byte; bridge_.next_from_host(now_ns, byte);) {
    if (mode_ == Mode::running) expire(byte.at_ns);
    if (!same_baud(byte.baud, baud())) byte.value = garbled(byte.value);
    take(byte);
  }
  if (mode_ == Mode::running) expire(now_ns);
}

/// DTR low and high again wakes the boot ROM, low once more starts its loader; RTS must be low. What runs does not care.
void FalconBoard::follow_pins(std::int64_t now_ns) {
  purged_ = bridge_.take_purged() || purged_;
  baud_set_ = bridge_.take_baud_set() || baud_set_;
  if (stale_ && purged_ && baud_set_) {
    stale_ = false;
    fresh_since_ns_ = now_ns;
    frames_ = {};
  }
  const bool rises = bridge_.dtr() && !was_dtr_, falls = !bridge_.dtr() && was_dtr_;
  was_dtr_ = bridge_.dtr();
  if (mode_ == Mode::running || bridge_.rts()) return;
  if (rises) {
    mode_ = Mode::awake;
    heard_ = 0;
  }
  if (falls && mode_ == Mode::greeted) mode_ = Mode::listening;
}

void FalconBoard::take(const FtdiBridge::LineByte& byte) {
  switch (mode_) {
    case Mode::awake:
      return greet(byte);
    case Mode::listening:
    case Mode::loading:
      return load(byte);
    case Mode::running:
      return hear(byte);
    case Mode::asleep:
    case Mode::greeted:
    case Mode::dead:
      return;
  }
}

void FalconBoard::greet(const FtdiBridge::LineByte& byte) {
  heard_ = (heard_ << 8 | byte.value) & 0xffffff;
  if (heard_ != kGreeting || ++greetings_ <= options_.deaf_greetings) return;
  const std::span answer(kGreetingAnswer);
  say(options_.leading_zero ? answer : answer.subspan(1), kRomBaud, byte.at_ns);
  mode_ = Mode::greeted;
}

void FalconBoard::load(const FtdiBridge::LineByte& byte) {
  std::uint8_t value = byte.value;
  if (mode_ == Mode::listening) {
    if (value != kStartUpload) return;
    mode_ = Mode::loading;
    uploaded_ = 0;
    as_wanted_ = true;
    return say({&value, 1}, kLoaderBaud, byte.at_ns);
  }
  const std::vector<std::uint8_t>& image = options_.firmware;
  const double share = static_cast<double>(uploaded_) / static_cast<double>(image.size());
  if (share >= options_.dies_at && died_ < options_.deaths) {
    ++died_;
    mode_ = Mode::dead;
    return;
  }
  const bool spoils =
      options_.wrong_echo_chunk >= 0 && wrong_echoes_ < options_.wrong_echo_times &&
      uploaded_ == kChunkBytes * static_cast<std::size_t>(options_.wrong_echo_chunk);
  if (spoils) {
    ++wrong_echoes_;
    value ^= 0x10;
  }
  as_wanted_ = as_wanted_ && uploaded_ < image.size() && value == image[uploaded_];
  ++uploaded_;
  say({&value, 1}, kLoaderBaud, byte.at_ns);
  if (uploaded_ == image.size() && as_wanted_) start_firmware(byte.at_ns);
}

void FalconBoard::start_firmware(std::int64_t now_ns) {
  mode_ = Mode::running;
  commanded_ns_ = now_ns;
  frames_ = {};
  for (Leg& leg : legs_) leg.frozen_counts_ = leg.counts_;
}

void FalconBoard::hear(const FtdiBridge::LineByte& byte) {
  const auto command = frames_.take(byte.value);
  if (!command || stale_) return;
  obey(*command, byte.at_ns);
  reply(byte.at_ns);
}

void FalconBoard::obey(const FalconCommand& command, std::int64_t now_ns) {
  if (!command.homing)
    homing_since_ns_ = kNever;
  else if (!command_.homing)
    homing_since_ns_ = now_ns;
  command_ = command;
  commanded_ns_ = fresh_since_ns_ = now_ns;
  purged_ = baud_set_ = false;
  ++commands_;
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    legs_[i].torque_Nm_ = options_.torque_per_command_Nm * command.motors[i];
    legs_[i].enabled_ = true;
  }
}

bool FalconBoard::home(std::uint8_t mask) {
  if (mode_ != Mode::running || !command_.homing) return false;
  if (!options_.frozen_encoders) homed_ |= mask & kAllHomed;
  return true;
}

void FalconBoard::reply(std::int64_t now_ns) {
  FalconState state{.homed = homed_, .grip = grip_};
  for (std::size_t i = 0; i < legs_.size(); ++i) {
    const Leg& leg = legs_[i];
    const double counts = options_.frozen_encoders ? leg.frozen_counts_ : leg.counts_;
    const double zero_counts = homed_ >> i & 1 ? 0 : leg.zero_counts_;
    state.encoders[i] = static_cast<std::int16_t>(std::llround(counts - zero_counts));
  }
  say(falcon_reply(state), kRunBaud, now_ns);
}

void FalconBoard::say(std::span<const std::uint8_t> bytes, double baud, std::int64_t now_ns) {
  for (const std::uint8_t byte : bytes) bridge_.from_line(byte, baud, now_ns);
}

void FalconBoard::expire(std::int64_t now_ns) {
  if (now_ns >= silent_ns())
    for (Leg& leg : legs_) leg.enabled_ = false;
  if (now_ns >= stale_at_ns()) {
    stale_ = true;
    purged_ = baud_set_ = false;
  }
  if (now_ns >= homes_at_ns()) (void)home(kAllHomed);
}

std::int64_t FalconBoard::silent_ns() const {
  const bool watched = options_.silence_s > 0 && legs_[0].enabled_;
  return watched ? after(commanded_ns_, options_.silence_s) : kNever;
}
std::int64_t FalconBoard::stale_at_ns() const {
  const bool watched = options_.stale_s > 0 && commands_ > 0 && !stale_;
  return watched ? after(fresh_since_ns_, options_.stale_s) : kNever;
}
std::int64_t FalconBoard::homes_at_ns() const {
  const bool homes = options_.home_after_s >= 0 && homing_since_ns_ != kNever &&
                     homed_ != kAllHomed && !options_.frozen_encoders;
  return homes ? after(homing_since_ns_, options_.home_after_s) : kNever;
}

std::int64_t FalconBoard::next_ns() const {
  const std::int64_t line_ns = bridge_.line_idle_ns();
  if (mode_ != Mode::running) return line_ns;
  return std::min({line_ns, silent_ns(), stale_at_ns(), homes_at_ns()});
}

}  // namespace hapticd::sim::usb
