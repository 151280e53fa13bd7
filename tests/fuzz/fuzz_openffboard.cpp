// OpenFFBoard: its reports, and its driver with a board that behaves as the input wants it: answers of nobody, an emergency
// stop, pauses, unplugging. No force comes that was not asked for, none stays that is not kept up.
#include <algorithm>
#include <deque>

#include "drivers/hid/openffboard.h"
#include "drivers/hid/openffboard_codec.h"
#include "tests/fuzz/protocol.h"
#include "tests/unit/usb/openffboard_board.h"

namespace hapticd::fuzz {
namespace {

using namespace hid;
namespace ffb = hid::openffboard;
using test::FakeBoard;
using test::kFrame_ns;

test::Report report_of(Input& input, std::size_t whole) {
  const std::uint8_t kind = input.byte();
  test::Report report(kind % 4 == 0 ? kind / 4U : whole);
  for (std::uint8_t& byte : report) byte = input.byte();
  return report;
}

std::uint64_t word_at(const test::Report& report, std::size_t at, std::size_t bytes) {
  std::uint64_t word = 0;
  for (std::size_t i = bytes; i-- > 0;) word = word << 8 | report[at + i];
  return word;
}

void decode_command_report(Input& input) {
  test::Report report = report_of(input, ffb::kCommandBytes);
  if (!report.empty() && input.byte() % 8 != 0) report[0] = ffb::kCommandReport;
  const auto command = ffb::decode_command(report);
  if (!command) return;
  must(report.size() == 25 && report[0] == 0xa1, "it is a command");
  const auto again = ffb::encode(*command);
  must(std::equal(report.begin(), report.end(), again.begin()), "nothing of it is lost");
  ffb::Command question = *command;
  question.type = static_cast<ffb::Type>(input.byte() % 5);
  question.instance = input.byte() % 2 == 0 ? command->instance : ffb::kAllInstances;
  if (ffb::answers(*command, question))
    must(command->type != ffb::Type::write && command->type != ffb::Type::info &&
             command->type != ffb::Type::write_at && command->type != ffb::Type::notification,
         "only an answer answers");
  ++question.command;
  must(!ffb::answers(*command, question), "nor does it answer another question");
}

void decode_others(Input& input) {
  test::Report report = report_of(input, ffb::kGamepadBytes);
  if (const auto gamepad = ffb::decode_gamepad(report)) {
    must(report.size() == 25 && report[0] == 1, "a gamepad's report");
    must(gamepad->buttons == word_at(report, 1, 8), "its buttons");
    for (std::size_t i = 0; i < 8; ++i)
      must(static_cast<std::uint16_t>(gamepad->axes[i]) == word_at(report, 9 + 2 * i, 2), "axes");
  }
  report.resize(std::min<std::size_t>(report.size(), 2));
  if (const auto state = ffb::decode_state(report)) {
    const int bits = (state->paused ? 1 : 0) | (state->actuators_enabled ? 2 : 0) |
                     (state->safety ? 4 : 0) | (state->power ? 8 : 0) | (state->playing ? 16 : 0);
    must(report[0] == 2 && bits == (report[1] & 31), "its state");
  }
  const test::Report load = report_of(input, 5);
  if (const auto loaded = ffb::decode_block_load(load)) {
    must(load.size() == 5 && load[0] == 0x12 && loaded->effect == load[1], "a block load");
    must(loaded->free_bytes == word_at(load, 3, 2), "and what is free");
    must(loaded->status != ffb::LoadStatus::ok || loaded->effect != 0, "that names an effect");
  }
}

}  // namespace

void decode(Input& input) {
  if (input.byte() % 2 == 0)
    decode_command_report(input);
  else
    decode_others(input);
}

void encode(Input& input) {
  const std::uint8_t effect = input.byte();
  const double magnitude = input.number();
  const auto encoded = ffb::encode_magnitude(effect, magnitude);
  must(encoded.has_value() == (effect != 0 && std::isfinite(magnitude)), "refused, or sent");
  if (encoded) {
    const double nearest = std::clamp(std::round(magnitude), -32767.0, 32767.0);
    const test::Report report(encoded->report.begin(), encoded->report.end());
    must(report[0] == 5 && report[1] == effect, "of that effect");
    must(static_cast<std::int16_t>(word_at(report, 2, 2)) == nearest,
         "the nearest, or the largest");
    must(encoded->magnitude == nearest && encoded->saturated == (std::round(magnitude) != nearest),
         "and says so");
  }
  test::Report set(input.byte() % 80U, 0xee);
  const ffb::ConstantForce force{.effect = effect,
                                 .duration_ms = input.take<std::uint16_t>(),
                                 .gain = input.byte(),
                                 .direction_centidegrees = input.take<std::uint16_t>()};
  const int axes = input.byte() % 4;
  const bool legal = effect != 0 && force.direction_centidegrees < 36000 && set.size() <= 64 &&
                     ((axes == 1 && set.size() >= 16) || (axes == 2 && set.size() >= 18));
  must(ffb::encode_set_effect(force, axes, set) == legal, "refused, or sent");
  if (!legal) return;
  must(set[0] == 1 && set[1] == effect && set[2] == 1 && set[11] == force.gain, "Set Effect");
  must(word_at(set, 3, 2) == force.duration_ms && set[13] == 1 << axes, "its time and its bits");
  must(word_at(set, 14, 2) == force.direction_centidegrees, "its direction");
  must(std::all_of(set.begin() + 16, set.end(), [](auto byte) { return byte == 0; }),
       "zeros behind");
}

namespace {

constexpr double kFull_Nm = 4, kDeadMan_s = 0.06;
constexpr int kDeadMan_ms = 60;
/// Until a report that was sent has acted, and one that waits before it.
constexpr std::size_t kOnTheWay = 8;

usb::DeviceOptions options_of(std::size_t axes) {
  usb::DeviceOptions options{.name = "fuzz", .kind = usb::Kind::openffboard};
  options.arrival_age_s = 0.003;
  options.worst_sample_age_s = 0.02;
  for (std::size_t i = 0; i < axes; ++i)
    options.axes.push_back({.counts_per_unit = 65536 * 360.0 / 900 / (2 * std::numbers::pi)});
  options.openffboard = {.full_torque_Nm = kFull_Nm, .dead_man_s = kDeadMan_s};
  return options;
}

class Nobody final : public usb::Words {
 public:
  void say(std::string_view) override {}
};

/// A driver's life, as the input has it.
class Life {
 public:
  explicit Life(Input& input)
      : input_(input),
        kind_(input.byte()),
        axes_((kind_ & 1) != 0 ? 2 : 1),
        board_({.axes = static_cast<int>(axes_)}),
        host_(board_),
        options_(options_of(axes_)),
        protocol_(make_openffboard(options_)) {}

  void run() {
    board_.logs = false;
    board_.answer_delay_ns = (kind_ >> 1) % 4 * 3 * kFrame_ns;
    if ((kind_ & 8) != 0) board_.unplug_at = input_.byte();
    const bool disturbed = (kind_ & 16) != 0;
    if (disturbed) board_.every_frame = [&] { disturb(); };
    const auto opened = protocol_->open(host_, words_);
    must(opened || !opened.error().error.text.empty(), "opened, or why not");
    must(opened.has_value() == board_.opened, "what is not opened is closed");
    if (!opened) return;
    must(!board_.active, "no force is on");
    board_.every_frame = [&] { look(); };
    while (!input_.empty() && board_.plugged) tick();
    end();
  }

 private:
  void disturb() {
    if (input_.byte() % 8 != 0) return;
    const std::uint8_t id = input_.byte();
    test::Report report(id == 0xa1 ? 25 : id % 32U);
    for (std::uint8_t& byte : report) byte = input_.byte();
    if (!report.empty()) report[0] = id;
    board_.put_in(report);
  }

  /// Every frame: what pulls was asked for lately, or is nothing; and is kept up.
  void look() {
    told_ms_ = std::min(told_ms_ + 1, 1000);
    for (int axis = 0; axis < static_cast<int>(axes_); ++axis) {
      const int torque = board_.torque(axis);
      if (torque == 0) continue;
      must(told_ms_ <= kDeadMan_ms + 4, "a force that nobody keeps up has ended");
      const auto asked = [&](const auto& command) {
        return command[static_cast<std::size_t>(axis)] == torque;
      };
      must(std::any_of(asked_.begin(), asked_.end(), asked), "a force that was asked for");
    }
  }

  void tick() {
    const std::uint8_t what = input_.byte();
    usb::Command command{.at_ns = board_.now_ns, .armed = (what & 3) != 0};
    for (std::size_t i = 0; i < axes_ && command.armed; ++i)
      command.effort[i] = 0.25 * (input_.byte() % 33 - 16);
    if ((what & 0xc0) == 0xc0) happen();
    for (int times = (what >> 2) & 15; times >= 0 && board_.plugged; --times) {
      remember(command);
      told_ms_ = 0;
      if (protocol_->tell(command, board_.now_ns) != usb::Status::ok) return;
      hear(board_.now_ns + kFrame_ns);
    }
  }

  void remember(const usb::Command& command) {
    std::array<int, 2> parts{};
    for (std::size_t i = 0; i < axes_; ++i)
      parts[i] = static_cast<int>(
          std::lround(protocol_->carried(i, command.effort[i]) * 32767 / kFull_Nm));
    asked_.push_back(parts);
    // A magnitude that stands still is said again; one that is known stays until another comes.
    if (asked_.size() > kOnTheWay) asked_.pop_front();
  }

  void hear(std::int64_t until_ns) {
    while (board_.now_ns < until_ns) {
      const usb::Arrival arrival = protocol_->port()->receive(until_ns);
      if (arrival.status != usb::Status::ok) return;
      const auto heard = protocol_->take(arrival.bytes, arrival.stamp_ns, reading_);
      must(heard != usb::Heard::fault || !reading_.armed, "what has failed is not armed");
      must(heard != usb::Heard::fault || !protocol_->fault_text().empty(), "and says why");
      for (const double counts : reading_.counts) must(std::isfinite(counts), "a number");
    }
  }

  void happen() {
    const std::uint8_t what = input_.byte();
    switch (what % 9) {
      case 0:
        board_.emergency = !board_.emergency;
        return;
      case 1:
        board_.active = false;
        return;
      case 2:
        board_.position[0] = input_.take<std::int16_t>();
        return;
      case 3:
        host_.wait(board_.now_ns + what * kFrame_ns);
        return;
      case 4:
        board_.mute = !board_.mute;
        return;
      case 5:
        board_.safety = !board_.safety;
        return;
      case 6:
        board_.plugged = what != 6;
        return;
      default: {
        constexpr std::uint8_t kIds[] = {0xa1, 2, 1, 7};
        test::Report report = report_of(input_, what % 2 == 0 ? 25 : 2);
        if (!report.empty()) report[0] = kIds[what >> 6];
        board_.put_in(report);
      }
    }
  }

  void end() {
    const std::int64_t until_ns = board_.now_ns + 100 * kFrame_ns;
    protocol_->close(host_, until_ns);
    must(board_.now_ns <= until_ns, "the way out ends in time");
    must(!board_.opened && protocol_->port() == nullptr, "closed");
    must(!board_.plugged || !board_.active, "without force");
    for (const test::Report& report : board_.replaced)
      must(report[0] == 5, "only magnitudes are replaced");
  }

  Input& input_;
  std::uint8_t kind_;
  std::size_t axes_;
  FakeBoard board_;
  test::FakeBoardHost host_;
  usb::DeviceOptions options_;
  std::unique_ptr<usb::Protocol> protocol_;
  Nobody words_;
  usb::Reading reading_{};
  int told_ms_ = 0;
  std::deque<std::array<int, 2>> asked_{};
};

}  // namespace

void session(Input& input) {
  Life(input).run();
}

}  // namespace hapticd::fuzz
