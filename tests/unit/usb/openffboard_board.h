// An OpenFFBoard for tests of its driver, with the bus and the host in front of it, in virtual time: a report each way in a
// frame of 1 ms, the board's loop once a frame. It is as the firmware is where that matters to the driver: Set Effect enables
// the actuators and alone tells the state, an ended effect keeps its magnitude, positions come when they change, or every
// 100 ms.
#pragma once
#include <cmath>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <numbers>

#include "drivers/usb/host.h"
#include "tests/unit/usb/openffboard_descriptor.h"

namespace hapticd::hid::test {

using Report = std::vector<std::uint8_t>;
inline constexpr std::int64_t kFrame_ns = 1'000'000;

class FakeBoard {
 public:
  struct Effect {
    bool made = false, plays = false;
    int magnitude = 0, duration_ms = 0;
    std::int64_t started_ns = 0;
    unsigned enable = 0, direction = 0;
  };
  struct Sent {
    std::int64_t at_ns = 0;
    Report report{};
  };

  explicit FakeBoard(const BoardBuild& what) : build(what), descriptor(board_descriptor(what)) {
    for (std::uint8_t axis = 0; axis < what.axes; ++axis) {
      const std::int64_t values[] = {127, 30, 5, 6, -20, 204};
      const std::uint32_t commands[] = {5, 6, 0x16, 0x17, 0x18, 0x0c};
      for (int i = 0; i < 6; ++i) settings[key(0xa01, axis, commands[i])] = values[i];
      settings[key(0xa01, axis, 1)] = 900;
    }
    settings[key(0xa02, 0, 0)] = 120;
    settings[key(1, 0, 0)] = 0;
  }

  // -- what a test looks at and turns
  BoardBuild build;
  std::vector<std::uint8_t> descriptor;
  std::map<std::uint64_t, std::int64_t> settings;
  std::vector<Effect> effects = std::vector<Effect>(4);
  std::vector<Sent> log;         ///< what arrived
  std::vector<Report> replaced;  ///< what waited and did not go
  std::int64_t now_ns = 1'000'000'000 + 300'000;
  std::int64_t position[2] = {0, 0};
  std::int64_t rate_Hz = 1000;
  bool active = false, emergency = false, safety = false, mute = false, frozen = false,
       stateless = false;
  std::int64_t answer_delay_ns = 0;
  bool plugged = true, opened = false, logs = true;
  int calls = 0, unplug_at = -1;
  std::function<void()> every_frame = [] {};

  static std::uint64_t key(std::uint16_t of, std::uint8_t axis, std::uint32_t command) {
    return std::uint64_t{of} << 40 | std::uint64_t{axis} << 32 | command;
  }
  std::int64_t setting(std::uint16_t of, std::uint8_t axis, std::uint32_t command) const {
    return settings.at(key(of, axis, command));
  }
  /// On an axis, in parts of 32767, in the direction in which its position counts up.
  int torque(int axis) const {
    double sum = 0;
    for (const Effect& effect : effects) {
      if (!active || emergency || !effect.plays) continue;
      if (effect.enable != 1U << build.axes)
        return 99999;  // not by direction: the board would do something else
      const double angle = 2 * std::numbers::pi * effect.direction / 36000;
      sum += -effect.magnitude * (axis == 0 ? std::sin(angle) : -std::cos(angle));
    }
    return static_cast<int>(std::lround(sum));
  }
  void put_in(const Report& report) { in_.push_back(report); }

  // -- the port
  bool alive() {
    if (calls++ == unplug_at) plugged = false;
    return plugged;
  }
  usb::Status send(std::span<const std::uint8_t> report) {
    if (!alive()) return usb::Status::gone;
    const Report bytes(report.begin(), report.end());
    if (out.since_ns == 0) {
      going_ = bytes;
      out.since_ns = now_ns;
      return usb::Status::ok;
    }
    if (!waiting_.empty()) {
      replaced.push_back(waiting_);
      ++out.replaced;
    }
    waiting_ = bytes;
    out.waits = true;
    return usb::Status::ok;
  }
  usb::Status flush(std::int64_t until_ns) {
    if (!alive()) return usb::Status::gone;
    while (out.since_ns != 0 && now_ns < until_ns) advance(until_ns);
    return out.since_ns == 0 ? usb::Status::ok : usb::Status::nothing;
  }
  usb::Arrival receive(std::int64_t until_ns) {
    if (!alive()) return {.status = usb::Status::gone};
    while (arrived_.empty() && now_ns < until_ns) advance(until_ns);
    if (arrived_.empty()) return {};
    last_ = arrived_.front().report;
    const std::int64_t at_ns = arrived_.front().at_ns;
    arrived_.pop_front();
    return {usb::Status::ok, last_, at_ns};
  }
  usb::Status set_feature(std::span<const std::uint8_t> report) {
    if (!alive()) return usb::Status::gone;
    log.push_back({now_ns, Report(report.begin(), report.end())});
    created_ = 0;
    for (std::size_t i = 0; i < effects.size() && created_ == 0; ++i)
      if (!effects[i].made) created_ = i + 1;
    if (created_ != 0) effects[created_ - 1] = {.made = true};
    tell_state();
    return usb::Status::ok;
  }
  std::size_t get_feature(std::span<std::uint8_t> report) {
    if (!alive()) return 0;
    report[1] = static_cast<std::uint8_t>(created_);
    report[2] = created_ != 0 ? 1 : 2;
    return 5;
  }
  usb::Outgoing out;

  /// To the next frame, or to `until_ns`.
  void advance(std::int64_t until_ns) {
    const std::int64_t frame_ns = (now_ns / kFrame_ns + 1) * kFrame_ns;
    now_ns = std::min(until_ns, frame_ns);
    if (now_ns == frame_ns) frame();
  }

 private:
  void frame() {
    if (out.since_ns != 0) {
      handle(going_);
      if (logs) log.push_back({now_ns, going_});
      ++out.sent;
      out.since_ns = waiting_.empty() ? 0 : now_ns;
      going_ = std::move(waiting_);
      waiting_.clear();
      out.waits = false;
    }
    for (Effect& effect : effects)
      if (now_ns - effect.started_ns > effect.duration_ms * kFrame_ns) effect.plays = false;
    for (; !delayed_.empty() && delayed_.front().at_ns <= now_ns; delayed_.pop_front())
      in_.push_back(delayed_.front().report);
    tell();
    every_frame();
  }

  /// What else there is to tell comes before a position, but not three times in a row.
  void tell() {
    Report pad = gamepad();
    const bool due = !frozen && (pad != told_ || now_ns - told_ns_ > 100 * kFrame_ns);
    if (!in_.empty() && (!due || skipped_ < 2)) {
      skipped_ = due ? skipped_ + 1 : 0;
      arrived_.push_back({now_ns, in_.front()});
      in_.pop_front();
    } else if (due) {
      skipped_ = 0;
      told_ = pad;
      told_ns_ = now_ns;
      arrived_.push_back({now_ns, std::move(pad)});
    }
  }

  Report gamepad() const {
    Report report;
    report.reserve(48);
    report.push_back(1);
    report.resize(9);
    for (std::size_t i = 0; i < 8; ++i) {
      const bool is_wide = build.wide && i < static_cast<std::size_t>(build.axes);
      std::int64_t value = i < 2 ? position[i] : 0;
      for (int byte = 0; byte < (is_wide ? 4 : 2); ++byte, value >>= 8)
        report.push_back(static_cast<std::uint8_t>(value));
    }
    return report;
  }
  void tell_state() {
    if (stateless) return;
    in_.push_back({2, static_cast<std::uint8_t>(8 | (active ? 0x12 : 0x01) | (safety ? 4 : 0))});
  }

  void handle(const Report& report) {
    const auto word = [&](std::size_t at) { return report[at] | report[at + 1] << 8; };
    if (report[0] == 0xa1) return answer(report);
    if (report[0] == 0x0c) {
      if ((report[1] & 0x01) != 0) active = true;
      if ((report[1] & 0x1e) != 0) active = false;
      if ((report[1] & 0x08) != 0) std::fill(effects.begin(), effects.end(), Effect{});
    }
    if (report[0] == 0x0c || report[0] == 0x0d) return;
    Effect& effect = effects.at(report.at(1) - 1U);
    if (report[0] == 0x05) effect.magnitude = static_cast<std::int16_t>(word(2));
    if (report[0] == 0x0a) {
      effect.plays = report[2] == 1;
      effect.started_ns = now_ns;
    }
    if (report[0] != 0x01) return;
    effect.duration_ms = word(3);
    effect.enable = report[13];
    effect.direction = static_cast<unsigned>(word(14));
    active = true;
    tell_state();
  }
  void answer(Report report) {
    std::uint16_t of = 0;
    std::uint32_t command = 0;
    std::int64_t data = 0;
    std::memcpy(&of, &report[2], 2);
    std::memcpy(&command, &report[5], 4);
    std::memcpy(&data, &report[9], 8);
    if (mute) return;
    const auto found = settings.find(key(of, report[4], command));
    if (found == settings.end()) {
      report[1] = 13;
    } else if (report[1] == 0) {
      found->second = of == 0xa02 ? std::min(data, rate_Hz / 2) : data;
      report[1] = 1;
    } else {
      const std::int64_t value = of == 1 ? (emergency ? -1 : active ? 1 : 0) : found->second;
      std::memcpy(&report[9], &value, 8);
    }
    delayed_.push_back({now_ns + answer_delay_ns, report});
  }

  Report going_, waiting_, last_, told_;
  std::deque<Report> in_;
  std::deque<Sent> arrived_, delayed_;
  std::int64_t told_ns_ = 0;
  std::size_t created_ = 0;
  int skipped_ = 0;
};

class FakeBoardPort final : public usb::HidPort {
 public:
  explicit FakeBoardPort(FakeBoard& board) : board_(board) { board.opened = true; }
  ~FakeBoardPort() override { board_.opened = false; }
  usb::Arrival receive(std::int64_t until_ns) override { return board_.receive(until_ns); }
  usb::Status send(std::span<const std::uint8_t> bytes) override { return board_.send(bytes); }
  usb::Status flush(std::int64_t until_ns) override { return board_.flush(until_ns); }
  const usb::Outgoing& outgoing() const noexcept override { return board_.out; }
  usb::Status set_feature(std::span<const std::uint8_t> report) override {
    return board_.set_feature(report);
  }
  std::size_t get_feature(std::span<std::uint8_t> report) override {
    return board_.get_feature(report);
  }
  const std::vector<std::uint8_t>& report_descriptor() const noexcept override {
    return board_.descriptor;
  }

 private:
  FakeBoard& board_;
};

class FakeBoardHost final : public usb::Host {
 public:
  explicit FakeBoardHost(FakeBoard& board) : board_(board) {}
  std::int64_t now_ns() noexcept override { return board_.now_ns; }
  void wait(std::int64_t until_ns) override {
    while (board_.now_ns < until_ns) board_.advance(until_ns);
  }
  void wake() noexcept override {}
  usb::Opened<usb::Found<usb::BulkPort>> open_bulk(const usb::Selection&, std::uint8_t,
                                                   std::uint8_t) override {
    return tl::unexpected(usb::NotOpened{});
  }
  usb::Opened<usb::Found<usb::HidPort>> open_hid(const usb::Selection& selection) override {
    asked = selection;
    if (!board_.plugged) return tl::unexpected(usb::NotOpened{.absent = true, .error = {}});
    usb::Found<usb::HidPort> found;
    found.port = std::make_unique<FakeBoardPort>(board_);
    found.serial = "42";
    return found;
  }
  usb::Selection asked;

 private:
  FakeBoard& board_;
};

}  // namespace hapticd::hid::test
