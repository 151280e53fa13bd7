#include "control/build/filters.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticd::build {

double low_pass_share(double cutoff_Hz, double period_s) noexcept {
  return -std::expm1(-2 * std::numbers::pi * cutoff_Hz * period_s);
}

control::LowPassPlan low_pass(std::uint16_t axis, double cutoff_Hz, double period_s) noexcept {
  return {.axis = axis, .share = low_pass_share(cutoff_Hz, period_s)};
}

// With V_ij = s_i^j the fit's coefficients are c = V^+ q. Times run from 0 (newest) to s = -1, so
// that V is as well conditioned as monomials allow; the slope there is c_1, and ds/dt = 1 / span.
control::LeastSquaresPlan least_squares(std::uint16_t axis, std::uint16_t window,
                                        std::uint16_t degree, double period_s) {
  const double span = window - 1;
  Eigen::MatrixXd powers(window, degree + 1);
  for (int i = 0; i < window; ++i) {
    powers(i, 0) = 1;
    for (int j = 1; j <= degree; ++j) powers(i, j) = powers(i, j - 1) * (-i / span);
  }
  const Eigen::MatrixXd fit =
      powers.householderQr().solve(Eigen::MatrixXd::Identity(window, window));
  control::LeastSquaresPlan plan{.axis = axis, .window = window};
  for (int i = 0; i < window; ++i)
    plan.weights[static_cast<std::size_t>(i)] = fit(1, i) / (span * period_s);
  return plan;
}

control::FoawPlan foaw(std::uint16_t axis, std::uint16_t window, double noise) noexcept {
  return {.axis = axis, .window = window, .noise = noise * (1 + 1e-9)};
}

control::AlphaBetaGammaPlan alpha_beta_gamma(std::uint16_t axis, double bandwidth_rad_s,
                                             double period_s) noexcept {
  const double r = std::exp(-bandwidth_rad_s * period_s);
  const double away = -std::expm1(-bandwidth_rad_s * period_s);  // 1 - r
  return {.axis = axis,
          .alpha = 1 - r * r * r,
          .beta = 1.5 * away * away * (1 + r) / period_s,
          .gamma = away * away * away / (period_s * period_s)};
}

control::ObserverPlan observer(std::uint16_t source, std::uint16_t device,
                               const ObserverFigures& figures, double period_s) noexcept {
  const bool model = figures.mode == ObserverMode::model;
  const double mass = figures.nominal_mass_kg - (model ? figures.mass_kg : 0);
  const double damping = figures.nominal_damping_Ns_m - (model ? figures.damping_Ns_m : 0);
  const double share = low_pass_share(figures.cutoff_Hz, period_s);
  return {.source = source,
          .device = device,
          .inertia = mass / (period_s * period_s),
          .damping = damping / period_s,
          .command_share = model ? 0.0 : 1.0,
          .hand_share = figures.mode == ObserverMode::sensor ? 1.0 : 0.0,
          .share = share,
          .second_share = figures.order == 1 ? 1.0 : share,
          .max_output = figures.max_output,
          .blend_per_tick = figures.blend_s > period_s ? period_s / figures.blend_s : 1.0,
          .extra_delay = figures.delay_ticks};
}

}  // namespace hapticd::build
