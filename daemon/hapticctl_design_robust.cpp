#include "daemon/hapticctl_design_robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "config/matrices.h"
#include "config/write_yaml.h"
#include "control/design/synthesis/robust_wall.h"
#include "daemon/ctl_check.h"
#include "daemon/ctl_verbs.h"
#include "daemon/hapticctl_robust.h"
#include "daemon/interrupts.h"
#include "daemon/output_file.h"
#include "daemon/stability_gate.h"
#include "daemon/wall_of.h"

namespace hapticd::daemon {
namespace {

/// What is designed: the damping of the plane, or of every block of the coupling.
struct Damper {
  std::size_t device = 0;  ///< index into axis_loops()
  bool wall = false;
  std::string key;  ///< where it stands in the config
};

/// Four digits: what people write into a config.
double rounded(double value) {
  return std::stod(fmt::format("{:.4g}", value));
}

void set_damping(config::Config& config, const Damper& which, double damping) {
  if (which.wall) {
    wall_of(config).damping_Ns_m = damping;
  } else {
    for (config::CouplingBlock& block : config.coupling->blocks)
      block.damping_Ns_m = config::Gains{damping};
  }
}

Result<Damper> find_damper(const config::Compiled& compiled) {
  const std::vector<AxisLoop> loops = axis_loops(compiled);
  if (loops.size() != 1)
    return fail(ExitCode::bad_data, "expected one device, found " + std::to_string(loops.size()));
  if (!loops[0].why.empty()) return fail(ExitCode::bad_data, loops[0].why);
  config::Config config = compiled.document.config;
  if (loops[0].wall) {
    return Damper{.wall = true, .key = "damping_Ns_m of plane " + wall_of(config).name};
  }
  if (!config.coupling || config.coupling->blocks.empty())
    return fail(ExitCode::bad_data,
                "expected a wall that is rendered directly, or a coupling; found neither");
  if (config.coupling->blocks[0].state_space)
    return fail(ExitCode::bad_data,
                "the coupling is a state_space; a damping is chosen for springs and dampers");
  return Damper{.key = "damping_Ns_m of the coupling"};
}

Result<config::Compiled> compiled_with(config::Document document, const Damper& which,
                                       double damping) {
  set_damping(document.config, which, damping);
  auto compiled = config::compile(std::move(document));
  if (!compiled) return fail(ExitCode::bad_data, config::to_string(compiled.error().front()));
  return std::move(*compiled);
}

struct FoundDamper {
  double damping = 0;
  double index = 0;  ///< of a wall: largest J
  std::string worst;
  std::optional<synthesis::PaperDesign> paper{};
};

Result<FoundDamper> wall_damper(const config::Compiled& compiled, const AxisLoop& one) {
  const config::PaperModel& model = compiled.document.config.stability.paper;
  const synthesis::WallGoal paper = paper_goal(one, model);
  synthesis::RobustWallGoal goal{
      .wall = {.stiffness_N_m = one.stiffness,
               .velocity = one.velocity,
               .observer = one.loop.observer,
               .period_s = one.loop.period_s},
      .meant = {.stiffness_N_m = one.stiffness, .damping_Ns_m = one.damper, .weight = paper.weight},
      .box = one.box,
      .cases = {},
      .hold = paper.hold};
  const synthesis::DamperDesign found = synthesis::design_damper(goal);
  if (!found.why.empty()) return fail(ExitCode::no, found.why);
  return FoundDamper{.damping = rounded(found.damper_Ns_m),
                     .index = found.index,
                     .worst = check::described(found.worst),
                     .paper = found.paper};
}

/// Least largest eigenvalue over all cases.
Result<FoundDamper> coupling_damper(const config::Document& document, const Damper& which) {
  check::WorstCase worst;
  const auto radius = [&](double damping) {
    const auto compiled = compiled_with(document, which, damping);
    if (!compiled || interrupts().load()) return std::numeric_limits<double>::infinity();
    const AxisLoop one = axis_loops(*compiled).at(which.device);
    if (!one.why.empty()) return std::numeric_limits<double>::infinity();
    check::LoopBox closed = one.box;
    closed.contact = {1, 1};
    worst = check::worst_of(one.loop, check::cases_of(closed));
    return worst.radius;
  };
  const synthesis::Least best = synthesis::least(radius, {.low = 0.01, .high = 100, .points = 40});
  if (!std::isfinite(best.value) || radius(rounded(best.x)) >= check::kStableBelow) {
    return fail(
        ExitCode::no,
        fmt::format("no damping makes this coupling stable in all cases; nearest is {:.4g} N s/m, "
                    "whose largest eigenvalue is {:.6g}; soften the coupling",
                    best.x, best.value));
  }
  return FoundDamper{.damping = rounded(best.x), .worst = check::described(worst.at)};
}

/// As the daemon will load it, with `proof` named and robust demanded.
Result<Gate> gate_with(config::Document document, const Damper& which, double damping,
                       const std::string& proof) {
  document.config.stability.require = config::Require::robust;
  document.config.stability.proof = std::filesystem::absolute(proof).string();
  auto compiled = compiled_with(std::move(document), which, damping);
  if (!compiled) return tl::unexpected(compiled.error());
  return stability_gate(*compiled);
}

Result<config::ProofFile> proof_with(const config::Document& document, const Damper& which,
                                     double damping) {
  const auto compiled = compiled_with(document, which, damping);
  if (!compiled) return tl::unexpected(compiled.error());
  const AxisLoop one = axis_loops(*compiled).at(which.device);
  const std::vector<Matrix> P = find_proof(one);
  if (P.empty()) {
    return fail(
        ExitCode::no,
        fmt::format(
            "{:.4g} N s/m is best, but no proof was found for it, so nothing was written: {}",
            damping, robust_answer(one, {}).robust.why));
  }
  config::DeviceProof proof{.device = one.device};
  for (const Matrix& matrix : P) proof.P.push_back(config::as_rows(matrix));
  return config::ProofFile{.devices = {std::move(proof)}};
}

struct Written {
  Damper which;
  FoundDamper found;
  Gate gate;
};

Result<Written> design(const config::Document& document, const DesignOptions& options) {
  config::Document base = document;
  base.config.stability.proof.reset();
  auto compiled = config::compile(base);
  if (!compiled) return fail(ExitCode::bad_data, config::to_string(compiled.error().front()));
  base = compiled->document;  // coupling and models from their files
  base.config.stability.proof.reset();
  if (base.config.coupling) base.config.coupling->file.reset();
  const auto which = find_damper(*compiled);
  if (!which) return tl::unexpected(which.error());
  const AxisLoop one = axis_loops(*compiled).at(which->device);
  const auto found = which->wall ? wall_damper(*compiled, one) : coupling_damper(base, *which);
  if (!found) return tl::unexpected(found.error());
  const auto proof = proof_with(base, *which, found->damping);
  if (!proof) return tl::unexpected(proof.error());
  const std::string draft = options.output + ".new";
  const std::string text = proof_text(*proof, which->key + fmt::format(": {:.4g}", found->damping));
  auto gate = replace_file(draft, text).and_then([&] {
    return gate_with(base, *which, found->damping, draft);
  });
  if (gate && !gate->proved_robust())
    gate =
        fail(ExitCode::no,
             "what was found is not proved by the daemon's own check, so nothing was written:\n" +
                 gate->explanation());
  if (gate && std::rename(draft.c_str(), options.output.c_str()) != 0)
    gate = fail(ExitCode::cannot_create, options.output + ": cannot be written");
  if (!gate) {
    std::remove(draft.c_str());
    return tl::unexpected(gate.error());
  }
  return Written{*which, *found, std::move(*gate)};
}

std::string paper_line(const FoundDamper& found) {
  if (!found.paper) return "";
  const synthesis::PaperDesign& paper = *found.paper;
  if (!paper.why.empty()) return "paper: none: " + paper.why + "\n";
  return fmt::format(
      "paper (which decides nothing): {:.4g} N s/m, J {:.4g} m^2/s, |L| {:.4g} dB, {}\n",
      paper.damper_Ns_m, paper.answer.index, 20 * std::log10(paper.answer.norm),
      paper.answer.robust ? "robust" : "not robust");
}

Json json_of(const Written& written, const std::string& output) {
  Json json{{"ok", true},
            {"output", output},
            {"key", written.which.key},
            {"damping_Ns_m", written.found.damping},
            {"worst", written.found.worst},
            {"robust", written.gate.robust.front().why}};
  if (written.which.wall) json["largest_index"] = written.found.index;
  if (written.found.paper && written.found.paper->why.empty())
    json["paper"] = {{"damping_Ns_m", written.found.paper->damper_Ns_m},
                     {"index", written.found.paper->answer.index},
                     {"robust", written.found.paper->answer.robust}};
  return json;
}

}  // namespace

ExitCode run_design_robust(const std::string& path, const DesignOptions& options, bool json) {
  const auto document = config::read_file(path);
  if (!document) return print_config_errors(document.error(), json);
  const auto written = design(*document, options);
  if (!written) return print_error(written.error(), json);
  if (json) {
    std::puts(to_text(json_of(*written, options.output)).c_str());
    return ExitCode::ok;
  }
  std::string text = fmt::format("{}: {:.4g}\n", written->which.key, written->found.damping);
  if (written->which.wall)
    text +=
        fmt::format("largest J: {:.4g} m^2/s at {}\n", written->found.index, written->found.worst);
  std::printf(
      "%s%srobust: %s\n%s written; put both into the config, and  stability: {require: robust, "
      "proof: %s}\n",
      text.c_str(), paper_line(written->found).c_str(), written->gate.robust.front().why.c_str(),
      options.output.c_str(), options.output.c_str());
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
