#include "daemon/ctl_cost.h"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <cstdio>
#include <fstream>

#include "daemon/cost_table.h"
#include "daemon/ctl_check.h"

namespace hapticd::daemon {
namespace {

/// What stands behind the colon of the first line that begins with `key`.
std::string line_of(const char* path, std::string_view key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t colon = line.find(": ");
    return colon == std::string::npos ? line : line.substr(colon + 2);
  }
  return "unknown";
}

std::string ns(double value) {
  return fmt::format("{:.{}f} ns", value, value < 10 ? 1 : 0);
}

std::string measured(const Cost& cost) {
  if (!cost.measured) return "-";
  const Figure& figure = *cost.measured;
  if (figure.ns == 0 && figure.resolution_ns == 0) return "0";
  return figure.seen() ? ns(figure.ns) : "< " + ns(figure.resolution_ns);
}

std::string share(const Cost& cost, double period_ns) {
  if (!cost.measured || !cost.measured->seen()) return "";
  return fmt::format("{:.3f} %", 100 * cost.measured->ns / period_ns);
}

std::string row(const std::string& part, const Cost& cost, double period_ns) {
  std::string text = fmt::format("{:<38}{:>12}{:>14}{:>11}", part,
                                 cost.predicted_ns > 0 ? ns(cost.predicted_ns) : "0",
                                 measured(cost), share(cost, period_ns));
  if (!cost.note.empty()) text += "  " + cost.note;
  return text + "\n";
}

std::string object_rows(const ObjectCost& object, double period_ns) {
  const std::string who = object.count == 1
                              ? object.kind + " " + object.name
                              : fmt::format("and {} more of kind {}", object.count, object.kind);
  return row(who + ", far away", object.distant, period_ns) +
         row(who + ", touched", object.touched, period_ns);
}

Json cost_fields(const Cost& cost, double period_ns) {
  const bool seen = cost.measured && cost.measured->seen();
  return {{"predicted_ns", cost.predicted_ns},
          {"measured_ns", seen ? Json(cost.measured->ns) : Json(nullptr)},
          {"resolution_ns", cost.measured ? Json(cost.measured->resolution_ns) : Json(nullptr)},
          {"share", seen ? Json(cost.measured->ns / period_ns) : Json(nullptr)},
          {"note", cost.note}};
}

Json object_json(const ObjectCost& object, double period_ns) {
  return {{"kind", object.kind},
          {"name", object.name},
          {"count", object.count},
          {"distant", cost_fields(object.distant, period_ns)},
          {"touched", cost_fields(object.touched, period_ns)}};
}

}  // namespace

Machine this_machine() {
  utsname name{};
  ::uname(&name);
  return {.processor = line_of("/proc/cpuinfo", "model name"),
          .kernel = fmt::format("{} {} {}", name.sysname, name.release, name.machine),
          .load = line_of("/proc/loadavg", "").substr(0, 4)};
}

std::string cost_text(const CostReport& report, const Machine& machine) {
  std::string text = fmt::format(
      "period {:.0f} ns\n"
      "measured   on {}, {}, load {}: medians of {} batches of {} ticks; two runs of the same "
      "differ by {}\n"
      "predicted  for {}\n\n{:<38}{:>12}{:>14}{:>11}\n",
      report.period_ns, machine.processor, machine.kernel, machine.load, kBatches,
      report.ticks / kBatches, ns(report.floor_ns), kReferenceMachine, "part, per tick",
      "predicted", "measured", "of period");
  for (const StageCost& stage : report.stages)
    text += row(stage.name, stage.cost, report.period_ns);
  for (const ObjectCost& object : report.objects) text += object_rows(object, report.period_ns);
  text += row("total, nothing touched", report.untouched, report.period_ns);
  if (!report.busiest_name.empty())
    text += row("total, " + report.busiest_name + " touched", report.busiest, report.period_ns);
  return text;
}

Json cost_json(const CostReport& report, const Machine& machine) {
  Json stages = Json::object(), objects = Json::array();
  for (const StageCost& stage : report.stages)
    stages[stage.name] = cost_fields(stage.cost, report.period_ns);
  for (const ObjectCost& object : report.objects)
    objects.push_back(object_json(object, report.period_ns));
  return {{"ok", true},
          {"period_ns", report.period_ns},
          {"ticks", report.ticks},
          {"floor_ns", report.floor_ns},
          {"machine",
           {{"processor", machine.processor}, {"kernel", machine.kernel}, {"load", machine.load}}},
          {"predicted_for", kReferenceMachine},
          {"stages", std::move(stages)},
          {"objects", std::move(objects)},
          {"untouched", cost_fields(report.untouched, report.period_ns)},
          {"busiest", cost_fields(report.busiest, report.period_ns)},
          {"busiest_object", report.busiest_name}};
}

ExitCode run_cost(const std::string& config_path, const CostOptions& options, bool json) {
  const auto compiled = config::load(config_path);
  if (!compiled) return print_config_errors(compiled.error(), json);
  const CostReport report = cost(*compiled, options);
  if (json) {
    std::puts(to_text(cost_json(report, this_machine())).c_str());
  } else {
    std::fputs(cost_text(report, this_machine()).c_str(), stdout);
  }
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
