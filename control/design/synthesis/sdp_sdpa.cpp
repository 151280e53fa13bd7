// SDPA solves min c'x subject to sum_i x_i F_i - F_0 >= 0; indices from 1, upper triangle.
#include <fcntl.h>
#include <sdpa_call.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "control/design/synthesis/sdp_backends.h"

namespace hapticd::synthesis {

namespace {

/// While it lives, what the process writes to its standard output is lost: SDPA prints there, asked
/// or not.
class Silence {
 public:
  Silence() {
    std::fflush(stdout);
    kept_ = dup(STDOUT_FILENO);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ < 0 || nowhere < 0) return;
    dup2(nowhere, STDOUT_FILENO);
    close(nowhere);
  }
  ~Silence() {
    std::fflush(stdout);
    if (kept_ < 0) return;
    dup2(kept_, STDOUT_FILENO);
    close(kept_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  int kept_ = -1;
};

void state_problem(SDPA& solver, const SdpProblem& problem) {
  solver.inputConstraintNumber(static_cast<int>(problem.cost.size()));
  solver.inputBlockNumber(static_cast<int>(problem.blocks.size()));
  for (std::size_t j = 0; j < problem.blocks.size(); ++j) {
    const int block = static_cast<int>(j) + 1;
    solver.inputBlockSize(block, static_cast<int>(problem.blocks[j].size()));
    solver.inputBlockType(block, SDPA::SDP);
  }
  solver.initializeUpperTriangleSpace();
  for (Eigen::Index i = 0; i < problem.cost.size(); ++i) {
    solver.inputCVec(static_cast<int>(i) + 1, problem.cost[i]);
  }
  for (std::size_t j = 0; j < problem.blocks.size(); ++j) {
    for (const LinearMatrix::Entry& entry : problem.blocks[j].gathered()) {
      solver.inputElement(static_cast<int>(entry.variable) + 1, static_cast<int>(j) + 1,
                          static_cast<int>(entry.row) + 1, static_cast<int>(entry.column) + 1,
                          entry.variable < 0 ? -entry.value : entry.value);
    }
  }
}

}  // namespace

SdpAnswer solve_sdpa(const SdpProblem& problem, const SdpOptions& options) {
  const OneBlasThread one;
  const Silence silence;
  SDPA solver;
  // Started far out: with its defaults it calls programs with a thin interior infeasible.
  solver.setParameterType(SDPA::PARAMETER_STABLE_BUT_SLOW);
  solver.setParameterLambdaStar(1e4);
  solver.setParameterMaxIteration(options.max_iterations);
  solver.setParameterEpsilonStar(options.gap);
  solver.setParameterEpsilonDash(options.gap);
  solver.setDisplay(nullptr);
  solver.setNumThreads(1);
  state_problem(solver, problem);
  solver.initializeUpperTriangle();
  solver.initializeSolve();
  solver.solve();
  SdpAnswer answer;
  const SDPA::PhaseType phase = solver.getPhaseValue();
  answer.x = Eigen::Map<Eigen::VectorXd>(solver.getResultXVec(), problem.cost.size());
  answer.objective = problem.cost.dot(answer.x);
  answer.gap = std::abs(solver.getPrimalObj() - solver.getDualObj()) /
               (1 + std::abs(solver.getPrimalObj()) + std::abs(solver.getDualObj()));
  for (const LinearMatrix& block : problem.blocks) {
    answer.multipliers.push_back(Eigen::MatrixXd::Zero(block.size(), block.size()));
  }
  answer.infeasible = phase == SDPA::pINF_dFEAS || phase == SDPA::dUNBD;
  answer.solved = phase == SDPA::pdOPT || (phase == SDPA::pdFEAS && answer.gap < 1e-6);
  if (answer.infeasible) {
    answer.why = "no point satisfies the constraints";
  } else if (!answer.solved) {
    answer.why = "SDPA stopped in phase " + std::to_string(static_cast<int>(phase));
  }
  solver.terminate();
  return answer;
}

}  // namespace hapticd::synthesis
