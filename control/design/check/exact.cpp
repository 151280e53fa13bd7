#include "control/design/check/exact.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "control/design/check/frequency.h"

namespace hapticd::check {
namespace {

constexpr double kMostPeriods = 1000;
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();

/// Latency as n whole periods and a part t in (0, T], 0 if there is none.
struct Lateness {
  int whole = 0;
  double part_s = 0;
};

Lateness lateness(double latency_s, double period_s) {
  if (latency_s == 0) return {};
  const double whole = std::ceil(latency_s / period_s) - 1;
  return {static_cast<int>(whole), std::min(latency_s - whole * period_s, period_s)};
}

double eta_of(double part_s, double period_s) {
  return part_s * (period_s - part_s) / (period_s * period_s);
}

System delayed(System f, int samples) {
  for (int i = 0; i < samples; ++i) f = series(delay(f.outputs()), f);
  return f;
}

std::string problem_of(const System& f, const Matrix& damping, double latency_s, double period_s) {
  std::string problem = malformed(f);
  if (problem.empty()) problem = malformed(damping, f.inputs(), "the damping");
  if (!problem.empty()) return problem;
  if (!(period_s > 0 && std::isfinite(period_s))) return "the period must be positive";
  if (!(latency_s >= 0 && latency_s <= kMostPeriods * period_s))
    return "the latency must be between zero and 1000 periods";
  if (!positive_definite(damping)) return "the damping is not positive definite";
  return {};
}

/// Y of the inequality and its rounding: sqrt(eta/4) L^-1 [C, -I], Delta = L L'.
void add_split(Dissipation& d, const Matrix& output, const Matrix& damping, double eta) {
  const Eigen::Index m = damping.rows();
  const Matrix L = Eigen::LLT<Matrix>(damping).matrixL();
  const Matrix identity = Matrix::Identity(m, m);
  const Matrix inverse = Matrix(L.triangularView<Eigen::Lower>().solve(identity)).cwiseAbs();
  d.Y = 0.5 * std::sqrt(eta) * L.triangularView<Eigen::Lower>().solve(output);
  // L itself is that of a matrix within rounding of Delta.
  const double length = 2 * (static_cast<double>(m) + 4);
  d.error_Y = length * kRounding * (inverse * L.cwiseAbs() * d.Y.cwiseAbs());
}

}  // namespace

Premises exact_premises(const System& f, const Matrix& damping, double latency_s, double period_s) {
  Premises premises;
  premises.problem = problem_of(f, damping, latency_s, period_s);
  if (!premises.problem.empty()) return premises;
  const Lateness late = lateness(latency_s, period_s);
  const System g = delayed(f, late.whole);
  const Rest still = rest(g);
  premises.problem = still.problem;
  if (!premises.problem.empty()) return premises;

  const Eigen::Index n = g.states(), m = g.inputs();
  const Matrix identity = Matrix::Identity(m, m);
  Dissipation& d = premises.inequality;
  d.R = symmetric_part(damping) - 0.5 * period_s * still.gain;
  d.error_R = 0.5 * period_s * (still.error_gain + kRounding * still.gain.cwiseAbs()) +
              kRounding * damping.cwiseAbs();
  if (latency_s == 0) {
    d.A = g.A;
    d.B = -period_s * still.x;
    d.error_B = period_s * (still.error_x + kRounding * still.x.cwiseAbs());
    d.S = 0.5 * g.C;
    d.Y = Matrix(0, n);
    return premises;
  }
  const double share = late.part_s / period_s;
  d.A = Matrix::Zero(n + m, n + m);
  d.A.topLeftCorner(n, n) = g.A;
  d.A.bottomLeftCorner(m, n) = g.C;
  d.B.resize(n + m, m);
  d.B << -period_s * still.x, -period_s * still.gain;
  d.error_B.resize(n + m, m);
  d.error_B << period_s * (still.error_x + kRounding * still.x.cwiseAbs()),
      period_s * (still.error_gain + kRounding * still.gain.cwiseAbs());
  d.S.resize(m, n + m);
  d.S << 0.5 * (1 - share) * g.C, 0.5 * share * identity;
  Matrix difference(m, n + m);
  difference << g.C, -identity;
  add_split(d, difference, damping, eta_of(late.part_s, period_s));
  return premises;
}

Verdict proves_exact(const System& f, const Matrix& damping, double latency_s, double period_s,
                     const Matrix& P) {
  const Premises premises = exact_premises(f, damping, latency_s, period_s);
  if (!premises.problem.empty())
    return {false, premises.problem, -std::numeric_limits<double>::infinity()};
  return proves(premises.inequality, P);
}

double exact_margin(const System& f, const Matrix& damping, double latency_s, double period_s) {
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  if (!problem_of(f, damping, latency_s, period_s).empty())
    return std::numeric_limits<double>::quiet_NaN();
  if (!(spectral_radius(f.A) < 1)) return kNever;
  const Lateness late = lateness(latency_s, period_s);
  const Rest still = rest(f);
  if (!still.problem.empty()) return kNever;

  // z^-n F = F1 + (z-1) z^-n (-C (z I - A)^-1 x) - (1 - z^-n) F1, the last part a finite sum.
  const System regular{f.A, -period_s * still.x, f.C, Matrix::Zero(f.outputs(), f.inputs())};
  const Matrix step = period_s * still.gain;
  const double share = late.part_s / period_s, eta = eta_of(late.part_s, period_s);
  const Eigen::LLT<Matrix> factor(damping);
  const auto condition = [&](double angle) {
    const Complex back = on_circle(-angle);
    ComplexMatrix rest_of_f = std::pow(back, late.whole) * at(regular, on_circle(angle));
    // T F1 (z^-n - 1)/(z - 1) = -T F1 (z^-1 + .. + z^-n)
    Complex chain = 0;
    for (int i = 1; i <= late.whole; ++i) chain += std::pow(back, i);
    rest_of_f -= chain * step.cast<Complex>();
    const ComplexMatrix q = back * step.cast<Complex>() + (1.0 - back) * rest_of_f;
    ComplexMatrix left = rest_of_f - share * q;
    left += (damping - 0.5 * step).cast<Complex>();
    if (eta > 0) {
      const ComplexMatrix half =
          factor.matrixL().toDenseMatrix().cast<Complex>().triangularView<Eigen::Lower>().solve(q);
      left -= 0.25 * eta * half.adjoint() * half;
    }
    return smallest_hermitian(left);
  };
  return smallest(condition, frequency_grid(f.A)).value;
}

ComplexMatrix exact_condition(const ComplexMatrix& f, const Matrix& damping, double latency_s,
                              double period_s, double angle) {
  const Lateness late = lateness(latency_s, period_s);
  const Complex z = on_circle(angle), back = std::conj(z);
  const ComplexMatrix integrated = std::pow(back, late.whole) * period_s / (z - 1.0) * f;
  const ComplexMatrix q = (1.0 - back) * integrated;
  const double eta = eta_of(late.part_s, period_s);
  ComplexMatrix left = damping.cast<Complex>() + integrated - late.part_s / period_s * q;
  if (eta > 0)
    left -= 0.25 * eta * q.adjoint() *
            damping.llt().solve(Matrix::Identity(damping.rows(), damping.rows())).cast<Complex>() *
            q;
  return left;
}

}  // namespace hapticd::check
