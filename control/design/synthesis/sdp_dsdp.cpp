// DSDP solves max b'y subject to C - sum_i y_i A_i >= 0: y = x, b = -c, C = F_0, A_i = -F_i.
#include <dsdp/dsdp5.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "control/design/synthesis/sdp_backends.h"

namespace hapticd::synthesis {

namespace {

void must(int error) {
  if (error != 0) throw std::runtime_error("DSDP: error " + std::to_string(error));
}

class Dsdp {
 public:
  explicit Dsdp(int variables) { must(DSDPCreate(variables, &solver_)); }
  ~Dsdp() { DSDPDestroy(solver_); }
  Dsdp(const Dsdp&) = delete;
  Dsdp& operator=(const Dsdp&) = delete;
  operator DSDP() const noexcept { return solver_; }

 private:
  DSDP solver_ = nullptr;
};

/// One F_i of one block, lower triangle packed by rows. DSDP keeps pointers, not copies.
struct Sparse {
  std::vector<int> places;
  std::vector<double> values;
};

std::vector<Sparse> packed(const LinearMatrix& block, Eigen::Index variables) {
  std::vector<Sparse> matrices(static_cast<std::size_t>(variables) + 1);
  for (const LinearMatrix::Entry& entry : block.gathered()) {
    Sparse& matrix = matrices[static_cast<std::size_t>(entry.variable + 1)];
    const Eigen::Index place = entry.column * (entry.column + 1) / 2 + entry.row;
    matrix.places.push_back(static_cast<int>(place));
    matrix.values.push_back(entry.variable < 0 ? entry.value : -entry.value);
  }
  return matrices;
}

/// sum x_i <= 2 n bound, which the bounds imply: an inequality of all variables makes the normal
/// equations dense. For sparse ones DSDP has another factorisation, which is less exact, and says so
/// on standard output.
LinearMatrix of_all_variables(Eigen::Index variables, double bound) {
  LinearMatrix block(1);
  block.add(-1, 0, 0, 1);
  const double share = 0.5 / (bound * static_cast<double>(variables));
  for (Eigen::Index i = 0; i < variables; ++i) block.add(i, 0, 0, -share);
  return block;
}

SDPCone give_blocks(DSDP solver, const SdpProblem& problem,
                    std::vector<std::vector<Sparse>>& data) {
  SDPCone cone = nullptr;
  must(DSDPCreateSDPCone(solver, static_cast<int>(problem.blocks.size()), &cone));
  for (std::size_t j = 0; j < problem.blocks.size(); ++j) {
    const int block = static_cast<int>(j), size = static_cast<int>(problem.blocks[j].size());
    data.push_back(packed(problem.blocks[j], problem.cost.size()));
    must(SDPConeSetBlockSize(cone, block, size));
    must(SDPConeSetStorageFormat(cone, block, 'P'));
    int entries = 0;
    for (const Sparse& matrix : data.back()) entries += matrix.places.empty() ? 0 : 1;
    must(SDPConeSetSparsity(cone, block, entries));
    for (std::size_t i = 0; i < data.back().size(); ++i) {
      const Sparse& matrix = data.back()[i];
      if (matrix.places.empty()) continue;
      must(SDPConeSetASparseVecMat(cone, block, static_cast<int>(i), size, 1.0, 0,
                                   matrix.places.data(), matrix.values.data(),
                                   static_cast<int>(matrix.places.size())));
    }
  }
  return cone;
}

Eigen::MatrixXd multiplier(SDPCone cone, int block, Eigen::Index size) {
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(size, size);
  double* values = nullptr;
  int count = 0;
  must(SDPConeGetXArray(cone, block, &values, &count));
  if (count < size * (size + 1) / 2) return x;
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) x(i, j) = x(j, i) = values[i * (i + 1) / 2 + j];
  }
  return x;
}

const char* words(DSDPTerminationReason reason) {
  switch (reason) {
    case DSDP_CONVERGED:
      return "converged";
    case DSDP_INFEASIBLE_START:
      return "it could not start";
    case DSDP_SMALL_STEPS:
      return "its steps became too short";
    case DSDP_INDEFINITE_SCHUR_MATRIX:
      return "its normal equations became indefinite";
    case DSDP_MAX_IT:
      return "it needs more iterations";
    case DSDP_NUMERICAL_ERROR:
      return "a numerical error";
    case DSDP_UPPERBOUND:
      return "the objective is unbounded";
    default:
      return "it stopped";
  }
}

// How far from the gap asked for an answer may be that ended for want of digits.
constexpr double kNearGap = 1e-6;

SdpAnswer answer_of(DSDP solver, SDPCone cone, const SdpProblem& problem,
                    const SdpOptions& options) {
  SdpAnswer answer;
  DSDPTerminationReason reason{};
  DSDPSolutionType type{};
  must(DSDPStopReason(solver, &reason));
  must(DSDPComputeX(solver));  // decides which of the two problems is feasible
  must(DSDPGetSolutionType(solver, &type));
  double primal = 0, dual = 0;
  must(DSDPGetPPObjective(solver, &primal));
  must(DSDPGetDDObjective(solver, &dual));
  answer.x.resize(problem.cost.size());
  must(DSDPGetY(solver, answer.x.data(), static_cast<int>(answer.x.size())));
  answer.objective = problem.cost.dot(answer.x);
  answer.gap = std::abs(primal - dual) / (1 + std::abs(primal) + std::abs(dual));
  for (std::size_t j = 0; j + 1 < problem.blocks.size(); ++j) {
    answer.multipliers.push_back(multiplier(cone, static_cast<int>(j), problem.blocks[j].size()));
  }
  answer.infeasible = type == DSDP_INFEASIBLE;
  const bool near = answer.gap <= std::max(options.gap, kNearGap);
  answer.solved = type == DSDP_PDFEASIBLE && (reason == DSDP_CONVERGED || near);
  if (answer.infeasible) {
    answer.why = "no point satisfies the constraints";
  } else if (type == DSDP_UNBOUNDED) {
    answer.why = "the objective is unbounded";
  } else if (!answer.solved) {
    answer.why = words(reason);
  }
  return answer;
}

}  // namespace

SdpAnswer solve_dsdp(const SdpProblem& sound, const SdpOptions& options) {
  SdpProblem problem = sound;
  problem.blocks.push_back(of_all_variables(problem.cost.size(), options.bound));
  const OneBlasThread one;
  SdpAnswer answer;
  try {
    std::vector<std::vector<Sparse>> data;
    data.reserve(problem.blocks.size());
    const Dsdp solver(static_cast<int>(problem.cost.size()));
    for (Eigen::Index i = 0; i < problem.cost.size(); ++i) {
      must(DSDPSetDualObjective(solver, static_cast<int>(i) + 1, -problem.cost[i]));
    }
    const SDPCone cone = give_blocks(solver, problem, data);
    must(DSDPSetYBounds(solver, -options.bound, options.bound));
    must(DSDPSetGapTolerance(solver, options.gap));
    must(DSDPSetMaxIts(solver, options.max_iterations));
    must(DSDPSetPotentialParameter(solver, 5));
    must(DSDPSetup(solver));
    must(DSDPSolve(solver));
    return answer_of(solver, cone, problem, options);
  } catch (const std::runtime_error& error) {
    answer.why = error.what();
  }
  return answer;
}

}  // namespace hapticd::synthesis
