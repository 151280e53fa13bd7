#include "daemon/ctl_why.h"

#include <fmt/format.h>

#include <cstdio>

#include "daemon/ctl_verbs.h"

namespace hapticd::daemon {
namespace {

std::string figure(const Term& term) {
  return fmt::format("{} {:.4g}{}{}", term.what, term.value, term.unit.empty() ? "" : " ",
                     term.unit);
}

std::string figures(const std::vector<Term>& terms) {
  std::string text;
  for (const Term& term : terms) text += (text.empty() ? "" : ", ") + figure(term);
  return text;
}

std::string ticks(std::uint64_t count) {
  return fmt::format("{} tick{}", count, count == 1 ? "" : "s");
}

std::string who(const FaultStory& fault) {
  if (!fault.axis.empty()) return "axis " + fault.axis;
  return fault.device.empty() ? "" : "device " + fault.device;
}

/// What, who and how much; then what to do.
std::string fault_text(const FaultStory& fault) {
  if (fault.row == nullptr) {
    return fmt::format(
        "fault number {}, which this hapticctl does not know\nwhat to do: use the hapticctl of the "
        "hapticd that wrote the recording\n",
        fault.code);
  }
  std::string text = fmt::format("fault {}: {}", fault.row->name, fault.row->meaning);
  if (const std::string blamed = who(fault); !blamed.empty()) text += "; " + blamed;
  if (!fault.unit.empty()) {
    text += fmt::format(": found {:.4g} {}, allowed {:.4g} {}", fault.found, fault.unit,
                        fault.allowed, fault.unit);
  }
  return text +
         fmt::format(" (set by: {})\nwhat to do: {}\n", fault.row->set_by, fault.row->action);
}

std::string when_text(const FaultStory& fault) {
  std::string text = fmt::format(
      "when: tick {}, {:.6f} s on the loop's clock, {:.3f} s before the "
      "end of the recording",
      fault.tick, fault.clock_s, fault.before_end_s);
  text += fault.left_after_s ? fmt::format("; it was left after {:.3f} s", *fault.left_after_s)
                             : "; it stood until the end";
  if (fault.earlier > 0) text += fmt::format("; {} before it in the same recording", fault.earlier);
  return text + "\n";
}

std::string mode_text(const FaultStory& fault) {
  if (fault.mode.empty()) return {};
  std::string text = fmt::format("the loop was in mode {} for {}{:.3f} s", fault.mode,
                                 fault.mode_from_start ? "at least " : "", fault.mode_s);
  if (fault.ramp) text += fmt::format(", ramp at {:.3g}", *fault.ramp);
  if (fault.unproven) text += ", with forces asked for without a proof of stability";
  return text + "\n";
}

std::string limit_text(const LimitStory& limit, std::uint64_t story_ticks) {
  std::string text = fmt::format("limit {}: ", limit.name);
  if (limit.ticks == 0) {
    text += "only in the tick of the fault";
  } else {
    text += fmt::format("in {} of the {} before, from {:.3f} s to {:.3f} s before the fault",
                        limit.ticks, ticks(story_ticks), limit.first_s, limit.last_s);
    if (limit.at_fault) text += " and in its tick";
  }
  return text + fmt::format(": {} ({})\n", limit.meaning, limit.action);
}

std::string missed_text(const MissedStory& missed) {
  if (missed.ticks == 0) return "no tick was missed\n";
  std::string text =
      fmt::format("{} missed in {} gap{}", ticks(static_cast<std::uint64_t>(missed.ticks)),
                  missed.gaps, missed.gaps == 1 ? "" : "s");
  const char* sign = " (late: ";
  for (std::size_t i = 0; i < kPhases; ++i) {
    if (missed.by[i] == 0) continue;
    text += fmt::format("{}{} {}", sign, kPhaseNames[i], missed.by[i]);
    sign = ", ";
  }
  text += fmt::format("); the largest, {}, {:.3f} s before the fault: ",
                      ticks(static_cast<std::uint64_t>(missed.largest)), missed.largest_s);
  if (missed.late == Phase::wake)
    return text + fmt::format("the wake-up came {:.3f} ms late\n", missed.late_ms);
  return text + fmt::format("{} took {:.3f} ms\n",
                            kPhaseNames[static_cast<std::size_t>(missed.late)], missed.late_ms);
}

std::string device_text(const DeviceStory& device) {
  std::string text = fmt::format("device {} just before the fault\n", device.name);
  if (!device.terms.empty()) text += "  " + figures(device.terms) + "\n";
  for (const Part& part : device.coordinates)
    text += fmt::format("  contact {}: {}\n", part.name, figures(part.terms));
  for (const Part& part : device.axes)
    text += fmt::format("  axis {}: {}\n", part.name, figures(part.terms));
  return text;
}

std::string story_text(const FaultStory& fault) {
  std::string text = fault_text(fault) + when_text(fault);
  if (fault.story_ticks == 0) return text + "the recording has nothing from before the fault\n";
  text += mode_text(fault);
  text += fmt::format("in the second before it ({} recorded{}):\n", ticks(fault.story_ticks),
                      fault.lost > 0 ? fmt::format(", {} lost", fault.lost) : "");
  if (fault.missed) text += "  " + missed_text(*fault.missed);
  if (fault.limits) {
    for (const LimitStory& limit : *fault.limits)
      text += "  " + limit_text(limit, fault.story_ticks);
    if (fault.limits->empty()) text += "  no limit bit\n";
  }
  for (const DeviceStory& device : fault.devices) text += device_text(device);
  return text;
}

std::string calm_text(const Why& why) {
  std::string text = "no fault in this recording\n";
  for (const Peak& peak : why.peaks) {
    text += fmt::format("largest {} of {}: {:.4g} {}, {:.3f} s before the end\n", peak.term.what,
                        peak.name, peak.term.value, peak.term.unit, peak.before_end_s);
  }
  for (const LimitStory& limit : why.limits) {
    text += fmt::format("limit {}: {}: {}\n", limit.name, ticks(limit.ticks + limit.at_fault),
                        limit.meaning);
  }
  return text + fmt::format("{} missed\n", ticks(static_cast<std::uint64_t>(why.missed_ticks)));
}

Json terms_json(const std::vector<Term>& terms) {
  Json json = Json::object();
  for (const Term& term : terms)
    json[std::string(term.key)] = {{"value", term.value}, {"unit", term.unit}};
  return json;
}

Json parts_json(const std::vector<Part>& parts) {
  Json json = Json::object();
  for (const Part& part : parts) json[part.name] = terms_json(part.terms);
  return json;
}

Json limits_json(const std::vector<LimitStory>& limits) {
  Json json = Json::array();
  for (const LimitStory& limit : limits) {
    json.push_back({{"limit", limit.name},
                    {"ticks", limit.ticks},
                    {"first_s", limit.first_s},
                    {"last_s", limit.last_s},
                    {"at_fault", limit.at_fault}});
  }
  return json;
}

Json missed_json(const std::optional<MissedStory>& missed) {
  if (!missed) return nullptr;
  Json by = Json::object();
  for (std::size_t i = 0; i < kPhases; ++i) by[kPhaseNames[i]] = missed->by[i];
  return {{"ticks", missed->ticks},
          {"gaps", missed->gaps},
          {"by", std::move(by)},
          {"largest", missed->largest},
          {"largest_s", missed->largest_s},
          {"late", kPhaseNames[static_cast<std::size_t>(missed->late)]},
          {"late_ms", missed->late_ms}};
}

Json devices_json(const std::vector<DeviceStory>& devices) {
  Json json = Json::object();
  for (const DeviceStory& device : devices) {
    json[device.name] = {{"device", terms_json(device.terms)},
                         {"contact", parts_json(device.coordinates)},
                         {"axes", parts_json(device.axes)}};
  }
  return json;
}

Json fault_json(const FaultStory& fault) {
  const bool figures = !fault.unit.empty();
  return {{"name", fault.row == nullptr ? Json(nullptr) : Json(fault.row->name)},
          {"code", fault.code},
          {"meaning", fault.row == nullptr ? Json(nullptr) : Json(fault.row->meaning)},
          {"action", fault.row == nullptr ? Json(nullptr) : Json(fault.row->action)},
          {"axis", fault.axis},
          {"device", fault.device},
          {"found", figures ? Json(fault.found) : Json(nullptr)},
          {"allowed", figures ? Json(fault.allowed) : Json(nullptr)},
          {"unit", fault.unit},
          {"tick", fault.tick},
          {"clock_s", fault.clock_s},
          {"before_end_s", fault.before_end_s},
          {"left_after_s", fault.left_after_s ? Json(*fault.left_after_s) : Json(nullptr)},
          {"earlier", fault.earlier},
          {"mode", fault.mode},
          {"mode_s", fault.mode_s},
          {"mode_from_start", fault.mode_from_start},
          {"ramp", fault.ramp ? Json(*fault.ramp) : Json(nullptr)},
          {"unproven", fault.unproven},
          {"story_ticks", fault.story_ticks},
          {"lost", fault.lost},
          {"missed", missed_json(fault.missed)},
          {"limits", fault.limits ? limits_json(*fault.limits) : Json(nullptr)},
          {"devices", devices_json(fault.devices)}};
}

Json peaks_json(const std::vector<Peak>& peaks) {
  Json json = Json::array();
  for (const Peak& peak : peaks) {
    json.push_back({{"of", peak.name},
                    {"what", peak.term.key},
                    {"value", peak.term.value},
                    {"unit", peak.term.unit},
                    {"before_end_s", peak.before_end_s}});
  }
  return json;
}

}  // namespace

std::string why_text(const Why& why) {
  std::string text = fmt::format("{} records, {:.3f} s", why.records, why.length_s);
  if (why.torn_bytes > 0)
    text += fmt::format("; cut short: its last {} bytes are no whole record", why.torn_bytes);
  if (why.records == 0) return text + "\nthe recording is empty\n";
  return text + "\n" + (why.fault ? story_text(*why.fault) : calm_text(why));
}

Json why_json(const Why& why) {
  return {{"ok", true},
          {"records", why.records},
          {"torn_bytes", why.torn_bytes},
          {"length_s", why.length_s},
          {"missed_ticks", why.missed_ticks},
          {"largest", peaks_json(why.peaks)},
          {"limits", limits_json(why.limits)},
          {"fault", why.fault ? fault_json(*why.fault) : Json(nullptr)}};
}

ExitCode run_why(const std::string& recording_path, bool json) {
  const auto recording = read_recording(recording_path);
  if (!recording) return print_error(recording.error(), json);
  auto told = why(*recording);
  if (!told) {
    return print_error({recording_path + ": " + told.error().text, told.error().code}, json);
  }
  std::fputs(json ? (to_text(why_json(*told)) + "\n").c_str() : why_text(*told).c_str(), stdout);
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
