// An OpenFFBoard from opened to ready: its reports are known, its range is the configured one, nothing but the effects made
// here acts on it, and its force is off.
#pragma once
#include <array>
#include <cstdint>

#include "drivers/hid/openffboard_layout.h"
#include "drivers/hid/openffboard_talk.h"
#include "drivers/usb/options.h"

namespace hapticd::hid::openffboard {

struct Board {
  Layout layout{};
  std::array<std::uint8_t, kMostAxes> effects{};  ///< index of the constant force of each axis
  double round_trip_s = 0;                        ///< of a question and its answer
};

/// `settings`: what it has changed there, also where it fails; `touched`: the board is no longer as it was found.
usb::Opened<Board> set_up(Talk& talk, const usb::DeviceOptions& options, Settings& settings,
                          bool& touched);

/// From one sample to the next, at most, for samples to be young enough [s].
double most_between_samples_s(const usb::DeviceOptions& options) noexcept;

/// Set Effect of an axis. The firmware enables the actuators with it.
ReportBytes set_effect(const Board& board, std::size_t axis, double dead_man_s);

}  // namespace hapticd::hid::openffboard
