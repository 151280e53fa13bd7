// What led to a fault, read out of a recording, for `hapticctl why`. Pure.
//
// Everything is read by the names in the recording's own header: a file of another version tells
// what it has, and what was not recorded is not told. Times are counted in ticks, so that a clock
// that jumped does not matter.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "control/core/fault.h"
#include "daemon/recording.h"
#include "daemon/servo_shared.h"

namespace hapticd::daemon {

/// The story is that of the last second before the fault.
inline constexpr double kStory_s = 1;

/// A figure with its words.
struct Term {
  std::string_view key;   ///< for machines: "scene_force"
  std::string_view what;  ///< for people: "scene"
  double value = 0;
  std::string unit;  ///< for people: "N m"; "": none
};

/// An axis, or a coordinate of a contact, just before the fault.
struct Part {
  std::string name;
  std::vector<Term> terms;
};

struct DeviceStory {
  std::string name;
  std::vector<Term> terms{};
  std::vector<Part> coordinates{}, axes{};
};

struct LimitStory {
  std::string_view name, meaning, action;
  std::uint64_t ticks = 0;  ///< of the story, without the tick of the fault
  double first_s = 0;       ///< before the fault
  double last_s = 0;        ///< before the fault
  bool at_fault = false;    ///< in the tick of the fault too
};

/// Missed ticks of the story, those right before the fault included.
struct MissedStory {
  std::int64_t ticks = 0, gaps = 0;
  std::array<std::int64_t, kPhases> by{};  ///< by the phase that was late
  std::int64_t largest = 0;                ///< gap [ticks]
  double largest_s = 0;                    ///< before the fault
  Phase late = Phase::wake;                ///< the phase that made the largest gap ...
  double late_ms = 0;                      ///< ... by taking so long (wake: by coming so late)
};

struct FaultStory {
  std::uint32_t code = 0;
  const FaultEntry* row = nullptr;  ///< nullptr: a code that this program does not know
  std::string axis, device;         ///< to blame; "" where none is
  double found = 0, allowed = 0;
  std::string unit;  ///< "": the fault has no figure
  std::int64_t tick = 0;
  double clock_s = 0;                  ///< start of that tick on the loop's clock
  double before_end_s = 0;             ///< of the recording
  std::optional<double> left_after_s;  ///< when it was left, if the recording goes so far
  std::size_t earlier = 0;             ///< other faults before it in the same recording
  std::string_view mode;               ///< just before; "" unknown
  double mode_s = 0;                   ///< that mode had lasted so long ...
  bool mode_from_start = false;        ///< ... at least: the recording begins in it
  std::optional<double> ramp;          ///< share of the force let through, just before
  bool unproven = false;               ///< forces were asked for without a proof of stability
  std::uint64_t story_ticks = 0;       ///< records of the story; 0: nothing before was recorded
  std::uint64_t lost = 0;              ///< records of the story that are not in the file
  std::optional<std::vector<LimitStory>> limits;  ///< none: not recorded
  std::optional<MissedStory> missed;              ///< none: not recorded
  std::vector<DeviceStory> devices;               ///< the one to blame, or all
};

/// A largest value over the whole recording.
struct Peak {
  std::string name;
  Term term;
  double before_end_s = 0;
};

struct Why {
  std::size_t records = 0, torn_bytes = 0;
  double length_s = 0;
  std::int64_t missed_ticks = 0;   ///< over the whole recording
  std::vector<LimitStory> limits;  ///< over the whole recording: only names and ticks
  std::vector<Peak> peaks;         ///< force of each contact, speed of each axis
  std::optional<FaultStory> fault;
};

/// bad_data: a recording, but not one of a loop of hapticd.
Result<Why> why(const Recording& recording);

}  // namespace hapticd::daemon
