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
#include "daemon/output_check.h"
#include "daemon/output_file.h"
#include "daemon/stability_gate.h"
#include "daemon/wall_of.h"

namespace hapticd::daemon {
namespace {

/// What is designed: the damping of the plane, or of every block of the coupling.
struct Damper {
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
  const auto one = only_loop(compiled);
  if (!one) return tl::unexpected(one.error());
  config::Config config = compiled.document.config;
  if (one->wall) {
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

constexpr const char* kInterrupted = "interrupted; nothing was written";

/// In units of mass/period, beyond which no loop of this kind is stable; as the axis feels them, or as the config has
/// them, with its scale.
synthesis::Scan dampers_for(const AxisLoop& one, double scale = 1) {
  const double unit = one.box.mass_kg.high / one.loop.period_s / scale;
  return {.low = 1e-4 * unit, .high = 4 * unit, .points = 80};
}
bool at_edge(double damper, const synthesis::Scan& scan) {
  return damper <= 1.02 * scan.low || damper >= 0.98 * scan.high;
}
std::string edge_text(double damper) {
  return fmt::format(
      "the best damping is beyond what is looked at, at {:.4g} N s/m: is the model right?", damper);
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
  goal.dampers = dampers_for(one);
  const synthesis::DamperDesign found = synthesis::design_damper(goal);
  if (interrupts().load()) return fail(ExitCode::try_again, kInterrupted);
  if (!found.why.empty()) return fail(ExitCode::no, found.why);
  if (at_edge(found.damper_Ns_m, goal.dampers))
    return fail(ExitCode::no, edge_text(found.damper_Ns_m / one.scale));
  return FoundDamper{.damping = rounded(found.damper_Ns_m / one.scale),
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
    const AxisLoop one = axis_loops(*compiled).front();
    if (!one.why.empty()) return std::numeric_limits<double>::infinity();
    worst = check::worst_of(one.loop, check::cases_of(one.box));
    return worst.radius;
  };
  const auto start = compiled_with(document, which, 0);
  if (!start) return tl::unexpected(start.error());
  const AxisLoop undamped = axis_loops(*start).front();
  const synthesis::Scan scan = dampers_for(undamped, undamped.scale);
  const synthesis::Least best = synthesis::least(radius, scan);
  if (interrupts().load()) return fail(ExitCode::try_again, kInterrupted);
  if (std::isfinite(best.value) && at_edge(best.x, scan))
    return fail(ExitCode::no, edge_text(best.x));
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

std::vector<Matrix> matrices_of(const config::ProofFile& proof) {
  std::vector<Matrix> P;
  for (const config::Rows& rows : proof.devices.front().P) P.push_back(config::as_matrix(rows));
  return P;
}

/// Nothing: none was found.
Result<std::optional<config::ProofFile>> proof_with(const AxisLoop& one) {
  const std::vector<Matrix> P = find_proof(one);
  if (interrupts().load()) return fail(ExitCode::try_again, kInterrupted);
  if (P.empty()) return std::nullopt;
  config::DeviceProof proof{.device = one.device};
  for (const Matrix& matrix : P) proof.P.push_back(config::as_rows(matrix));
  return config::ProofFile{.devices = {std::move(proof)}};
}

struct Designed {
  Damper which;
  FoundDamper found;
  std::string robust;  ///< what is known of the loop with it
  bool written = false;
};

/// The proof into the output, once the daemon's own check has accepted it.
Result<void> write_proof(const config::Document& base, const Designed& designed,
                         const config::ProofFile& proof, const std::string& output) {
  const std::string draft = output + ".draft";
  const std::string about = designed.which.key + fmt::format(": {:.4g}", designed.found.damping);
  auto gate = replace_file(draft, proof_text(proof, about)).and_then([&] {
    return gate_with(base, designed.which, designed.found.damping, draft);
  });
  std::remove(draft.c_str());
  if (!gate) return tl::unexpected(gate.error());
  if (interrupts().load()) return fail(ExitCode::try_again, kInterrupted);
  if (!gate->proved_robust()) {
    return fail(
        ExitCode::no,
        "what was found is not proved by the daemon's own check, so nothing was written:\n" +
            gate->explanation());
  }
  return replace_file(output, proof_text(proof, about));
}

/// The config without its proof, coupling and models from their files in it.
Result<config::Document> base_of(config::Document document) {
  document.config.stability.proof.reset();
  auto compiled = config::compile(std::move(document));
  if (!compiled) return fail(ExitCode::bad_data, config::to_string(compiled.error().front()));
  config::Document base = std::move(compiled->document);
  if (base.config.coupling) base.config.coupling->file.reset();
  return base;
}

Result<Designed> design(const config::Document& document, const DesignOptions& options) {
  const auto base = base_of(document);
  if (!base) return tl::unexpected(base.error());
  const auto compiled = config::compile(*base);
  if (!compiled) return fail(ExitCode::bad_data, config::to_string(compiled.error().front()));
  const auto which = find_damper(*compiled);
  if (!which) return tl::unexpected(which.error());
  const AxisLoop start = axis_loops(*compiled).front();
  const auto found = which->wall ? wall_damper(*compiled, start) : coupling_damper(*base, *which);
  if (!found) return tl::unexpected(found.error());
  const auto with = compiled_with(*base, *which, found->damping);
  if (!with) return tl::unexpected(with.error());
  const AxisLoop one = axis_loops(*with).front();
  const auto proof = proof_with(one);
  if (!proof) return tl::unexpected(proof.error());
  const check::RobustAnswer answer =
      check::robust(one.loop, one.box, *proof ? matrices_of(**proof) : std::vector<Matrix>{});
  Designed designed{*which, *found, robust_words(answer) + ": " + answer.why, false};
  if (!*proof) return designed;
  if (auto written = write_proof(*base, designed, **proof, options.output); !written)
    return tl::unexpected(written.error());
  designed.written = true;
  return designed;
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

Json json_of(const Designed& designed, const std::string& output) {
  Json json{{"ok", true},
            {"output", designed.written ? Json(output) : Json(nullptr)},
            {"key", designed.which.key},
            {"damping_Ns_m", designed.found.damping},
            {"worst", designed.found.worst},
            {"robust", designed.robust},
            {"proved", designed.written}};
  if (designed.which.wall) json["largest_index"] = designed.found.index;
  if (designed.found.paper && designed.found.paper->why.empty())
    json["paper"] = {{"damping_Ns_m", designed.found.paper->damper_Ns_m},
                     {"index", designed.found.paper->answer.index},
                     {"robust", designed.found.paper->answer.robust}};
  return json;
}

std::string text_of(const Designed& designed) {
  std::string text = fmt::format("{}: {:.4g}\n", designed.which.key, designed.found.damping);
  if (designed.which.wall)
    text +=
        fmt::format("largest J: {:.4g} m^2/s at {}\n", designed.found.index, designed.found.worst);
  return text + paper_line(designed.found) + "robust: " + designed.robust + "\n";
}

}  // namespace

ExitCode run_design_robust(const std::string& path, const DesignOptions& options, bool json) {
  static_cast<void>(interrupts());  // from here on they end it with a whole file or none
  if (options.order != 0 || options.aim != DesignAim::stiffest ||
      options.structure != DesignStructure::decentralised)
    return print_error({"--proof robust takes no --order, --aim or --structure", ExitCode::usage},
                       json);
  const auto document = config::read_file(path);
  if (!document) return print_config_errors(document.error(), json);
  if (auto writable = check_output(options.output, {path}); !writable)
    return print_error(writable.error(), json);
  const auto designed = design(*document, options);
  if (!designed) return print_error(designed.error(), json);
  if (json) {
    std::puts(to_text(json_of(*designed, options.output)).c_str());
  } else if (designed->written) {
    std::printf(
        "%s%s written; put both into the config, and  stability: {require: robust, proof: %s}\n",
        text_of(*designed).c_str(), options.output.c_str(),
        named_from(path, options.output).c_str());
  } else {
    std::printf("%sno proof was found, so %s is not written%s\n", text_of(*designed).c_str(),
                options.output.c_str(),
                designed->which.wall
                    ? "; for a wall it takes a hand with a spring: stability.hand.stiffness_N_m"
                    : "");
  }
  return designed->written ? ExitCode::ok : ExitCode::no;
}

}  // namespace hapticd::daemon
