#include "control/design/check/sampled_loop.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace hapticd::check {
namespace {

/// (x, v, u_{k-1}, h) -> u_k.
System controller(const SampledLoop& loop, const LoopCase& one) {
  Matrix position(2, 4), others = Matrix::Zero(3, 4);
  position << Matrix::Identity(2, 2), Matrix::Zero(2, 2);
  System whole = scaled(series(loop.force, constant(position)), -one.contact);
  if (!loop.observer) return whole;
  others(0, 0) = others(1, 2) = others(2, 3) = 1;
  return sum(whole, scaled(series(observer_of(*loop.observer), constant(others)), -1));
}

/// h over (x, v, u that acts, push).
Eigen::RowVector4d measured_hand(const LoopCase& one) {
  const double share = one.hand_kg / (one.mass_kg + one.hand_kg);
  const double damping = one.damping_Ns_m + one.hand_Ns_m;
  return {share * one.hand_N_m - one.hand_N_m, share * damping - one.hand_Ns_m, -share, 1 - share};
}

/// Its series up to a^18; a has no entry above 1.
Eigen::Matrix3d small_exponential(const Eigen::Matrix3d& a) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity();
  for (int k = 18; k > 0; --k) sum = (Eigen::Matrix3d::Identity() + a * sum / k).eval();
  return sum;
}

}  // namespace

std::string malformed(const SampledLoop& loop, const LoopCase& one) {
  const System& f = loop.force;
  const Eigen::Index n = f.states();
  if (f.inputs() != 2 || f.outputs() != 1 || f.A.cols() != n || f.B.rows() != n ||
      f.B.cols() != 2 || f.C.rows() != 1 || f.C.cols() != n)
    return "the force must be a system from position and velocity to one force";
  if (!f.A.allFinite() || !f.B.allFinite() || !f.C.allFinite() || !f.D.allFinite())
    return "the force has an entry that is not a finite number";
  if (loop.observer) {
    const control::ObserverPlan& o = *loop.observer;
    for (const double value :
         {o.inertia, o.damping, o.command_share, o.hand_share, o.share, o.second_share})
      if (!std::isfinite(value)) return "the observer has a figure that is not finite";
  }
  if (!(loop.period_s > 0) || !std::isfinite(loop.period_s)) return "the period must be > 0";
  if (!(one.mass_kg > 0)) return "the mass must be > 0";
  for (const double value : {one.mass_kg, one.damping_Ns_m, one.hand_kg, one.hand_Ns_m,
                             one.hand_N_m, one.latency_s, one.contact})
    if (!(value >= 0) || !std::isfinite(value))
      return "mass, damping, hand, latency and contact must be finite numbers >= 0";
  if (one.latency_s > 1000 * loop.period_s) return "the latency is more than 1000 periods";
  return {};
}

Latency split_latency(double latency_s, double period_s) {
  constexpr double kRounding = 1e-12;  // of a period: k T computed as a product is k whole ticks
  const double ticks = std::floor(latency_s / period_s + kRounding);
  const double rest = latency_s - ticks * period_s;
  return {static_cast<int>(ticks), rest > kRounding * period_s ? rest : 0};
}

Held held_device(const LoopCase& one, double time_s) {
  if (time_s == 0) return {Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero()};
  const double mass = one.mass_kg + one.hand_kg;
  Eigen::Matrix3d a;  // (x, v, u), u' = 0
  a << 0, 1, 0, -one.hand_N_m / mass, -(one.damping_Ns_m + one.hand_Ns_m) / mass, 1 / mass, 0, 0, 0;
  // Length, time and force in units in which the matrix is of the size of its eigenvalues.
  const double rate = std::max(std::sqrt(-a(1, 0)), -a(1, 1));
  const int halvings = std::max(0, std::ilogb(std::max(rate * time_s, 1e-30)) + 2);
  const double step = std::ldexp(time_s, -halvings);
  const double velocity = 1 / step, force = mass * velocity / step;
  const Eigen::Vector3d unit(1, velocity, force);
  a = (unit.cwiseInverse().asDiagonal() * (step * a) * unit.asDiagonal()).eval();
  Eigen::Matrix3d e = small_exponential(a);
  for (int i = 0; i < halvings; ++i) e = (e * e).eval();
  e = (unit.asDiagonal() * e * unit.cwiseInverse().asDiagonal()).eval();
  return {e.topLeftCorner<2, 2>(), e.topRightCorner<2, 1>()};
}

Tick tick_of(const SampledLoop& loop, const LoopCase& one, int remembered) {
  const System c = controller(loop, one);
  const int ticks = split_latency(one.latency_s, loop.period_s).ticks;
  const Eigen::Index states = c.states(), first = 2 + states, size = first + remembered;
  const auto unit = [&](Eigen::Index i) {
    return Matrix(Matrix::Identity(size + 1, size + 1).row(i));
  };
  Tick tick;
  tick.before = unit(first + ticks);
  Matrix inputs = Matrix::Zero(4, size + 1);
  inputs.row(0) = unit(0);
  inputs.row(1) = unit(1);
  inputs.row(2) = unit(first);
  const Eigen::RowVector4d hand = measured_hand(one);
  inputs.row(3) =
      hand[0] * unit(0) + hand[1] * unit(1) + hand[2] * tick.before + hand[3] * unit(size);
  const Matrix own = Matrix::Identity(size + 1, size + 1).middleRows(2, states);
  const Matrix command = c.C * own + c.D * inputs;
  tick.after = ticks == 0 ? command : unit(first + ticks - 1);
  tick.kept.resize(size - 2, size + 1);
  tick.kept << c.A * own + c.B * inputs, command,
      Matrix::Identity(size + 1, size + 1).middleRows(first, remembered - 1);
  return tick;
}

Matrix transition(const SampledLoop& loop, const LoopCase& one, int remembered) {
  const Tick tick = tick_of(loop, one, remembered);
  const double fraction = split_latency(one.latency_s, loop.period_s).fraction_s;
  const Held old = held_device(one, fraction), rest = held_device(one, loop.period_s - fraction);
  const Eigen::Index size = tick.kept.rows() + 2;
  Matrix a(size, size);
  a.topRows(2) =
      rest.phi * old.gamma * tick.before.leftCols(size) + rest.gamma * tick.after.leftCols(size);
  a.topLeftCorner<2, 2>() += rest.phi * old.phi;
  a.bottomRows(size - 2) = tick.kept.leftCols(size);
  return a;
}

double loop_radius(const SampledLoop& loop, const LoopCase& one) {
  if (!malformed(loop, one).empty()) return std::nan("");
  const int remembered = split_latency(one.latency_s, loop.period_s).ticks + 1;
  const Matrix a = transition(loop, one, remembered);
  Eigen::VectorXcd poles = eigenvalues(a);
  if (!poles.allFinite()) return std::nan("");
  if (one.contact == 0 && one.hand_N_m == 0) {
    Eigen::Index free = 0;
    (poles.array() - 1).abs().minCoeff(&free);
    poles[free] = 0;
  }
  return poles.cwiseAbs().maxCoeff();
}

}  // namespace hapticd::check
