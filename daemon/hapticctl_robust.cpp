#include "daemon/hapticctl_robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "config/key.h"
#include "config/matrices.h"
#include "config/write_yaml.h"
#include "control/design/synthesis/common_search.h"
#include "control/design/synthesis/sampled_search.h"

namespace hapticd::daemon {
namespace {

/// Share by which mass and damping may be off together, by one factor, at any of some latencies.
double tolerated(const AxisLoop& one) {
  constexpr int kLatencies = 4;
  const int latencies = one.box.latency_s.high > 0 ? kLatencies : 0;
  double least = 1;
  for (int i = 0; i <= latencies; ++i) {
    const double latency_s = latencies == 0 ? 0 : one.box.latency_s.high * i / latencies;
    const check::LoopCase nominal{
        .mass_kg = one.mass, .damping_Ns_m = one.damping, .latency_s = latency_s};
    least = std::min(least, synthesis::largest_uncertainty(one.loop, nominal, 1, 1, 1));
  }
  return least;
}

Json paper_of_wall(const AxisLoop& one, const config::PaperModel& model) {
  const synthesis::WallGoal goal = paper_goal(one, model);
  if (const std::string wrong = synthesis::malformed(goal); !wrong.empty())
    return {{"answer", "not available"},
            {"why", wrong},
            {"nominally_stable", nullptr},
            {"norm_dB", nullptr}};
  const double norm = synthesis::perturbation_norm(goal, one.damper);
  const bool stable = synthesis::nominally_stable(goal, one.damper);
  return {{"answer", stable && norm <= 1 ? "yes" : "no"},
          {"nominally_stable", stable},
          {"norm_dB", norm > 0 ? Json(20 * std::log10(norm)) : Json(nullptr)},
          {"hold", word_of(model.hold)}};
}

std::string hand_text(const std::optional<config::HandRange>& hand) {
  if (!hand) return "none";
  const auto range = [](const config::Range& r, const char* unit) {
    return fmt::format("{:.4g} .. {:.4g} {}", r[0], r[1], unit);
  };
  return range(hand->mass_kg, "kg") + ", " + range(hand->damping_Ns_m, "N s/m") + ", " +
         range(hand->stiffness_N_m, "N/m");
}

std::vector<Matrix> found_for(const AxisLoop& one, const check::LoopBox& box) {
  if (!check::unfit(one.loop, box, {}).empty()) return {};
  auto found = synthesis::find_common(one.loop, box);
  if (found.P.empty()) found = synthesis::find_constant(one.loop, box);
  return found.P;
}

/// What could be proved if the contact never opened: to be told, not to be gone by.
std::string while_closed(const AxisLoop& one) {
  check::LoopBox closed = one.box;
  closed.contact = {1, 1};
  const check::RobustAnswer answer = check::robust(one.loop, closed, found_for(one, closed));
  return robust_words(answer) + ": " + answer.why;
}

Json entry_of(const config::Compiled& compiled, const AxisLoop& one, const std::vector<Matrix>& P) {
  if (!one.why.empty())
    return {{"device", one.device}, {"answer", "not available"}, {"why", one.why}};
  const check::RobustAnswer answer = check::robust(one.loop, one.box, P);
  const config::Stability& stability = compiled.document.config.stability;
  Json entry{{"device", one.device},
             {"answer", robust_words(answer)},
             {"proved", is_proof(answer)},
             {"why", answer.why},
             {"cases", answer.cases},
             {"largest_eigenvalue", answer.worst.radius},
             {"worst", check::described(answer.worst.at)},
             {"hand", hand_text(stability.hand)},
             {"tolerated_share", tolerated(one)}};
  if (one.wall) entry["paper"] = paper_of_wall(one, stability.paper);
  if (one.wall && answer.kind == check::Robust::sampled) entry["while_closed"] = while_closed(one);
  return entry;
}

}  // namespace

static_assert(static_cast<int>(config::HoldKind::average) ==
              static_cast<int>(synthesis::Hold::average));

synthesis::WallGoal paper_goal(const AxisLoop& one, const config::PaperModel& model) {
  const auto polynomial = [](const std::vector<double>& powers) {
    return check::Vector(
        Eigen::Map<const check::Vector>(powers.data(), static_cast<Eigen::Index>(powers.size())));
  };
  return {.mass_kg = one.mass,
          .damping_Ns_m = one.damping,
          .mass_uncertainty = one.mass_share,
          .damping_uncertainty = one.damping_share,
          .stiffness_N_m = one.stiffness,
          .wall_damping_Ns_m = one.damper,
          .period_s = one.loop.period_s,
          .hold = {.kind = static_cast<synthesis::Hold>(model.hold),
                   .corner_rad_s = model.corner_rad_s.value_or(0),
                   .damping_ratio = model.damping_ratio},
          .weight = {polynomial(model.weight_numerator), polynomial(model.weight_denominator)}};
}

std::vector<Matrix> find_proof(const AxisLoop& one) {
  if (check::robust(one.loop, one.box).kind != check::Robust::sampled) return {};
  return found_for(one, one.box);
}

std::string proof_text(const config::ProofFile& proof, const std::string& about) {
  return "# Quadratic Lyapunov functions z'Pz of the loop of each device, for stability.proof, "
         "checked at every load\n"
         "# against the config as it is then. Found for " +
         about + "\n" + config::to_yaml(proof);
}

RobustReport robust_report(const config::Compiled& compiled) {
  RobustReport report{.json = Json::array()};
  for (const AxisLoop& one : axis_loops(compiled)) {
    std::vector<Matrix> P = proof_of(compiled, one.device);
    if (one.why.empty() && (P.empty() || !is_proof(check::robust(one.loop, one.box, P))))
      P = find_proof(one);
    report.json.push_back(entry_of(compiled, one, P));
    if (P.empty() || !one.why.empty()) continue;
    config::DeviceProof proof{.device = one.device};
    for (const Matrix& matrix : P) proof.P.push_back(config::as_rows(matrix));
    report.proof.devices.push_back(std::move(proof));
  }
  return report;
}

std::string robust_text(const Json& robust) {
  std::string text =
      "robust (the sampled loop, exactly: devices of the model's box, hands of stability.hand, "
      "latency up to "
      "latency_s):\n";
  for (const Json& one : robust) {
    text += fmt::format("  {}: {}: {}\n", one["device"].get<std::string>(),
                        one["answer"].get<std::string>(), one["why"].get<std::string>());
    if (one.contains("while_closed"))
      text += "    if the contact never opened: " + one["while_closed"].get<std::string>() + "\n";
    if (one.contains("tolerated_share"))
      text += fmt::format(
          "    as given it stays stable while mass and damping are off, by one factor, by less "
          "than {:.1f} %\n",
          100 * one["tolerated_share"].get<double>());
    if (one.contains("paper") && one["paper"].is_object()) {
      const Json& paper = one["paper"];
      text +=
          fmt::format("    paper (Eom, Suh and Yi's norm, which the sampled loop overrules): {}",
                      paper["answer"].get<std::string>());
      if (paper["norm_dB"].is_number())
        text += fmt::format(", |L| = {:.4g} dB", paper["norm_dB"].get<double>());
      if (paper.contains("why")) text += ": " + paper["why"].get<std::string>();
      text += paper["nominally_stable"] == false ? ", nominally unstable\n" : "\n";
    }
  }
  return text;
}

}  // namespace hapticd::daemon
