#include "daemon/ctl_doctor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "daemon/ctl_check.h"
#include "daemon/ctl_verbs.h"
#include "daemon/doctor_measure.h"
#include "daemon/interrupts.h"

namespace hapticd::daemon {
namespace {

const char* name_of(Severity severity) {
  return kSeverityNames[static_cast<std::size_t>(severity)];
}

/// SCHED_FIFO that the limits allow and the kernel refuses all the same.
void add_refusals(const RealtimeReport& rights, std::vector<Finding>& findings) {
  const bool allowed = std::ranges::none_of(findings, [](const Finding& one) {
    return one.topic == "real-time priority" && one.severity == Severity::bad;
  });
  for (const MissingRight& missing : rights.missing) {
    if (!missing.right.starts_with("SCHED_FIFO") || !allowed) continue;
    findings.push_back({"scheduling", Severity::bad, missing.right + ": " + missing.reason,
                        "a control group without a real-time budget (CONFIG_RT_GROUP_SCHED) or a "
                        "container without CAP_SYS_NICE: " +
                            missing.grant});
  }
}

Json to_json(const std::vector<Finding>& findings, bool sound) {
  Json list = Json::array();
  for (const Finding& one : findings) {
    list.push_back({{"topic", one.topic},
                    {"severity", name_of(one.severity)},
                    {"found", one.found},
                    {"fix", one.fix.empty() ? Json(nullptr) : Json(one.fix)}});
  }
  return {{"ok", sound}, {"findings", std::move(list)}};
}

std::string to_lines(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& one : findings) {
    text += fmt::format("{:<8}{}: {}\n", name_of(one.severity), one.topic, one.found);
    if (!one.fix.empty()) text += fmt::format("{:<8}  do: {}\n", "", one.fix);
  }
  return text;
}

Result<Measured> watch(const DoctorOptions& options, config::Compiled* compiled) {
  std::fprintf(stderr, "watching the loop for %g s, forces off\n", options.seconds);
  if (compiled) return measure(*compiled, options.seconds, interrupts());
  return measure_wake_ups(options.priority, options.seconds, interrupts());
}

}  // namespace

ExitCode run_doctor(const DoctorOptions& options, bool json) {
  std::optional<config::Compiled> compiled;
  int priority = options.priority;
  if (!options.config.empty()) {
    auto loaded = config::load(options.config);
    if (!loaded) return print_config_errors(loaded.error(), json);
    compiled.emplace(std::move(*loaded));
    priority = compiled->document.config.loop.priority;
  }
  std::vector<Finding> findings = examine(KernelFiles(), rights_of_this_process(), priority);
  auto measured = watch(options, compiled ? &*compiled : nullptr);
  if (!measured) return print_error(measured.error(), json);
  add_refusals(measured->rights, findings);
  for (Finding& one : judge(measured->times)) findings.push_back(std::move(one));
  const bool sound = std::ranges::none_of(
      findings, [](const Finding& one) { return one.severity == Severity::bad; });
  std::fputs(json ? (to_text(to_json(findings, sound)) + "\n").c_str() : to_lines(findings).c_str(),
             stdout);
  return sound ? ExitCode::ok : ExitCode::no;
}

}  // namespace hapticd::daemon
