// E(z) of networks. Between ticks the contacts move on a straight line (first-order hold), for
// every integrator: their velocity is then (y_k - y_{k-1})/T, what a damper at a contact needs. A
// displacement that is held and jumps would make it push without bound, and the trapezoid's own
// rule for y' rings at half the loop rate for ever.
//
// A step of xi' = A xi + B y + drift is   xi_k = carry xi_{k-1} + from y_{k-1} + to y_k + add.
// Stored is eta_{k} = xi_{k+1} without its share of y_{k+1}, so that y_{k-1} takes no states; only
// R y_{k-1} does, for the dampers R'R that contacts move. Poles at 0 from R and at 1/(1 - s T) from
// A are apart, so nothing cancels: E(z) has the order of E(s)'s proper part plus the rank of R.
//
// Backward Euler is E(s) at s = (1 - 1/z)/T. Each tick the nodes minimise the incremental potential
//   1/2 |w|^2_K + 1/(2T) |w - w_{k-1}|^2_B + 1/(2T^2) |x - x_{k-1} - T v_{k-1}|^2_M - g'w
// over x, with w = (y, x). It is convex in w, so its minimum over x is convex in y; D_E, the second
// derivative of that, is symmetric and >= 0, whatever the step.
#include <Eigen/Dense>
#include <stdexcept>

#include "control/build/eigen.h"
#include "control/build/network.h"
#include "control/build/network_modes.h"
#include "control/core/algebra.h"

namespace hapticd::build {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Step {
  MatrixXd carry, from, to;
  VectorXd add;
};

/// (1 - s h A) xi_k = (1 + (1-s) h A) xi_{k-1} + h B ((1-s) y_{k-1} + s y_k) + h drift:
/// s = 1 backward Euler, s = 1/2 trapezoid.
Step implicit_step(const NetworkModes& modes, double h, double s) {
  const MatrixXd one = MatrixXd::Identity(modes.A.rows(), modes.A.rows());
  const Eigen::PartialPivLU<MatrixXd> ahead(one - s * h * modes.A);
  return {.carry = ahead.solve(one + (1 - s) * h * modes.A),
          .from = ahead.solve((1 - s) * h * modes.B),
          .to = ahead.solve(s * h * modes.B),
          .add = ahead.solve(h * modes.drift)};
}

/// exp of ((A, (B drift), 0), (0, 0, 1), (0, 0, 0)) over a step: its first row is (Phi, the answer
/// to a unit input, the answer to an input that rises from 0 to 1) (Van Loan, 1978).
Step exact_step(const NetworkModes& modes, double h) {
  const Index n = modes.A.rows(), m = modes.B.cols() + 1;
  MatrixXd all = MatrixXd::Zero(n + 2 * m, n + 2 * m);
  all.topLeftCorner(n, n) = h * modes.A;
  all.block(0, n, n, m - 1) = h * modes.B;
  all.col(n + m - 1).head(n) = h * modes.drift;
  all.block(n, n + m, m, m).setIdentity();
  const MatrixXd after = algebra::exponential(all);
  const MatrixXd unit = after.block(0, n, n, m), rise = after.topRightCorner(n, m);
  return {.carry = after.topLeftCorner(n, n),
          .from = (unit - rise).leftCols(m - 1),
          .to = rise.leftCols(m - 1),
          .add = unit.col(m - 1)};
}

/// `count` equal steps along the straight line from y_{k-1} to y_k.
Step in_sequence(const Step& step, std::size_t count) {
  Step all{.carry = MatrixXd::Identity(step.carry.rows(), step.carry.cols()),
           .from = MatrixXd::Zero(step.from.rows(), step.from.cols()),
           .to = MatrixXd::Zero(step.to.rows(), step.to.cols()),
           .add = VectorXd::Zero(step.add.size())};
  for (std::size_t i = 0; i < count; ++i) {
    const double begin = static_cast<double>(i) / static_cast<double>(count);
    const double end = static_cast<double>(i + 1) / static_cast<double>(count);
    all.carry = step.carry * all.carry;
    all.from = step.carry * all.from + (1 - begin) * step.from + (1 - end) * step.to;
    all.to = step.carry * all.to + begin * step.from + end * step.to;
    all.add = step.carry * all.add + step.add;
  }
  return all;
}

Step step_of(const NetworkModes& modes, double period_s, Integrator integrator,
             std::size_t substeps) {
  if (integrator == Integrator::exact) return exact_step(modes, period_s);
  const double weight = integrator == Integrator::backward_euler ? 1.0 : 0.5;
  return in_sequence(implicit_step(modes, period_s / static_cast<double>(substeps), weight),
                     substeps);
}

std::vector<double> values(const VectorXd& vector) {
  return {vector.begin(), vector.end()};
}

LinearScene scene_of(const NetworkModes& modes, const Step& step, double period_s) {
  const Index n = modes.A.rows(), r = modes.R.rows(), m = modes.B.cols();
  MatrixXd A = MatrixXd::Zero(n + r, n + r), B(n + r, m), C(m, n + r), start(n + r, m);
  VectorXd drift = VectorXd::Zero(n + r), offset = drift;
  A.topLeftCorner(n, n) = step.carry;
  B.topRows(n) = step.carry * step.to + step.from;
  C.leftCols(n) = modes.C;
  drift.head(n) = step.add;
  start.topRows(n) = step.carry * modes.start_gain + step.from;
  offset.head(n) = step.carry * modes.start_offset + step.add;
  B.bottomRows(r) = start.bottomRows(r) = modes.R;
  C.rightCols(r) = -modes.R.transpose() / period_s;
  const MatrixXd D = modes.C * step.to + modes.D + modes.R.transpose() * modes.R / period_s;
  return {.coordinates = modes.coordinates,
          .A = plain(A),
          .B = plain(B),
          .C = plain(C),
          .D = plain(symmetric(D)),
          .push = values(modes.push),
          .drift = values(drift),
          .start_gain = plain(start),
          .start_offset = values(offset)};
}

std::string any_problem(const std::vector<Network>& networks, double period_s,
                        std::size_t substeps) {
  if (!(period_s > 0)) return "the period must be greater than 0 s";
  if (substeps == 0) return "a network takes at least 1 step per period";
  return problem(networks, UINT32_MAX);
}

}  // namespace

LinearScene linear_scene(const std::vector<Network>& networks, double period_s,
                         Integrator integrator, std::size_t substeps) {
  const std::string found = any_problem(networks, period_s, substeps);
  if (!found.empty()) throw std::invalid_argument(found);
  std::vector<Network> felt;
  for (const Network& network : networks)
    for (Network& part : separate(network)) felt.push_back(std::move(part));
  if (felt.empty()) return {};
  const NetworkModes modes = network_modes(felt, period_s);
  return scene_of(modes, step_of(modes, period_s, integrator, substeps), period_s);
}

}  // namespace hapticd::build
