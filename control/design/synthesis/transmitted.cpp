#include "control/design/synthesis/transmitted.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <vector>

#include "control/design/check/frequency.h"
#include "control/design/check/h_infinity.h"
#include "control/design/synthesis/frequency_integral.h"

namespace hapticd::synthesis {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// B_c, K and the hold as the loop has them.
struct Loop {
  Loop(const WallGoal& g, double meant)
      : goal(g), damper(meant + added_damper(g.hold, g.stiffness_N_m, g.period_s)) {}
  const WallGoal& goal;
  double damper;

  Complex hold(Complex s) const { return at(goal.hold, s, goal.period_s); }
  Complex characteristic(Complex s) const {
    return s * (goal.mass_kg * s + goal.damping_Ns_m) + hold(s) * (damper * s + goal.stiffness_N_m);
  }
  /// rad/s: beyond it the device's mass outweighs twice whatever the controller does.
  double fastest() const {
    const double m = goal.mass_kg;
    return (damper + std::sqrt(damper * damper + 2 * m * goal.stiffness_N_m)) / m;
  }
};

/// d(s) den(ZOH), ascending.
Vector characteristic(const Loop& loop, const Rational& hold) {
  const Eigen::Vector3d device(0, loop.goal.damping_Ns_m, loop.goal.mass_kg);
  const Eigen::Vector2d controller(loop.goal.stiffness_N_m, loop.damper);
  return plus(times(device, hold.den), times(controller, hold.num));
}

Vector differentiated(const Vector& polynomial) {
  return times(polynomial, Eigen::Vector2d(0, 1));
}

Rational compliance(const Loop& loop, const Rational& hold) {
  return {hold.den, characteristic(loop, hold)};
}

Rational wall_compliance(const WallGoal& goal) {
  return reduced({Vector::Ones(1), Eigen::Vector2d(goal.stiffness_N_m, goal.wall_damping_Ns_m)});
}

/// F = s w1.
Rational differentiated_weight(const WallGoal& goal) {
  return reduced({differentiated(goal.weight.num), goal.weight.den});
}

/// How far d(jw) turns from 0 to w, in steps small enough to be told.
double turned(const Loop& loop, double from, Complex d_from, double to, Complex d_to,
              int halvings) {
  constexpr double kClear = 0.5;  // rad
  const double step = std::arg(d_to / d_from);
  if (std::abs(step) < kClear) return step;
  if (halvings == 0) return std::nan("");  // a zero on the axis, or as good as one
  const double middle = 0.5 * (from + to);
  const Complex d = loop.characteristic({0, middle});
  return turned(loop, from, d_from, middle, d, halvings - 1) +
         turned(loop, middle, d, to, d_to, halvings - 1);
}

bool satisfies_mikhailov(const Loop& loop) {
  constexpr int kSteps = 400, kHalvings = 40;
  const double end = loop.fastest();
  double angle = 0, w = 0;
  Complex d = loop.characteristic(0);
  for (int i = 1; i <= kSteps; ++i) {
    const double next = end * i / kSteps;
    const Complex d_next = loop.characteristic({0, next});
    angle += turned(loop, w, d, next, d_next, kHalvings);
    w = next;
    d = d_next;
  }
  angle -= std::arg(-d);  // the rest of the way to -infinity
  return std::abs(angle - std::acos(-1.0)) < 1;
}

/// E and dE/dB_c as two outputs.
System error_system(const Loop& loop, const Rational& hold) {
  const System f = realised(differentiated_weight(loop.goal));
  const Rational x_t = compliance(loop, hold);
  const System device = realised(x_t);
  const System error = series(sum(realised(wall_compliance(loop.goal)), scaled(device, -1)), f);
  const System slope = series(device, series(realised({differentiated(hold.num), x_t.den}), f));
  const Matrix both = Matrix::Ones(2, 1);
  const System side = beside(error, slope);
  return {side.A, side.B * both, side.C, side.D * both};
}

TransparencyIndex by_lyapunov(const Loop& loop, const Rational& hold) {
  const System e = error_system(loop, hold);
  if (!(e.D.norm() <= 1e-12 * e.C.norm())) return {kInfinity, 0};
  const Matrix energy = output_energy(e);
  return {energy(0, 0), 2 * energy(0, 1)};
}

TransparencyIndex by_integral(const Loop& loop) {
  const WallGoal& goal = loop.goal;
  const Rational f = differentiated_weight(goal), wall = wall_compliance(goal);
  const System e = series(realised(wall), realised(f));
  if (e.D(0, 0) != 0) return {kInfinity, 0};
  const auto integrand = [&](double w) {
    const Complex s(0, w), hold = loop.hold(s), d = loop.characteristic(s), weight = at(f, s);
    // X_v - X_t over one denominator: both are 1/K at rest.
    const double B = goal.wall_damping_Ns_m, K = goal.stiffness_N_m;
    const Complex apart =
        s * (goal.mass_kg * s + goal.damping_Ns_m + loop.damper * hold - B) + K * (hold - 1.0);
    const Complex error = weight * apart / (d * (K + B * s));
    const Complex slope = weight * s * hold / (d * d);
    return Eigen::Vector2d(std::norm(error), 2 * std::real(std::conj(error) * slope));
  };
  const Eigen::Vector2d sums =
      integral_over_frequency(integrand, std::sqrt(goal.stiffness_N_m / goal.mass_kg)) /
      std::acos(-1.0);
  return {sums[0], sums[1]};
}

/// L, up to its sign.
Rational perturbed(const Loop& loop, const Rational& hold) {
  const WallGoal& g = loop.goal;
  const Eigen::Vector2d w(g.damping_uncertainty * g.damping_Ns_m, g.mass_uncertainty * g.mass_kg);
  return reduced({differentiated(times(w, hold.den)), characteristic(loop, hold)});
}

double swept_norm(const Loop& loop) {
  const WallGoal& g = loop.goal;
  const double unit = std::sqrt(g.stiffness_N_m / g.mass_kg);
  const auto size = [&](double angle) {
    const Complex s(0, unit * std::tan(0.5 * angle));
    const Complex w = g.mass_uncertainty * g.mass_kg * s + g.damping_uncertainty * g.damping_Ns_m;
    return std::abs(w * s / loop.characteristic(s));
  };
  std::vector<double> grid;
  constexpr int kPoints = 3000;
  for (int i = 0; i < kPoints; ++i) grid.push_back(std::acos(-1.0) * i / kPoints);
  return check::largest(size, grid).value;
}

}  // namespace

std::string malformed(const WallGoal& goal) {
  const auto is_size = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!(goal.mass_kg > 0) || !(goal.stiffness_N_m > 0) || !(goal.period_s > 0))
    return "mass, stiffness and period must be > 0";
  for (const double value :
       {goal.mass_kg, goal.damping_Ns_m, goal.stiffness_N_m, goal.period_s, goal.wall_damping_Ns_m,
        goal.mass_uncertainty, goal.damping_uncertainty, goal.hold.corner_rad_s})
    if (!is_size(value)) return "damping and uncertainties must be finite numbers >= 0";
  if (!(goal.hold.damping_ratio > 0)) return "the hold's damping ratio must be > 0";
  if (const std::string why = malformed(goal.weight); !why.empty()) return "w1: " + why;
  const Rational f = differentiated_weight(goal);
  if (!malformed(f).empty()) return "w1 must fall off at high frequency: J has no end";
  if (!(abscissa(realised(f)) < 0))
    return "w1 must be stable, but for one pole at s = 0: J has no end";
  return {};
}

Complex transmitted_admittance(const WallGoal& goal, double damper_Ns_m, Complex s) {
  return s / Loop(goal, damper_Ns_m).characteristic(s);
}

bool nominally_stable(const WallGoal& goal, double damper_Ns_m) {
  const Loop loop(goal, damper_Ns_m);
  const std::optional<Rational> hold = rational(goal.hold, goal.period_s);
  if (!hold) return satisfies_mikhailov(loop);
  return abscissa(realised(compliance(loop, *hold))) < 0;
}

TransparencyIndex transparency_index(const WallGoal& goal, double damper_Ns_m) {
  if (!malformed(goal).empty() || !nominally_stable(goal, damper_Ns_m)) return {kInfinity, 0};
  const Loop loop(goal, damper_Ns_m);
  const std::optional<Rational> hold = rational(goal.hold, goal.period_s);
  return hold ? by_lyapunov(loop, *hold) : by_integral(loop);
}

double perturbation_norm(const WallGoal& goal, double damper_Ns_m) {
  const Loop loop(goal, damper_Ns_m);
  const std::optional<Rational> hold = rational(goal.hold, goal.period_s);
  if (!hold || !nominally_stable(goal, damper_Ns_m)) return swept_norm(loop);
  return check::h_infinity(on_disc(realised(perturbed(loop, *hold)))).upper;
}

PaperAnswer paper_answer(const WallGoal& goal, double damper_Ns_m) {
  PaperAnswer answer;
  answer.index = transparency_index(goal, damper_Ns_m).value;
  answer.norm = perturbation_norm(goal, damper_Ns_m);
  answer.stable = nominally_stable(goal, damper_Ns_m);
  answer.robust = answer.stable && answer.norm <= 1;
  return answer;
}

}  // namespace hapticd::synthesis
