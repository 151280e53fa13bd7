#include "daemon/why.h"

#include <bit>

#include "control/state.h"
#include "daemon/lifecycle.h"
#include "daemon/why_parts.h"

namespace hapticd::daemon {
namespace {

constexpr std::array<std::string_view, 4> kModeNames = {"idle", "enabled", "fault", "homing"};
constexpr std::uint8_t kUnprovenFlag = 4;  // of RecordHeader::flags

/// The same fault as in the record before: code, axis, device and figures (a NaN is its own like).
bool same_fault(const RecordingView& view, std::size_t a, std::size_t b) {
  for (const char* name : {"fault", "fault_axis", "fault_device", "fault_found"}) {
    const auto left = view.at(a, name), right = view.at(b, name);
    if (left && std::bit_cast<std::uint64_t>(*left) != std::bit_cast<std::uint64_t>(*right))
      return false;
  }
  return true;
}

/// Every record in which a fault begins.
std::vector<std::size_t> onsets(const RecordingView& view) {
  const Field& fault = *view.field("fault");
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < view.size(); ++i) {
    const bool begins = view.whole(i, &fault) != 0 && (i == 0 || !same_fault(view, i - 1, i));
    if (begins) found.push_back(i);
  }
  return found;
}

std::string name_at(const std::vector<std::string>& names, std::int64_t index) {
  const auto i = static_cast<std::size_t>(index);  // kNoIndex, or a negative one, is beyond all
  return i < names.size() ? names[i] : std::string();
}

void tell_who(const RecordingView& view, std::size_t onset, FaultStory& story) {
  const auto index = [&](const char* name) {
    const Field* field = view.field(name);
    return field == nullptr ? kNoIndex : view.whole(onset, field);
  };
  story.axis = name_at(view.axes(), index("fault_axis"));
  story.device = name_at(view.devices(), index("fault_device"));
  if (!story.device.empty()) return;
  for (const std::string& device : view.devices()) {
    if (belongs(story.axis, device)) story.device = device;
  }
}

void tell_what(const RecordingView& view, std::size_t onset, FaultStory& story) {
  story.code = static_cast<std::uint32_t>(view.whole(onset, view.field("fault")));
  if (story.code < static_cast<std::uint32_t>(Fault::count_))
    story.row = &entry(static_cast<Fault>(story.code));
  tell_who(view, onset, story);
  if (story.row == nullptr) return;
  const Field* position = view.field(story.axis + ".q");
  story.unit = fault_unit(story.row->code, position != nullptr && position->unit == "rad");
  story.found = view.at(onset, "fault_found").value_or(0);
  story.allowed = view.at(onset, "fault_allowed").value_or(0);
}

void tell_when(const RecordingView& view, std::size_t onset, FaultStory& story) {
  story.tick = view.whole(onset, view.field("tick"));
  story.clock_s = view.at(onset, "time_ns").value_or(0) * 1e-9;
  story.before_end_s = seconds_between(view, onset, view.size() - 1);
  std::size_t last = onset;
  while (last + 1 < view.size() && same_fault(view, last + 1, onset)) ++last;
  if (last + 1 < view.size()) story.left_after_s = seconds_between(view, onset, last + 1);
}

/// The mode of the record before the fault, and since when.
void tell_mode(const RecordingView& view, std::size_t onset, FaultStory& story) {
  const Field* mode = view.field("mode");
  if (mode == nullptr || onset == 0) return;
  const std::int64_t before = view.whole(onset - 1, mode);
  if (before < 0 || before >= std::ssize(kModeNames)) return;
  story.mode = kModeNames[static_cast<std::size_t>(before)];
  std::size_t first = onset - 1;
  while (first > 0 && view.whole(first - 1, mode) == before) --first;
  story.mode_s = seconds_between(view, first, onset);
  story.mode_from_start = first == 0;
  story.ramp = view.at(onset - 1, "ramp");
  const Field* flags = view.field("flags");
  story.unproven = (view.whole(onset - 1, flags) & kUnprovenFlag) != 0;
}

FaultStory story_of(const RecordingView& view, std::size_t onset) {
  FaultStory story;
  tell_what(view, onset, story);
  tell_when(view, onset, story);
  tell_mode(view, onset, story);
  Stretch stretch{.first = onset, .end = onset};
  while (stretch.first > 0 && seconds_between(view, stretch.first - 1, onset) <= kStory_s)
    --stretch.first;
  story.story_ticks = onset - stretch.first;
  if (view.field("sequence") != nullptr && story.story_ticks > 0) {
    const Field* sequence = view.field("sequence");
    const auto written = static_cast<std::uint32_t>(view.whole(onset, sequence)) -
                         static_cast<std::uint32_t>(view.whole(stretch.first, sequence));
    if (written > story.story_ticks) story.lost = written - story.story_ticks;
  }
  if (view.field("limits") != nullptr) story.limits = limits_in(view, stretch);
  if (view.field("missed_ticks") != nullptr) story.missed = missed_in(view, stretch);
  story.devices = devices_in(view, stretch, story.device);
  return story;
}

/// What can be told of any recording, fault or not.
Why whole_story(const RecordingView& view) {
  Why why;
  why.records = view.size();
  if (view.size() == 0) return why;
  const std::size_t last = view.size() - 1;
  why.length_s = seconds_between(view, 0, last);
  why.missed_ticks = missed_in(view, {.first = 0, .end = last}).ticks;
  why.limits = limits_in(view, {.first = 0, .end = last});
  why.peaks = peaks_of(view);
  return why;
}

}  // namespace

Result<Why> why(const Recording& recording) {
  const RecordingView view(recording);
  for (const char* name : {"tick", "fault"}) {
    if (view.field(name) == nullptr) {
      return fail(ExitCode::bad_data,
                  std::string("has no field '") + name +
                      "': not a recording of hapticd's loop (flight recorder, telemetry.record or "
                      "`hapticctl simulate`)");
    }
  }
  Why told = whole_story(view);
  told.torn_bytes = recording.torn_bytes;
  const std::vector<std::size_t> faults = onsets(view);
  if (faults.empty()) return told;
  told.fault = story_of(view, faults.back());
  told.fault->earlier = faults.size() - 1;
  return told;
}

}  // namespace hapticd::daemon
