// What a device felt, was asked and delivered just before the end of a stretch of a recording.
#include <algorithm>
#include <array>
#include <cmath>

#include "control/core/sample.h"
#include "daemon/why_parts.h"

namespace hapticd::daemon {
namespace {

/// A recorded field in people's words. `after`: the record at the end of the stretch has it, for
/// that tick's input tells what became of the tick before.
struct Wording {
  std::string_view key;
  std::string_view what;
  bool after = false;
};

constexpr std::array kOfAxis = {
    Wording{"q", "position"},
    Wording{"qd", "speed"},
    Wording{"gravity", "gravity compensation"},
    Wording{"friction", "friction compensation"},
    Wording{"observer", "disturbance observer"},
    Wording{"residual", "disturbance, unfiltered"},
    Wording{"travel", "spring at the end of the travel"},
    Wording{"effort", "asked of the device"},
    Wording{"delivered", "delivered", true},
};

constexpr std::array kOfCoordinate = {
    Wording{"position", "position"},
    Wording{"hand_force", "force of the hand, measured"},
    Wording{"scene_force", "scene"},
    Wording{"observer_force", "disturbance observer"},
    Wording{"contact_residual", "disturbance, unfiltered"},
    Wording{"limited", "taken away by ramp, limits and fade"},
    Wording{"force", "left of the scene's force"},
};

constexpr std::array kOfDevice = {
    Wording{"work", "work of its motors since the start"},
    Wording{"reserve", "reserve of its passivity controller"},
    Wording{"gain", "gain of its passivity controller"},
    Wording{"fade", "fade"},
};

std::string unit_for_people(const std::string& unit) {
  if (unit == "-") return {};
  return unit == "N*m" ? "N m" : unit;
}

template <std::size_t N>
std::vector<Term> terms_of(const RecordingView& view, Stretch stretch, const std::string& owner,
                           const std::array<Wording, N>& wordings) {
  std::vector<Term> terms;
  for (const Wording& wording : wordings) {
    const Field* field = view.field(owner + "." + std::string(wording.key));
    if (field == nullptr || (wording.after && !follows(view, stretch.end))) continue;
    const double value = view.value(wording.after ? stretch.end : stretch.end - 1, *field);
    terms.push_back({wording.key, wording.what, value, unit_for_people(field->unit)});
  }
  return terms;
}

/// Over the whole stretch: the largest speed, the oldest sample, ticks without a fresh one. Samples
/// count up to that of the faulty tick itself, which may be what was wrong; for the same reason
/// nothing is made of its position.
void add_extremes(const RecordingView& view, Stretch stretch, Part& axis) {
  const Field* speed = view.field(axis.name + ".qd");
  const Field* age = view.field(axis.name + ".age_ns");
  const Field* freshness = view.field(axis.name + ".freshness");
  const Field* limits = view.field(axis.name + ".drive_limits");
  double fastest = 0, oldest_ns = 0, not_fresh = 0, limited = 0;
  for (std::size_t i = stretch.first; i <= stretch.end; ++i) {
    if (speed != nullptr && i < stretch.end)
      fastest = std::fmax(fastest, std::abs(view.value(i, *speed)));
    if (age != nullptr) oldest_ns = std::fmax(oldest_ns, view.value(i, *age));
    const bool fresh = view.whole(i, freshness) >= static_cast<std::int64_t>(Freshness::fresh);
    if (freshness != nullptr && !fresh) ++not_fresh;
    if (limits != nullptr && view.whole(i, limits) != 0) ++limited;
  }
  if (speed != nullptr)
    axis.terms.push_back({"largest_speed", "largest speed", fastest, unit_for_people(speed->unit)});
  if (age != nullptr)
    axis.terms.push_back({"oldest_sample_ms", "oldest sample", oldest_ns * 1e-6, "ms"});
  if (freshness != nullptr)
    axis.terms.push_back({"ticks_without_sample", "ticks without a fresh sample", not_fresh, ""});
  if (limited > 0)
    axis.terms.push_back(
        {"ticks_limited_by_drive", "ticks in which the drive limited its torque", limited, ""});
}

DeviceStory device_in(const RecordingView& view, Stretch stretch, const std::string& name) {
  DeviceStory story{.name = name, .terms = terms_of(view, stretch, name, kOfDevice)};
  if (const Field* work = view.field(name + ".work"); work != nullptr) {
    story.terms.push_back({"recent_work", "work of its motors in the last second",
                           view.value(stretch.end - 1, *work) - view.value(stretch.first, *work),
                           "J"});
  }
  for (const std::string& coordinate : view.coordinates()) {
    if (belongs(coordinate, name))
      story.coordinates.push_back({coordinate, terms_of(view, stretch, coordinate, kOfCoordinate)});
  }
  for (const std::string& axis : view.axes()) {
    if (!belongs(axis, name)) continue;
    story.axes.push_back({axis, terms_of(view, stretch, axis, kOfAxis)});
    add_extremes(view, stretch, story.axes.back());
  }
  return story;
}

/// The record with the largest `size`, which is a number.
template <class Size>
Peak peak_of(const RecordingView& view, std::string name, Term term, Size size) {
  Peak peak{.name = std::move(name), .term = std::move(term)};
  std::size_t at = 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    const double value = size(i);
    if (!(value > peak.term.value)) continue;
    peak.term.value = value;
    at = i;
  }
  peak.before_end_s = seconds_between(view, at, view.size() - 1);
  return peak;
}

}  // namespace

std::vector<DeviceStory> devices_in(const RecordingView& view, Stretch stretch,
                                    const std::string& device) {
  std::vector<DeviceStory> stories;
  if (stretch.first == stretch.end) return stories;
  for (const std::string& name : view.devices()) {
    if (device.empty() || name == device) stories.push_back(device_in(view, stretch, name));
  }
  return stories;
}

std::vector<Peak> peaks_of(const RecordingView& view) {
  std::vector<Peak> peaks;
  for (const std::string& device : view.devices()) {
    std::vector<const Field*> force;
    for (const std::string& coordinate : view.coordinates()) {
      const Field* field = view.field(coordinate + ".force");
      if (belongs(coordinate, device) && field != nullptr) force.push_back(field);
    }
    const auto norm = [&](std::size_t i) {
      double square = 0;
      for (const Field* field : force) square += std::pow(view.value(i, *field), 2);
      return std::sqrt(square);
    };
    if (!force.empty()) peaks.push_back(peak_of(view, device, {"force", "force", 0, "N"}, norm));
  }
  for (const std::string& axis : view.axes()) {
    const Field* speed = view.field(axis + ".qd");
    if (speed == nullptr) continue;
    const auto size = [&](std::size_t i) { return std::abs(view.value(i, *speed)); };
    peaks.push_back(peak_of(view, axis, {"speed", "speed", 0, unit_for_people(speed->unit)}, size));
  }
  return peaks;
}

}  // namespace hapticd::daemon
