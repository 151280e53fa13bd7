#include "control/design/check/positive_real.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "control/design/check/frequency.h"

namespace hapticd::check {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
constexpr double kNever = -std::numeric_limits<double>::infinity();

/// min over frequency of the smallest eigenvalue of the Hermitian part of G, or of its inverse.
double level(const System& g, bool inverted) {
  if (!malformed(g).empty()) return kUndefined;
  if (!(spectral_radius(g.A) < 1)) return kNever;
  std::vector<double> grid = frequency_grid(g.A);
  // At rest G may be zero: the limit is reached from beside.
  if (inverted) grid.erase(grid.begin());
  const auto hermitian = [&](double angle) {
    const ComplexMatrix response = at(g, on_circle(angle));
    return smallest_hermitian(inverted ? ComplexMatrix(response.partialPivLu().inverse())
                                       : response);
  };
  return smallest(hermitian, grid).value;
}

}  // namespace

Premises positive_real_premises(const System& g, const Matrix& psi, double period_s) {
  Premises premises;
  premises.problem = malformed(g);
  if (premises.problem.empty()) premises.problem = malformed(psi, g.inputs(), "Psi");
  if (premises.problem.empty() && !(period_s > 0 && std::isfinite(period_s)))
    premises.problem = "the period must be positive";
  if (!premises.problem.empty()) return premises;
  const Rest still = rest(g);
  premises.problem = still.problem;
  if (!premises.problem.empty()) return premises;

  Dissipation& d = premises.inequality;
  const double rounding = 2 * std::numeric_limits<double>::epsilon();
  d.A = g.A;
  d.B = period_s * (g.B - still.x);
  d.error_B = period_s * (still.error_x + rounding * (g.B.cwiseAbs() + still.x.cwiseAbs()));
  d.S = 0.5 * g.C;
  d.R = period_s * (symmetric_part(g.D) - 0.5 * still.gain) + symmetric_part(psi);
  d.error_R = period_s * (0.5 * still.error_gain +
                          rounding * (g.D.cwiseAbs() + 0.5 * still.gain.cwiseAbs())) +
              rounding * psi.cwiseAbs();
  d.Y = Matrix(0, g.states());
  return premises;
}

Verdict proves_positive_real(const System& g, const Matrix& psi, const Matrix& P, double period_s) {
  const Premises premises = positive_real_premises(g, psi, period_s);
  if (!premises.problem.empty()) return {false, premises.problem, kNever};
  return proves(premises.inequality, P);
}

double positive_real_margin(const System& g, const Matrix& psi, double period_s) {
  const Premises premises = positive_real_premises(g, psi, period_s);
  if (!premises.problem.empty()) return malformed(g).empty() ? kNever : kUndefined;
  const Dissipation& d = premises.inequality;
  return input_level({d.A, d.B, 2 * d.S, d.R});
}

double input_level(const System& g) {
  return level(g, false);
}

double output_level(const System& g) {
  return level(g, true);
}

}  // namespace hapticd::check
