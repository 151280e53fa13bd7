#include "drivers/hid/openffboard_setup.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

namespace hapticd::hid::openffboard {
namespace {

constexpr int kRoundTrips = 5;
constexpr double kRangeTolerance = 1e-3;
/// Both axes then have the same sign: torque = -magnitude, in the direction in which the position counts up
/// (EffectsCalculator.cpp: -magnitude * sin(direction) for X, magnitude * cos(direction) for Y).
constexpr std::array<std::uint16_t, kMostAxes> kDirections{9000, 18000};

std::string text_of(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                 std::chars_format::general, 7)
                       .ptr;
  return {digits.data(), end};
}

Command degrees_of(std::size_t axis) {
  return {.type = Type::read,
          .class_id = static_cast<std::uint16_t>(Class::axis),
          .instance = static_cast<std::uint8_t>(axis),
          .command = static_cast<std::uint32_t>(AxisCommand::degrees)};
}

/// Do the counts of a turn agree with the board's range? They are `range` steps over its degrees.
usb::Opened<void> compare_range(Talk& talk, std::size_t axis, double counts_per_rad, double range) {
  const auto degrees = talk.ask(degrees_of(axis), "degrees");
  if (!degrees) return tl::unexpected(degrees.error());
  const std::string name = axis == 0 ? "X" : "Y";
  const auto found = static_cast<double>(degrees->value_or(0));
  if (!(found > 0))
    return not_opened("expected degrees of axis " + name +
                      " above 0, found none; set them on the board");
  const double per_turn = range * 360 / found;
  const double configured = std::abs(counts_per_rad) * 2 * std::numbers::pi;
  if (std::abs(configured - per_turn) <= kRangeTolerance * per_turn) return {};
  return not_opened("expected encoder.counts_per_rev " + text_of(per_turn) +
                    ", since the board's axis " + name + " has degrees " + text_of(found) +
                    " for " + text_of(range) + " counts, found " + text_of(configured) +
                    "; correct the configuration, or degrees on the board");
}

usb::Opened<double> measure_round_trip(Talk& talk) {
  std::array<std::int64_t, kRoundTrips> took_ns{};
  for (std::int64_t& one : took_ns) {
    if (const auto asked = talk.ask(degrees_of(0), "degrees"); !asked)
      return tl::unexpected(asked.error());
    one = talk.took_ns();
  }
  std::ranges::sort(took_ns);
  return 1e-9 * static_cast<double>(took_ns[kRoundTrips / 2]);
}

/// While the board does not move its answers are all the samples that there are.
usb::Opened<void> compare_round_trip(const Board& board, const usb::DeviceOptions& options) {
  constexpr double kFrame_s = 1e-3;  // that one answer may take more than another
  const double most_s = most_between_samples_s(options) - kFrame_s;
  if (board.round_trip_s <= most_s) return {};
  const auto ms = [](double seconds) { return text_of(1e-2 * std::round(1e5 * seconds)) + " ms"; };
  return not_opened("expected answers within " + ms(most_s) +
                    ", so that samples are no older than usb.max_age_s, found " +
                    ms(board.round_trip_s) +
                    " (median); raise usb.max_age_s, and latency_s with it");
}

/// A new constant force; its magnitude is 0.
usb::Opened<std::uint8_t> create_effect(Talk& talk) {
  if (const usb::Status status = talk.port().set_feature(kCreateConstantForce);
      status != usb::Status::ok)
    return not_opened(status, "an effect is made");
  std::array<std::uint8_t, kMostReportBytes> report{kBlockLoadReport};
  const std::size_t bytes = std::min(talk.port().get_feature(report), report.size());
  const auto load = decode_block_load(std::span(report).first(bytes));
  if (!load)
    return not_opened("expected a block load report of 5 bytes for a new effect, found " +
                      std::to_string(bytes) + " bytes; unplug the board and plug it in again");
  if (load->status != LoadStatus::ok)
    return not_opened(
        "expected room for a constant force, found none; unplug the board and plug it in again");
  return load->effect;
}

/// Set Effect of both enables the actuators: they are disabled last.
usb::Opened<void> make_effects(Talk& talk, Board& board, double dead_man_s) {
  for (const Control control : {Control::stop_all, Control::reset})
    if (auto told = talk.tell(device_control(control)); !told) return told;
  for (std::size_t axis = 0; axis < board.layout.axes; ++axis) {
    const auto effect = create_effect(talk);
    if (!effect) return tl::unexpected(effect.error());
    board.effects[axis] = *effect;
    const ReportBytes report = set_effect(board, axis, dead_man_s);
    if (auto told = talk.tell(std::span(report).first(board.layout.set_effect_bytes)); !told)
      return told;
  }
  if (auto told = talk.tell(device_gain(255)); !told) return told;
  return talk.tell(device_control(Control::disable_actuators));
}

}  // namespace

double most_between_samples_s(const usb::DeviceOptions& options) noexcept {
  return options.worst_sample_age_s - options.arrival_age_s;
}

ReportBytes set_effect(const Board& board, std::size_t axis, double dead_man_s) {
  constexpr double kMostDuration_ms = 32767;
  ReportBytes report{};
  const double duration_ms = std::clamp(std::floor(1e3 * dead_man_s), 1.0, kMostDuration_ms);
  (void)encode_set_effect({.effect = board.effects[axis],
                           .duration_ms = static_cast<std::uint16_t>(duration_ms),
                           .direction_centidegrees = kDirections[axis]},
                          board.layout.force_axes,
                          std::span(report).first(board.layout.set_effect_bytes));
  return report;
}

usb::Opened<Board> set_up(Talk& talk, const usb::DeviceOptions& options, Settings& settings,
                          bool& touched) {
  const auto descriptor = parse_descriptor(talk.port().report_descriptor());
  if (!descriptor) return not_opened(descriptor.error().text);
  auto layout = layout_of(*descriptor, options.axes.size());
  if (!layout) return not_opened(layout.error().text);
  Board board{.layout = std::move(*layout)};
  for (std::size_t axis = 0; axis < board.layout.axes; ++axis)
    if (auto good = compare_range(talk, axis, options.axes[axis].counts_per_unit,
                                  board.layout.counts_of_range[axis]);
        !good)
      return tl::unexpected(good.error());
  const auto round_trip_s = measure_round_trip(talk);
  if (!round_trip_s) return tl::unexpected(round_trip_s.error());
  board.round_trip_s = *round_trip_s;
  if (auto good = compare_round_trip(board, options); !good) return tl::unexpected(good.error());
  touched = true;
  if (auto done = settings.neutralise(talk, board.layout.axes); !done)
    return tl::unexpected(done.error());
  if (auto done = make_effects(talk, board, options.openffboard.dead_man_s); !done)
    return tl::unexpected(done.error());
  return board;
}

}  // namespace hapticd::hid::openffboard
