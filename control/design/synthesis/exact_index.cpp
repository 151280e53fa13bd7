#include "control/design/synthesis/exact_index.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "control/design/synthesis/balance.h"

namespace hapticd::synthesis {
namespace {

using check::Latency;
using check::Tick;
using Index = Eigen::Index;

/// Phi and Q of one stretch of time.
struct Stretch {
  Matrix phi, cost;
};

Stretch stretch(const Matrix& a, const Matrix& cost, double time_s) {
  const Index n = a.rows();
  const Matrix identity = Matrix::Identity(n, n);
  if (time_s == 0) return {identity, Matrix::Zero(n, n)};
  constexpr int kTerms = 20;
  const double size = a.cwiseAbs().rowwise().sum().maxCoeff() * time_s;
  const int halvings = std::max(0, std::ilogb(std::max(size, 1e-30)) + 2);
  const double h = std::ldexp(time_s, -halvings);
  Stretch s{identity, Matrix::Zero(n, n)};
  Matrix power = identity, term = cost * h;
  for (int k = 1; k <= kTerms; ++k) {
    s.cost += term;
    term = (a.transpose() * term + term * a) * (h / (k + 1));
    power = (power * a).eval() * (h / k);
    s.phi += power;
  }
  for (int i = 0; i < halvings; ++i) {
    s.cost += (s.phi.transpose() * s.cost * s.phi).eval();
    s.phi = (s.phi * s.phi).eval();
  }
  return s;
}

/// Device, wall that is meant and weight in continuous time, y = (x, v, wall, weight, 1, u).
struct Between {
  Matrix a, cost;
  Index wall = 0, weight = 0;  ///< states of the two
  Eigen::RowVectorXd push;     ///< over (weight, 1)
  bool finite = true;          ///< else v_v would be an impulse
  Index without_command() const { return 3 + wall + weight; }
};

/// v_v over (wall, weight, 1), and the wall's own equation, in place.
Eigen::RowVectorXd wall_velocity(Between& y, const LoopCase& one, const WallMeant& meant,
                                 const System& f) {
  const double mass = one.hand_kg, damping = meant.damping_Ns_m + one.hand_Ns_m;
  const double stiffness = meant.stiffness_N_m + one.hand_N_m;
  Eigen::RowVectorXd v_v = Eigen::RowVectorXd::Zero(y.a.rows());
  const Index pushed = 2 + y.wall, count = y.weight + 1;
  if (mass > 0) {
    y.a(2, 3) = v_v[3] = 1;
    y.a(3, 2) = -stiffness / mass;
    y.a(3, 3) = -damping / mass;
    y.a.row(3).segment(pushed, count) += y.push / mass;
  } else if (damping > 0) {
    v_v[2] = -stiffness / damping;
    v_v.segment(pushed, count) = y.push / damping;
    y.a.row(2) = v_v;
  } else {
    y.finite = f.D(0, 0) == 0;
    v_v.segment(pushed, y.weight) = f.C * f.A / stiffness;
    v_v[pushed + y.weight] = (f.C * f.B)(0, 0) / stiffness;
  }
  return v_v;
}

Between between(const LoopCase& one, const WallMeant& meant) {
  const System f =
      realised(reduced({times(meant.weight.num, Eigen::Vector2d(0, 1)), meant.weight.den}));
  Between y;
  y.wall = one.hand_kg > 0 ? 2 : meant.damping_Ns_m + one.hand_Ns_m > 0 ? 1 : 0;
  y.weight = f.states();
  const Index size = y.without_command() + 1, weight = 2 + y.wall, constant = weight + y.weight;
  y.push.resize(y.weight + 1);
  y.push << f.C, f.D;
  y.a = Matrix::Zero(size, size);
  y.a.block(weight, weight, y.weight, y.weight) = f.A;
  y.a.block(weight, constant, y.weight, 1) = f.B;
  const double mass = one.mass_kg + one.hand_kg;
  y.a(0, 1) = 1;
  y.a(1, 0) = -one.hand_N_m / mass;
  y.a(1, 1) = -(one.damping_Ns_m + one.hand_Ns_m) / mass;
  y.a.row(1).segment(weight, y.weight + 1) = y.push / mass;
  y.a(1, size - 1) = 1 / mass;
  Eigen::RowVectorXd error = wall_velocity(y, one, meant, f);
  error[1] -= 1;
  y.cost = error.transpose() * error;
  return y;
}

/// z' = M z over z = (x, v, wall, weight, 1, controller and commands), and Q over a period.
Stretch period(const Between& y, const Tick& tick, const Latency& latency, double period_s) {
  const Index shared = y.without_command(), others = tick.kept.rows(), size = shared + others;
  // Rows over (z of sampled_loop.h, push) as rows over z here.
  const auto placed = [&](const Matrix& rows) {
    Matrix out = Matrix::Zero(rows.rows(), size);
    out.leftCols(2) = rows.leftCols(2);
    out.rightCols(others) = rows.middleCols(2, others);
    out.middleCols(2 + y.wall, y.weight + 1) = rows.rightCols(1) * y.push;
    return out;
  };
  const Stretch old = stretch(y.a, y.cost, latency.fraction_s);
  const Stretch rest = stretch(y.a, y.cost, period_s - latency.fraction_s);
  Matrix start = Matrix::Identity(shared + 1, size), middle(shared + 1, size);
  start.row(shared) = placed(tick.before);
  middle << (old.phi * start).topRows(shared), placed(tick.after);
  Stretch whole{Matrix(size, size),
                start.transpose() * old.cost * start + middle.transpose() * rest.cost * middle};
  whole.phi << (rest.phi * middle).topRows(shared), placed(tick.kept);
  return whole;
}

/// Without row and column `index`.
Matrix without(const Matrix& m, Index index) {
  const Index n = m.rows() - 1, rest = n - index;
  Matrix out(n, n);
  out << m.topLeftCorner(index, index), m.topRightCorner(index, rest),
      m.bottomLeftCorner(rest, index), m.bottomRightCorner(rest, rest);
  return out;
}

bool is_judged(const WallMeant& meant) {
  const Rational& w = meant.weight;
  return meant.stiffness_N_m > 0 && std::isfinite(meant.stiffness_N_m) && meant.damping_Ns_m >= 0 &&
         std::isfinite(meant.damping_Ns_m) && malformed(w).empty() &&
         malformed(reduced({times(w.num, Eigen::Vector2d(0, 1)), w.den})).empty();
}

}  // namespace

double exact_index(const SampledLoop& loop, const LoopCase& one, const WallMeant& meant) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!check::malformed(loop, one).empty() || !is_judged(meant)) return std::nan("");
  const Latency latency = check::split_latency(one.latency_s, loop.period_s);
  const Tick tick = check::tick_of(loop, one, latency.ticks + 1);
  const Between y = between(one, meant);
  if (!y.finite) return kInfinity;
  const Stretch whole = period(y, tick, latency, loop.period_s);
  const Index constant = 2 + y.wall + y.weight, size = whole.phi.rows();
  const Matrix m = without(whole.phi, constant), cost = without(whole.cost, constant);
  if (!(check::spectral_radius(m) < 1)) return kInfinity;
  Vector driven(size - 1);
  driven << whole.phi.col(constant).head(constant),
      whole.phi.col(constant).tail(size - 1 - constant);
  const Vector rest = (Matrix::Identity(size - 1, size - 1) - m).partialPivLu().solve(driven);
  const Matrix x = discrete_lyapunov(m.transpose(), cost);
  return rest.dot(x * rest);
}

}  // namespace hapticd::synthesis
