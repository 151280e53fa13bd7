// The driver of an OpenFFBoard and its board.
#pragma once
#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "drivers/hid/openffboard.h"
#include "tests/unit/usb/openffboard_board.h"
#include "tests/unit/usb/vectors.h"

namespace hapticd::hid::test {

using usb::Heard;

inline constexpr double kFull_Nm = 4, kDeadMan_s = 0.1;
inline constexpr int kHalf = 16384;  // of 32767, rounded half away from zero

inline usb::DeviceOptions board_options(std::size_t axes = 1,
                                        double counts_per_turn = 65536 * 360.0 / 900) {
  usb::DeviceOptions options{.name = "board", .kind = usb::Kind::openffboard};
  options.arrival_age_s = 0.003;
  options.worst_sample_age_s = 0.008;
  for (std::size_t i = 0; i < axes; ++i)
    options.axes.push_back({.counts_per_unit = counts_per_turn / (2 * std::numbers::pi)});
  options.openffboard = {.full_torque_Nm = kFull_Nm, .dead_man_s = kDeadMan_s};
  return options;
}

class Said final : public usb::Words {
 public:
  void say(std::string_view) override {}
};

/// A driver and its board; each tick of 1 ms the driver is told and hears what came, as by its thread.
struct BoardRig {
  explicit BoardRig(BoardBuild build = {}, usb::DeviceOptions with = board_options())
      : board(build), options(std::move(with)), protocol(make_openffboard(options)) {}

  bool open() {
    Said words;
    opened = protocol->open(host, words);
    return opened.has_value();
  }
  std::string why() const { return opened ? "" : opened.error().error.text; }
  void ticks(int count, bool armed, std::array<double, 2> effort_Nm = {}) {
    for (int i = 0; i < count; ++i) tick(armed, effort_Nm);
  }
  void tick(bool armed, std::array<double, 2> effort_Nm = {}) {
    usb::Command command{.at_ns = board.now_ns, .armed = armed};
    std::copy(effort_Nm.begin(), effort_Nm.end(), command.effort.begin());
    status = protocol->tell(command, board.now_ns);
    hear(board.now_ns + kFrame_ns);
  }
  void hear(std::int64_t until_ns) {
    while (board.now_ns < until_ns) {
      const usb::Arrival arrival = protocol->port()->receive(until_ns);
      if (arrival.status != usb::Status::ok) break;
      heard = protocol->take(arrival.bytes, arrival.stamp_ns, reading);
      if (heard == Heard::sample) sample_ns = arrival.stamp_ns;
      if (heard == Heard::fault) ++faults;
      if (heard == Heard::malformed) ++malformed;
    }
  }
  Heard take(const char* hex) {
    const auto report = usb::bytes(hex);
    return protocol->take(report, board.now_ns, reading);
  }
  /// What the board told during set-up is gone; it tells its position again within 0.1 s.
  void wait_for_position() {
    for (int i = 0; i < 130 && sample_ns == 0; ++i) tick(false);
    EXPECT_NE(sample_ns, 0);
  }
  /// Armed, with its forces confirmed.
  void arm() {
    wait_for_position();
    ticks(20, true);
    EXPECT_TRUE(reading.armed);
  }
  int count(const std::string& begin) const {
    return static_cast<int>(
        std::count_if(board.log.begin(), board.log.end(),
                      [&](const auto& sent) { return usb::hex(sent.report).starts_with(begin); }));
  }
  std::size_t first(const std::string& begin) const {
    const auto found = std::find_if(board.log.begin(), board.log.end(), [&](const auto& sent) {
      return usb::hex(sent.report).starts_with(begin);
    });
    return static_cast<std::size_t>(found - board.log.begin());
  }

  FakeBoard board;
  FakeBoardHost host{board};
  usb::DeviceOptions options;
  std::unique_ptr<usb::Protocol> protocol;
  usb::Opened<usb::Identity> opened{};
  usb::Reading reading{};
  usb::Status status = usb::Status::ok;
  Heard heard = Heard::nothing;
  std::int64_t sample_ns = 0;
  int faults = 0, malformed = 0;
};

}  // namespace hapticd::hid::test
