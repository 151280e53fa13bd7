#include "daemon/plot_recording.h"

#include <algorithm>
#include <filesystem>

#include "control/core/fault.h"
#include "daemon/recording_view.h"

namespace hapticd::daemon {
namespace {

/// "m, rad" of the units of fields; "" where none has any.
std::string units(const std::vector<const Field*>& fields) {
  std::string text;
  std::vector<std::string> known;
  for (const Field* field : fields) {
    if (field->unit == "-" || std::find(known.begin(), known.end(), field->unit) != known.end())
      continue;
    text += (text.empty() ? "" : ", ") + field->unit;
    known.push_back(field->unit);
  }
  return text;
}

/// The records of a time range.
class Range {
 public:
  Range(const Recording& recording, const PlotOptions& options)
      : view_(recording), tick_(view_.field("tick")) {
    for (std::size_t i = 0; i < view_.size(); ++i) {
      const double t = time_s(i);
      if (t >= options.from && t <= options.to) records_.push_back(i);
    }
  }
  const RecordingView& view() const { return view_; }
  const std::vector<std::size_t>& records() const { return records_; }
  double time_s(std::size_t i) const {
    const double ticks = tick_ == nullptr
                             ? static_cast<double>(i)
                             : static_cast<double>(view_.whole(i, tick_) - view_.whole(0, tick_));
    return ticks / view_.rate_Hz();
  }

  Panel panel(const std::string& name, const std::vector<const Field*>& fields) const {
    const std::string unit = units(fields);
    Panel panel{.label = unit.empty() ? name : name + " [" + unit + "]"};
    for (const Field* field : fields) {
      Curve curve{.title = field->name};
      for (const std::size_t i : records_) {
        curve.x.push_back(time_s(i));
        curve.y.push_back(view_.value(i, *field));
      }
      panel.curves.push_back(std::move(curve));
    }
    return panel;
  }

 private:
  RecordingView view_;
  const Field* tick_;
  std::vector<std::size_t> records_;
};

/// Fields "<of the device>...<suffix>", in the order of the file.
std::vector<const Field*> device_fields(const Recording& recording, const std::string& device,
                                        const std::string& suffix) {
  std::vector<const Field*> found;
  for (const Field& field : recording.header.fields) {
    if (belongs(field.name, device) && field.name.ends_with(suffix)) found.push_back(&field);
  }
  return found;
}

std::vector<Panel> usual_panels(const Recording& recording, const Range& range) {
  std::vector<Panel> panels;
  for (const std::string& device : range.view().devices()) {
    auto place = device_fields(recording, device, ".position");
    for (const Field* proxy : device_fields(recording, device, ".proxy")) place.push_back(proxy);
    panels.push_back(range.panel(device + " position", place));
    panels.push_back(range.panel(device + " force", device_fields(recording, device, ".force")));
    panels.push_back(range.panel(device + " effort", device_fields(recording, device, ".effort")));
  }
  std::erase_if(panels, [](const Panel& panel) { return panel.curves.empty(); });
  return panels;
}

Result<std::vector<Panel>> named_panels(const Recording& recording, const std::string& path,
                                        const Range& range, const std::vector<std::string>& names) {
  std::vector<Panel> panels;
  for (const std::string& name : names) {
    std::vector<const Field*> found;
    for (const Field& field : recording.header.fields) {
      if (field.name == name || field.name.ends_with("." + name)) found.push_back(&field);
    }
    if (found.empty()) {
      return fail(ExitCode::usage, path + " has no field '" + name +
                                       "'; its first line of `hapticctl export FILE --csv -o -` "
                                       "names those that it has");
    }
    panels.push_back(range.panel(name, found));
  }
  return panels;
}

/// Marks of where one bit of `bits` is set, runs that are nearer than `gap_s` as one.
void mark_limit(const Range& range, const Field* bits, const LimitEntry& limit, double gap_s,
                std::vector<Mark>& marks) {
  bool first = true, open = false;
  for (const std::size_t i : range.records()) {
    const auto value = static_cast<std::uint32_t>(range.view().whole(i, bits));
    if (!LimitFlags(value).has(limit.bit)) continue;
    const double t = range.time_s(i);
    if (open && t - marks.back().to <= gap_s) {
      marks.back().to = t;
      continue;
    }
    marks.push_back({.kind = Mark::Kind::limit,
                     .from = t,
                     .to = t,
                     .text = first ? "limit " + std::string(limit.name) : ""});
    first = false;
    open = true;
  }
}

void mark_faults(const Range& range, const Field* fault, std::vector<Mark>& marks) {
  std::int64_t before = 0;
  for (const std::size_t i : range.records()) {
    const std::int64_t code = range.view().whole(i, fault);
    if (code != before && code > 0) {
      const bool known = code < static_cast<std::int64_t>(Fault::count_);
      const double t = range.time_s(i);
      marks.push_back({.kind = Mark::Kind::fault,
                       .from = t,
                       .to = t,
                       .text = "fault " + (known ? std::string(entry(static_cast<Fault>(code)).name)
                                                 : std::to_string(code))});
    }
    before = code;
  }
}

std::vector<Mark> marks_of(const Range& range, std::size_t columns) {
  std::vector<Mark> marks;
  if (range.records().empty()) return marks;
  const double length_s =
      range.time_s(range.records().back()) - range.time_s(range.records().front());
  const double column_s =
      std::max(1 / range.view().rate_Hz(), length_s / static_cast<double>(columns));
  const Field* limits = range.view().field("limits");
  for (const LimitEntry& limit : limit_table()) {
    if (limits != nullptr) mark_limit(range, limits, limit, 1.5 * column_s, marks);
  }
  for (Mark& mark : marks) mark.to += column_s;  // never narrower than what can be seen
  if (const Field* fault = range.view().field("fault")) mark_faults(range, fault, marks);
  return marks;
}

}  // namespace

Result<Picture> recording_picture(const Recording& recording, const std::string& path,
                                  const PlotOptions& options) {
  const Range range(recording, options);
  Picture picture{.title = std::filesystem::path(path).filename().string(),
                  .x_label = "time since the first record [s]",
                  .marks = marks_of(range, options.width)};
  if (options.fields.empty()) {
    picture.panels = usual_panels(recording, range);
    return picture;
  }
  auto panels = named_panels(recording, path, range, options.fields);
  if (!panels) return tl::unexpected(panels.error());
  picture.panels = std::move(*panels);
  return picture;
}

Result<Picture> recording_picture(const std::string& path, const PlotOptions& options) {
  return read_recording(path).and_then(
      [&](const Recording& recording) { return recording_picture(recording, path, options); });
}

}  // namespace hapticd::daemon
