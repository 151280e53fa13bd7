#include "control/design/synthesis/sdp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "control/design/check/linear.h"
#include "control/design/synthesis/sdp_backends.h"

namespace hapticd::synthesis {

void LinearMatrix::add(Eigen::Index variable, Eigen::Index row, Eigen::Index column, double value) {
  if (row > column) std::swap(row, column);
  entries_.push_back({variable, row, column, value});
}

std::vector<LinearMatrix::Entry> LinearMatrix::gathered() const {
  std::vector<Entry> sorted = entries_;
  const auto place = [](const Entry& e) { return std::tuple(e.variable, e.column, e.row); };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const Entry& a, const Entry& b) { return place(a) < place(b); });
  std::vector<Entry> sums;
  for (const Entry& entry : sorted) {
    if (!sums.empty() && place(sums.back()) == place(entry)) {
      sums.back().value += entry.value;
    } else {
      sums.push_back(entry);
    }
  }
  std::erase_if(sums, [](const Entry& e) { return e.value == 0; });
  return sums;
}

Eigen::MatrixXd LinearMatrix::at(const Eigen::VectorXd& x) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size_, size_);
  for (const Entry& entry : entries_) {
    const double value = entry.variable < 0 ? entry.value : x[entry.variable] * entry.value;
    sum(entry.row, entry.column) += value;
    if (entry.row != entry.column) sum(entry.column, entry.row) += value;
  }
  return sum;
}

double slack(const SdpProblem& problem, const Eigen::VectorXd& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const LinearMatrix& block : problem.blocks) {
    if (block.size() > 0) least = std::min(least, check::smallest_eigenvalue(block.at(x)));
  }
  return least;
}

namespace {

std::string unsound(const SdpProblem& problem) {
  if (!problem.cost.allFinite()) return "the cost is not finite";
  for (const LinearMatrix& block : problem.blocks) {
    for (const LinearMatrix::Entry& entry : block.entries()) {
      if (!std::isfinite(entry.value)) return "an entry of a block is not finite";
      if (entry.variable < -1 || entry.variable >= problem.cost.size() || entry.row < 0 ||
          entry.column >= block.size()) {
        return "an entry of a block is out of range";
      }
    }
  }
  return {};
}

}  // namespace

bool available(SdpBackend backend) noexcept {
  return backend == SdpBackend::dsdp || kHasSdpa;
}

SdpAnswer solve(const SdpProblem& problem, const SdpOptions& options) {
  SdpAnswer answer;
  answer.why = unsound(problem);
  if (answer.why.empty() && !available(options.backend)) {
    answer.why = "this solver is not built in";
  }
  if (!answer.why.empty()) return answer;
  return options.backend == SdpBackend::dsdp ? solve_dsdp(problem, options)
                                             : solve_sdpa(problem, options);
}

}  // namespace hapticd::synthesis
