// Blocks of the coupling, their coordinates in the plan's order, their matrices checked.
#include <algorithm>
#include <string>

#include "config/compilation.h"
#include "config/coordinates.h"
#include "config/describe.h"
#include "config/matrices.h"
#include "config/number.h"
#include "control/build/scene.h"
#include "control/core/algebra.h"

namespace hapticd::config {
namespace {

using Eigen::MatrixXd;

/// A block as the config has it, with the coordinates that it names, in its own order.
struct BlockPlace {
  const CouplingBlock& block;
  std::vector<std::uint32_t> named;
  std::string path;
};

MatrixXd sorted(const MatrixXd& m, const std::vector<Eigen::Index>& order) {
  return m(order, order);
}

void add_spring(Compilation& compilation, const BlockPlace& place, build::CouplingBlock& made) {
  const std::size_t n = place.named.size();
  const std::string stiffness = place.path + ".stiffness_N_m";
  const std::string damping = place.path + ".damping_Ns_m";
  const auto K = symmetric_matrix(compilation, *place.block.stiffness_N_m, n, stiffness);
  const auto B = symmetric_matrix(compilation, place.block.damping_Ns_m, n, damping);
  if (!K || !B || !check_positive(compilation, *K, stiffness, "the stiffness")) return;
  // The stretch goes on by (K + B/T)^-1 B/T in each tick: it fades only so.
  const MatrixXd fading = *K + 2 * *B / compilation.spec.period_s;
  if (!check_positive(compilation, fading, damping, "stiffness + 2 damping / period")) return;
  const auto order = sorting_order(place.named);
  made.stiffness = to_matrix(sorted(*K, order));
  made.damping = to_matrix(sorted(*B, order));
}

/// V(z) has to forget, and to give way at once: force follows from stretch.
bool check_system(Compilation& compilation, const LinearSystem& v, const std::string& path) {
  if (!is_symmetric(v.D)) {
    compilation.refuse(path + ".D",
                       "expected a symmetric matrix: the way in which the contact "
                       "gives way at once");
    return false;
  }
  if (!check_positive(compilation, v.D, path + ".D", "D")) return false;
  if (v.A.size() == 0) return true;
  const double largest = algebra::eigenvalues(v.A).cwiseAbs().maxCoeff();
  if (largest < 1) return true;
  compilation.refuse(path + ".A",
                     "expected all eigenvalues inside the unit circle, found one of "
                     "size " +
                         format_number(largest) + "; this coupling would never come to rest");
  return false;
}

void add_system(Compilation& compilation, const BlockPlace& place, build::CouplingBlock& made) {
  const std::string path = place.path + ".state_space";
  const auto v = linear_system(compilation, *place.block.state_space, place.named.size(), path);
  if (!v || !check_system(compilation, *v, path)) return;
  const auto order = sorting_order(place.named);
  const MatrixXd B = v->B(Eigen::all, order);
  const MatrixXd C = v->C(order, Eigen::all);
  made.state_space = {.A = to_matrix(v->A),
                      .B = to_matrix(B),
                      .C = to_matrix(C),
                      .D = to_matrix(sorted(v->D, order))};
}

bool check_keys(Compilation& compilation, const BlockPlace& place) {
  const CouplingBlock& block = place.block;
  if (block.stiffness_N_m.has_value() == block.state_space.has_value()) {
    compilation.refuse(place.path, std::string("expected stiffness_N_m or state_space, found ") +
                                       (block.state_space ? "both; remove one" : "neither"));
    return false;
  }
  if (block.state_space && block.damping_Ns_m != Gains{}) {
    compilation.refuse(place.path + ".damping_Ns_m",
                       "state_space says all about this block; remove the damping");
    return false;
  }
  return true;
}

/// Blocks share no coordinate.
bool check_disjoint(Compilation& compilation, const BlockPlace& place) {
  const auto& blocks = compilation.spec.coupling;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (const std::uint32_t coordinate : place.named) {
      const auto& taken = blocks[b].coordinates;
      if (!std::binary_search(taken.begin(), taken.end(), coordinate)) continue;
      compilation.refuse(place.path + ".contacts",
                         compilation.spec.coordinate_names[coordinate] + " stands in block " +
                             std::to_string(b) +
                             " already; coordinates that share springs belong in one block");
      return false;
    }
  }
  return true;
}

void add_block(Compilation& compilation, const CouplingBlock& block, const std::string& path) {
  const BlockPlace place{block, coordinates_named(compilation, block.contacts, path + ".contacts"),
                         path};
  build::CouplingBlock made;
  made.coordinates = place.named;
  std::sort(made.coordinates.begin(), made.coordinates.end());
  const bool sound =
      check_keys(compilation, place) && !place.named.empty() && check_disjoint(compilation, place);
  if (!sound) return;
  block.state_space ? add_system(compilation, place, made) : add_spring(compilation, place, made);
  compilation.spec.coupling.push_back(std::move(made));
}

}  // namespace

void compile_coupling(Compilation& compilation) {
  if (!compilation.config.coupling) return;
  const Coupling& coupling = *compilation.config.coupling;
  if (coupling.blocks.empty()) {
    compilation.refuse("coupling",
                       "expected blocks, or the file that has them; no coupling at all "
                       "is 'coupling: null'");
  }
  compilation.spec.max_sweeps = static_cast<std::uint16_t>(coupling.solver.max_sweeps);
  compilation.spec.solver_tolerance = coupling.solver.tolerance_N;
  for (std::size_t i = 0; i < coupling.blocks.size(); ++i)
    add_block(compilation, coupling.blocks[i], indexed("coupling.blocks", i));
}

}  // namespace hapticd::config
