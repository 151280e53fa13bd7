// The parts that daemon/why.cpp puts together.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "daemon/recording_view.h"
#include "daemon/why.h"

namespace hapticd::daemon {

/// Records [first, end) of a recording; times are told before record `end`.
struct Stretch {
  std::size_t first = 0, end = 0;
};

/// By tick numbers.
double seconds_between(const RecordingView& view, std::size_t from, std::size_t to);

/// Which limits bit, in the order of the table.
std::vector<LimitStory> limits_in(const RecordingView& view, Stretch stretch);

/// Nothing was lost between record i - 1 and record i.
bool follows(const RecordingView& view, std::size_t i);

MissedStory missed_in(const RecordingView& view, Stretch stretch);

/// What the device named, or every device for "", did just before record stretch.end: the last
/// record of the stretch.
std::vector<DeviceStory> devices_in(const RecordingView& view, Stretch stretch,
                                    const std::string& device);

/// Largest force of each contact and speed of each axis, before the last record.
std::vector<Peak> peaks_of(const RecordingView& view);

}  // namespace hapticd::daemon
