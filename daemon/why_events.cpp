// Limits and missed ticks of a stretch of a recording.
#include <algorithm>

#include "daemon/tick_schedule.h"
#include "daemon/why_parts.h"

namespace hapticd::daemon {

double seconds_between(const RecordingView& view, std::size_t from, std::size_t to) {
  const Field* tick = view.field("tick");
  return static_cast<double>(view.whole(to, tick) - view.whole(from, tick)) / view.rate_Hz();
}

bool follows(const RecordingView& view, std::size_t i) {
  if (i == 0) return false;
  const Field* sequence = view.field("sequence");
  return sequence == nullptr || static_cast<std::uint32_t>(view.whole(i - 1, sequence) + 1) ==
                                    static_cast<std::uint32_t>(view.whole(i, sequence));
}

namespace {

/// The limit bit in record i.
void add(LimitStory& story, const RecordingView& view, std::size_t i, std::size_t end) {
  if (i == end) {
    story.at_fault = true;
    return;
  }
  story.last_s = seconds_between(view, i, end);
  if (story.ticks++ == 0) story.first_s = story.last_s;
}

}  // namespace

std::vector<LimitStory> limits_in(const RecordingView& view, Stretch stretch) {
  const Field* limits = view.field("limits");
  if (limits == nullptr) return {};
  std::vector<LimitStory> stories;
  for (const LimitEntry& row : limit_table())
    stories.push_back({.name = row.name, .meaning = row.meaning, .action = row.action});
  for (std::size_t i = stretch.first; i <= stretch.end; ++i) {
    const LimitFlags flags(static_cast<std::uint32_t>(view.whole(i, limits)));
    for (std::size_t k = 0; flags.bits() != 0 && k < stories.size(); ++k) {
      if (flags.has(limit_table()[k].bit)) add(stories[k], view, i, stretch.end);
    }
  }
  std::erase_if(stories, [](const LimitStory& s) { return s.ticks == 0 && !s.at_fault; });
  return stories;
}

namespace {

struct Blame {
  Phase phase = Phase::wake;
  double ms = 0;
};

/// Who made the gap just before record i: the phase in which the tick before passed the end of its
/// period, else the wake-up.
Blame blame_for_gap(const RecordingView& view, std::size_t i) {
  constexpr std::array<const char*, kPhases> kFields = {"wake_ns", "collect_ns", "step_ns",
                                                        "command_ns"};
  constexpr double kMs = 1e-6;
  const double period_ns = 1e9 / view.rate_Hz();
  if (follows(view, i)) {
    std::array<std::int64_t, kPhases> ends{};
    std::int64_t end = 0;
    for (std::size_t phase = 0; phase < kPhases; ++phase) {
      end += view.whole(i - 1, view.field(kFields[phase]));
      ends[phase] = end;
    }
    const auto late = phase_beyond(ends, static_cast<std::int64_t>(period_ns));
    if (late) {
      const Field* field = view.field(kFields[static_cast<std::size_t>(*late)]);
      return {*late, static_cast<double>(view.whole(i - 1, field)) * kMs};
    }
  }
  const double missed = static_cast<double>(view.whole(i, view.field("missed_ticks")));
  const double late_ns = view.at(i, "wake_ns").value_or(0);
  return {Phase::wake, (missed * period_ns + late_ns) * kMs};
}

}  // namespace

MissedStory missed_in(const RecordingView& view, Stretch stretch) {
  MissedStory story;
  const Field* missed = view.field("missed_ticks");
  for (std::size_t i = stretch.first; missed != nullptr && i <= stretch.end; ++i) {
    const std::int64_t ticks = view.whole(i, missed);
    if (ticks <= 0) continue;
    const Blame blame = blame_for_gap(view, i);
    ++story.gaps;
    story.ticks += ticks;
    story.by[static_cast<std::size_t>(blame.phase)] += ticks;
    if (ticks <= story.largest) continue;
    story.largest = ticks;
    story.largest_s = seconds_between(view, i, stretch.end);
    story.late = blame.phase;
    story.late_ms = blame.ms;
  }
  return story;
}

}  // namespace hapticd::daemon
