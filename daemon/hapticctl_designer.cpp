#include "daemon/hapticctl_designer.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include "config/matrices.h"
#include "control/design/synthesis/direct_search.h"
#include "daemon/hapticctl_groups.h"
#include "daemon/hapticctl_theorem4.h"
#include "daemon/stability_gate.h"

namespace hapticd::daemon {
namespace {

using check::Matrix;
using config::Compiled;
using config::CouplingBlock;

/// A number alone where that says all.
config::Gains gains_of(const Matrix& m) {
  return m.size() == 1 ? config::Gains{m(0, 0)} : config::Gains{config::as_rows(m)};
}

/// A failure of the design itself: what was asked cannot be had.
tl::unexpected<Error> no(std::string text) {
  return fail(ExitCode::no, std::move(text));
}

/// The config with another coupling in the place of its own.
class Designer {
 public:
  Designer(config::Document document, DesignOptions options)
      : document_(std::move(document)), options_(std::move(options)) {
    if (document_.config.coupling) solver_ = document_.config.coupling->solver;
  }

  Result<config::CouplingFile> run() {
    if (options_.order > 0 && options_.proof != DesignFor::paper)
      return fail(ExitCode::usage,
                  "--order asks for a general V(z), which Theorem 4 finds: add --proof paper");
    auto first = compile_with(soft_blocks());
    if (!first) return tl::unexpected(first.error());
    start_ = std::move(*first);
    switch (options_.proof) {
      case DesignFor::any_scene:
        return options_.aim == DesignAim::transparent ? by_search() : any_scene();
      case DesignFor::this_scene:
        return by_search();
      case DesignFor::paper:
        return paper();
      case DesignFor::robust:
        break;  // hapticctl_design_robust.h
    }
    return no("no such proof");
  }

 private:
  /// 1 N/m everywhere: what every sound config can be compiled with.
  std::vector<CouplingBlock> soft_blocks() const {
    std::vector<CouplingBlock> blocks;
    for (const config::Device& device : document_.config.devices) {
      CouplingBlock block{.contacts = {device.name}};
      block.stiffness_N_m = config::Gains{1.0};
      blocks.push_back(std::move(block));
    }
    return blocks;
  }

  Result<Compiled> compile_with(std::vector<CouplingBlock> blocks) const {
    config::Document document = document_;
    document.config.coupling =
        config::Coupling{.file = {}, .blocks = std::move(blocks), .solver = solver_};
    document.coupling_places.reset();
    document.designed.reset();
    auto compiled = config::compile(std::move(document));
    if (compiled) return std::move(*compiled);
    std::string text;
    for (const config::ConfigError& error : compiled.error()) {
      if (!text.empty()) text += '\n';
      text += config::to_string(error);
    }
    return fail(ExitCode::bad_data, text);
  }

  /// Coordinates of the plan by blocks of the wanted structure.
  std::vector<std::vector<std::size_t>> structure() const {
    std::vector<std::vector<std::size_t>> blocks;
    if (options_.structure == DesignStructure::centralised) blocks.emplace_back();
    for (const control::DevicePlan& device : start_.program->plan().devices) {
      if (options_.structure == DesignStructure::per_device) blocks.emplace_back();
      for (std::size_t i = 0; i < device.coordinates; ++i) {
        if (options_.structure == DesignStructure::decentralised) blocks.emplace_back();
        blocks.back().push_back(std::size_t{device.first_coordinate} + i);
      }
    }
    return blocks;
  }

  CouplingBlock named(const std::vector<std::size_t>& coordinates) const {
    CouplingBlock block;
    for (const std::size_t c : coordinates) block.contacts.push_back(coordinate_name(start_, c));
    return block;
  }

  /// Springs alone: one stiffness a coordinate, 0 beside the diagonal of a block.
  std::vector<CouplingBlock> springs(const std::vector<double>& stiffness) const {
    std::vector<CouplingBlock> blocks;
    for (const auto& coordinates : structure()) {
      CouplingBlock block = named(coordinates);
      std::vector<double> own;
      for (const std::size_t c : coordinates) own.push_back(stiffness[c]);
      block.stiffness_N_m = own.size() == 1 ? config::Gains{own[0]} : config::Gains{own};
      blocks.push_back(std::move(block));
    }
    return blocks;
  }

  config::CouplingFile file_of(std::vector<CouplingBlock> blocks,
                               config::CouplingCertificate certificate) const {
    certificate.damping_share = options_.damping_share;
    return {.blocks = std::move(blocks),
            .solver = solver_,
            .assumed = config::assumptions(start_),
            .certificate = std::move(certificate)};
  }

  /// Stiffness of each coordinate in proportion to what its device can dissipate there.
  std::vector<double> in_proportion() const {
    std::vector<double> stiffness(start_.program->spec().coordinate_names.size(), 1.0);
    for (const Group& group : groups_of(start_)) {
      if (group.damping.size() == 0) continue;
      for (std::size_t i = 0; i < group.model.coordinates.size(); ++i)
        stiffness[group.model.coordinates[i]] =
            group.damping(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i));
    }
    return stiffness;
  }

  /// The stiffest springs that a closed form proves: the daemon's own check says by how much they may
  /// grow, and is asked again until they use the share of the damping that they may.
  Result<config::CouplingFile> any_scene() {
    std::vector<double> stiffness = in_proportion();
    for (int round = 0; round < 20; ++round) {
      const auto compiled = compile_with(springs(stiffness));
      if (!compiled) return tl::unexpected(compiled.error());
      const Gate gate = stability_gate(*compiled);
      double worst = 0;
      for (std::size_t d = 0; d < gate.devices.size(); ++d) {
        const check::PassiveAnswer& answer = gate.devices[d];
        const control::DevicePlan& device = compiled->program->plan().devices[d];
        if (!(answer.damping_used > 0) || !std::isfinite(answer.stiffness_factor) ||
            !(answer.stiffness_factor > 0))
          return no(gate.names[d] + ": " + answer.why);
        const double grow = options_.damping_share * answer.stiffness_factor * (1 - 1e-7);
        worst = std::max(worst, std::abs(grow - 1));
        for (std::size_t i = 0; i < device.coordinates; ++i)
          stiffness[device.first_coordinate + i] *= grow;
      }
      if (worst < 1e-6) break;
    }
    return file_of(springs(softened(std::move(stiffness))),
                   {.kind = check::CertificateKind::passive_closed_form});
  }

  /// Over the poses of a linkage the check shows a bound, which lies above what any pose uses: softer, until it is
  /// below the damping, too. As it is where nothing helps: the check then says why.
  std::vector<double> softened(const std::vector<double>& stiffness) const {
    constexpr double kSofter = 0.8;
    constexpr int kSteps = 12;
    std::vector<double> soft = stiffness;
    for (int step = 0; step < kSteps; ++step) {
      const auto compiled = compile_with(springs(soft));
      if (!compiled) break;
      const Gate gate = stability_gate(*compiled);
      bool proved = true;
      for (std::size_t d = 0; d < gate.devices.size(); ++d) {
        const check::PassiveAnswer& answer = gate.devices[d];
        if (answer.proved && answer.damping_used < options_.damping_share) continue;
        proved = false;
        const control::DevicePlan& device = compiled->program->plan().devices[d];
        for (std::size_t i = 0; i < device.coordinates; ++i)
          soft[device.first_coordinate + i] *= kSofter;
      }
      if (proved) return soft;
    }
    return stiffness;
  }

  /// The one group that a proof for one scene, or the paper's, is about.
  Result<Group> only_group() const {
    std::vector<Group> groups = groups_of(start_);
    if (groups.size() != 1) {
      return no(
          fmt::format("this proof is about devices that one network ties, or a single device: "
                      "found {} such groups; use --proof any_scene",
                      groups.size()));
    }
    if (groups[0].damping.size() == 0)
      return no(groups[0].names +
                ": every axis needs a model with a damping, and something of it has "
                "to be left beside compensation");
    return std::move(groups[0]);
  }

  synthesis::DirectDesign searched(const Group& group) const {
    const double period_s = start_.program->plan().period_s;
    const Eigen::Index m = group.damping.rows();
    synthesis::DirectGoal goal{.scene = group.model.E,
                               .damping = group.damping.diagonal(),
                               .latency_s = group.latency_s,
                               .period_s = period_s,
                               .weights = synthesis::unweighted(m)};
    goal.weights.left = synthesis::low_pass(options_.corner_rad_s, period_s, m);
    const double share = options_.damping_share;
    // A proof wants a little room: a share of what it may not use anyway.
    if (options_.proof == DesignFor::any_scene)
      return synthesis::most_transparent_for_any_scene(goal, share * (1 - 1e-9));
    goal.damping *= share;
    const double room_Ns_m = 1e-6 * goal.damping.minCoeff();
    return options_.aim == DesignAim::transparent
               ? synthesis::most_transparent_exact(goal, room_Ns_m)
               : synthesis::stiffest_exact(goal, goal.damping, room_Ns_m);
  }

  /// A spring and a damper of its own for each coordinate, by direct search.
  Result<config::CouplingFile> by_search() {
    const auto group = only_group();
    if (!group) return tl::unexpected(group.error());
    const bool exact = options_.proof == DesignFor::this_scene;
    if (exact && !group->linear)
      return no("the exact test is about linear scenes: only networks may act on " + group->names +
                "; use --proof any_scene");
    const synthesis::DirectDesign found = searched(*group);
    if (found.stiffness.size() == 0) return no(found.why);
    if (exact && !found.certificate.P) return no("no certificate: " + found.certificate.why);
    std::fprintf(stderr, "loop-shaping norm %.5g, exact margin with this scene %.4g N s/m\n",
                 found.gamma, found.margin);
    std::vector<CouplingBlock> blocks;
    for (Eigen::Index i = 0; i < found.stiffness.size(); ++i) {
      CouplingBlock block = named({group->model.coordinates[static_cast<std::size_t>(i)]});
      block.stiffness_N_m = config::Gains{found.stiffness[i]};
      block.damping_Ns_m = config::Gains{found.damper[i]};
      blocks.push_back(std::move(block));
    }
    if (!exact) {
      return file_of(std::move(blocks), {.kind = check::CertificateKind::passive_closed_form});
    }
    return file_of(std::move(blocks), {.kind = check::CertificateKind::sampled_exact,
                                       .P = config::as_rows(*found.certificate.P)});
  }

  /// Springs and dampers, or where an order is asked for a general V(z) for each block.
  Result<config::CouplingFile> paper() {
    const auto group = only_group();
    if (!group) return tl::unexpected(group.error());
    if (group->latency_s > 0)
      return no(
          "Theorem 4 knows no latency: latency_s of every device has to be 0; use --proof "
          "any_scene");
    const synthesis::CclDesign design =
        design_by_theorem4(*group, form_of(*group), options_, start_.program->plan().period_s);
    if (!design.found) return no(design.why);
    std::vector<CouplingBlock> blocks;
    for (const synthesis::DesignedBlock& made : design.coupling.blocks)
      blocks.push_back(block_of(*group, made));
    return file_of(std::move(blocks), certificate_of(*group, design));
  }

  CouplingBlock block_of(const Group& group, const synthesis::DesignedBlock& made) const {
    std::vector<std::size_t> coordinates;
    for (const Eigen::Index i : made.coordinates)
      coordinates.push_back(group.model.coordinates[static_cast<std::size_t>(i)]);
    CouplingBlock block = named(coordinates);
    if (made.spring_damper) {
      block.stiffness_N_m = gains_of(made.stiffness);
      block.damping_Ns_m = gains_of(made.damping);
    } else {
      block.state_space = config::StateSpace{.A = config::as_rows(made.V.A),
                                             .B = config::as_rows(made.V.B),
                                             .C = config::as_rows(made.V.C),
                                             .D = config::as_rows(made.V.D)};
    }
    return block;
  }

  synthesis::Form form_of(const Group& group) const {
    std::map<std::size_t, Eigen::Index> place;
    for (std::size_t i = 0; i < group.model.coordinates.size(); ++i)
      place[group.model.coordinates[i]] = static_cast<Eigen::Index>(i);
    synthesis::Form form;
    for (const auto& coordinates : structure()) {
      synthesis::FormBlock block{
          .coordinates = {}, .spring_damper = options_.order == 0, .order = options_.order};
      for (const std::size_t c : coordinates) block.coordinates.push_back(place.at(c));
      form.push_back(std::move(block));
    }
    return form;
  }

  config::Document document_;
  DesignOptions options_;
  config::Solver solver_;
  Compiled start_;
};

}  // namespace

Result<config::CouplingFile> design_coupling(config::Document document,
                                             const DesignOptions& options) {
  return Designer(std::move(document), options).run();
}

}  // namespace hapticd::daemon
