#include "daemon/hapticctl_certify.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "control/design/check/exact.h"
#include "control/design/synthesis/theorem3.h"
#include "daemon/ctl_check.h"
#include "daemon/ctl_verbs.h"
#include "daemon/hapticctl_groups.h"
#include "daemon/hapticctl_robust.h"
#include "daemon/output_check.h"
#include "daemon/output_file.h"
#include "daemon/stability_json.h"

namespace hapticd::daemon {
namespace {

/// Why a group has no answer of this kind; null: it has one.
Json unavailable(const Group& group, const std::string& why) {
  return {{"devices", group.names}, {"answer", "not available"}, {"why", why}};
}

Json exact_json(const Group& group, double period_s) {
  if (!group.linear)
    return unavailable(group, "something other than coupling and network acts on these devices");
  if (group.damping.size() == 0) return unavailable(group, "no damping of the devices is known");
  const double margin =
      check::exact_margin(group.model.F, group.damping, group.latency_s, period_s);
  return {{"devices", group.names},
          {"answer", margin > 0 ? "passive" : "not passive"},
          {"margin_Ns_m", std::isfinite(margin) ? Json(margin) : Json(nullptr)},
          {"latency_s", group.latency_s},
          {"void", "once the scene changes or a force reaches its limit"}};
}

Json paper_json(const config::Compiled& compiled, const Group& group, double period_s) {
  if (group.damping.size() == 0) return unavailable(group, "no damping of the devices is known");
  if (!group.model.all_coupled)
    return unavailable(group, "Theorem 3 is about couplings of all coordinates");
  if (group.latency_s > 0) return unavailable(group, "Theorem 3 knows no latency");
  const synthesis::Theorem3 found = synthesis::theorem3(loop_of(group, period_s), group.model.V);
  if (!found.decided) return unavailable(group, found.why);
  Json limits = Json::array();
  for (std::size_t i = 0; i < found.limits.size(); ++i) {
    limits.push_back({{"coordinate", coordinate_name(compiled, group.model.coordinates[i])},
                      {"share", found.limits[i]}});
  }
  return {{"devices", group.names},
          {"answer", found.stable ? "stable" : "not shown to be stable"},
          {"margin_Ns_m", found.margin_Ns_m},
          {"limits", std::move(limits)},
          {"why", found.why.empty() ? Json(nullptr) : Json(found.why)}};
}

struct Answers {
  Gate gate;
  Json exact = Json::array();
  Json paper = Json::array();
  RobustReport robust{};
};

Answers answers_for(const config::Compiled& compiled) {
  Answers answers{.gate = stability_gate(compiled)};
  const double period_s = compiled.program->plan().period_s;
  for (const Group& group : groups_of(compiled)) {
    answers.exact.push_back(exact_json(group, period_s));
    answers.paper.push_back(paper_json(compiled, group, period_s));
  }
  answers.robust = robust_report(compiled);
  return answers;
}

std::string lines_of(const check::PassiveAnswer& answer) {
  std::string text;
  if (!answer.worst_pose.empty()) text += "    worst pose: " + answer.worst_pose + "\n";
  for (const check::ObjectNote& note : answer.uncertified)
    text += "    not certified: " + note.object + " " + note.reason + "\n";
  for (const std::string& what : answer.uncovered) text += "    not covered: " + what + "\n";
  return text;
}

std::string passive_text(const Gate& gate) {
  std::string text = "passive (with every passive hand): " + gate.verdict + "\n";
  for (std::size_t i = 0; i < gate.devices.size(); ++i) {
    const check::PassiveAnswer& answer = gate.devices[i];
    text += fmt::format("  {}: {}{}: {}\n", gate.names[i],
                        answer.proved ? "proved by theorem " : "not proved",
                        answer.proved ? name_of(answer.theorem) : "", answer.why);
    text += lines_of(answer);
  }
  if (!gate.certificate_problem.empty()) text += "  " + gate.certificate_problem + "\n";
  return text;
}

std::string group_text(const Json& groups, const char* heading) {
  std::string text = std::string(heading) + "\n";
  if (groups.empty())
    text += "  not available: no coupling or network ties devices without joints\n";
  for (const Json& group : groups) {
    text += "  " + group["devices"].get<std::string>() + ": " + group["answer"].get<std::string>();
    if (group.contains("margin_Ns_m") && group["margin_Ns_m"].is_number())
      text += fmt::format(", margin {:.5g} N s/m", group["margin_Ns_m"].get<double>());
    if (group.contains("limits")) {
      double most = 0;
      std::string name;
      for (const Json& limit : group["limits"]) {
        if (limit["share"].get<double>() <= most) continue;
        most = limit["share"].get<double>();
        name = limit["coordinate"].get<std::string>();
      }
      if (!name.empty()) text += ", limited most by " + name;
    }
    if (group.contains("why") && group["why"].is_string())
      text += ": " + group["why"].get<std::string>();
    text += "\n";
  }
  return text;
}

void print_answers(const Answers& answers, bool json) {
  if (json) {
    std::puts(to_text({{"ok", true},
                       {"passive", stability_json(answers.gate)},
                       {"exact", answers.exact},
                       {"robust", answers.robust.json},
                       {"paper", answers.paper}})
                  .c_str());
    return;
  }
  std::printf(
      "%s%s%s%s", passive_text(answers.gate).c_str(),
      group_text(answers.exact, "exact (this scene alone, sampled; void once it changes):").c_str(),
      group_text(answers.paper, "paper (Theorem 3, any passive hand, no latency):").c_str(),
      robust_text(answers.robust.json).c_str());
}

}  // namespace

ExitCode run_certify(const std::string& path, const std::string& output, bool json) {
  auto document = config::read_file(path);
  if (!document) return print_config_errors(document.error(), json);
  if (!output.empty()) {
    if (auto writable = check_output(output, {path}); !writable)
      return print_error(writable.error(), json);
    document->config.stability.proof.reset();  // it is what is being made
  }
  const auto compiled = config::compile(std::move(*document));
  if (!compiled) return print_config_errors(compiled.error(), json);
  const Answers answers = answers_for(*compiled);
  if (!output.empty() && answers.robust.proof.devices.empty()) {
    return print_error({path + ": no robust answer is proved, so " + output +
                            " is not written; hapticctl certify without -o says why",
                        ExitCode::no},
                       json);
  }
  if (!output.empty()) {
    if (auto written = replace_file(output, proof_text(answers.robust.proof, path)); !written)
      return print_error(written.error(), json);
  }
  print_answers(answers, json);
  if (!output.empty() && !json)
    std::printf("%s written; put this into the config:  stability: {require: robust, proof: %s}\n",
                output.c_str(), named_from(path, output).c_str());
  const bool proved = answers.gate.proved() || answers.gate.proved_robust();
  return proved || !output.empty() ? ExitCode::ok : ExitCode::no;
}

}  // namespace hapticd::daemon
