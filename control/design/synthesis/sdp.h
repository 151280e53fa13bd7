// Semidefinite programs, the one interface to a solver:
//
//   minimise c'x   over x in R^n,  subject to  F_j(x) = F_j0 + sum_i x_i F_ji >= 0,  j = 1 .. blocks
//
// Matrices are symmetric and given entry by entry. Answers are never believed: whoever asks
// verifies by hapticd_check, with a shift that is larger than the solver's error.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace hapticd::synthesis {

class LinearMatrix {
 public:
  explicit LinearMatrix(Eigen::Index size) : size_(size) {}
  Eigen::Index size() const noexcept { return size_; }
  /// Adds `value` to entry (row, column) and (column, row) of F_i; variable -1: of F_0.
  void add(Eigen::Index variable, Eigen::Index row, Eigen::Index column, double value);
  struct Entry {
    Eigen::Index variable, row, column;  ///< row <= column
    double value;
  };
  const std::vector<Entry>& entries() const noexcept { return entries_; }
  /// Entries of the same variable and place added up, in order of variable, column, row.
  std::vector<Entry> gathered() const;
  /// F(x), dense.
  Eigen::MatrixXd at(const Eigen::VectorXd& x) const;

 private:
  Eigen::Index size_;
  std::vector<Entry> entries_;
};

struct SdpProblem {
  Eigen::VectorXd cost;  ///< c; its size is the number of variables
  std::vector<LinearMatrix> blocks;
};

enum class SdpBackend : std::uint8_t {
  dsdp,  ///< dual scaling (Benson, Ye, Zhang 2000): its x is strictly feasible
  sdpa,  ///< primal-dual; only where it was built in, for comparison
};

struct SdpOptions {
  double gap = 1e-9;   ///< relative
  double bound = 1e7;  ///< |x_i| stays below it
  int max_iterations = 300;
  SdpBackend backend = SdpBackend::dsdp;
};

struct SdpAnswer {
  bool solved = false;  ///< the solver says so; verify
  bool infeasible = false;
  Eigen::VectorXd x;  ///< the solver's last, solved or not; empty where it has none
  double objective = 0;
  double gap = 0;  ///< relative, as reached
  /// Of each block, X_j >= 0 with c_i = sum_j trace(X_j F_ji): the optimum falls by
  /// trace(X_j E) where F_j0 grows by a small E. Zero blocks where the solver has none.
  std::vector<Eigen::MatrixXd> multipliers;
  std::string why;  ///< the solver's reason where it is not solved
};

/// One thread, no output, the same bits for the same problem on the same machine.
SdpAnswer solve(const SdpProblem& problem, const SdpOptions& options = {});

bool available(SdpBackend backend) noexcept;

/// Smallest over the blocks of the smallest eigenvalue of F_j(x): how far inside x is.
double slack(const SdpProblem& problem, const Eigen::VectorXd& x);

}  // namespace hapticd::synthesis
