#include "control/motion/estimators.h"

#include <algorithm>
#include <cmath>

#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {
namespace {

static_assert((kMaxWindow & (kMaxWindow - 1)) == 0, "the ring's index wraps by a mask");
static_assert(kMaxWindow % 4 == 0, "the least squares sum takes four positions at a time");

/// 1 / i: the line through positions i ticks apart has a slope without a division.
constexpr auto kReciprocal = [] {
  std::array<double, kMaxWindow> table{};
  for (std::size_t i = 1; i < kMaxWindow; ++i) table[i] = 1.0 / static_cast<double>(i);
  return table;
}();

void fill_window(WindowState& state, double q) noexcept {
  state.ring.fill(q);
  state.known = 1;
}

void push(WindowState& state, double q) noexcept {
  state.head = static_cast<std::uint16_t>((state.head + kMaxWindow - 1) & (kMaxWindow - 1));
  state.ring[state.head] = state.ring[state.head + kMaxWindow] = q;
  state.known =
      std::min(static_cast<std::uint16_t>(state.known + 1), static_cast<std::uint16_t>(kMaxWindow));
}

/// Weights beyond the window are zero, so the sum may run on to the next multiple of four. Four
/// partial sums: one would be a chain of additions that each wait for the last.
double weighted_slope(const LeastSquaresPlan& plan, const WindowState& state) noexcept {
  const double* q = state.newest();
  const double* w = plan.weights.data();
  double sum[4] = {};
  for (std::size_t i = 0; i < plan.window; i += 4) {
    for (std::size_t j = 0; j < 4; ++j) sum[j] += w[i + j] * (q[i + j] - q[0]);
  }
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/// m or rad per tick. The line from the newest position through that of n ticks ago has the slope
/// d_n / n, d_i = q_0 - q_i, and passes within noise of q_i if (d_i - noise)/i <= slope <=
/// (d_i + noise)/i: one interval of slopes for all positions between, which only shrinks as n
/// grows.
double end_fit_slope(const FoawPlan& plan, const WindowState& state) noexcept {
  const double* q = state.newest();
  const std::size_t size = std::min(plan.window, state.known);
  double slope = 0, low = -HUGE_VAL, high = HUGE_VAL;
  for (std::size_t n = 1; n < size; ++n) {
    const double moved = q[0] - q[n];
    const double candidate = moved * kReciprocal[n];
    if (!(low <= candidate && candidate <= high)) break;
    slope = candidate;
    low = std::max(low, (moved - plan.noise) * kReciprocal[n]);
    high = std::min(high, (moved + plan.noise) * kReciprocal[n]);
  }
  return slope;
}

double track(const AlphaBetaGammaPlan& plan, AlphaBetaGammaState& state, double q,
             double period_s) noexcept {
  const double gained = period_s * state.qdd;
  const double predicted_q = state.q + period_s * (state.qd + 0.5 * gained);
  const double off = q - predicted_q;
  state.q = predicted_q + plan.alpha * off;
  state.qd = state.qd + gained + plan.beta * off;
  state.qdd += plan.gamma * off;
  return state.qd;
}

/// What every estimator does in the three kinds of tick; `start` and `advance` are its own.
template <class Start, class Advance>
void estimate_axis(Motion motion, double& qd, Start start, Advance advance) noexcept {
  if (motion == Motion::advanced) {
    qd = advance();
  } else if (motion == Motion::reseeded) {
    start();
    qd = 0;
  }
}

void filter_differences(const Plan& plan, State& state) noexcept {
  for (std::size_t i = 0; i < plan.low_passes.size(); ++i) {
    const LowPassPlan& filter = plan.low_passes[i];
    double& y = state.low_passes[i].velocity;
    double& qd = state.qd[filter.axis];
    estimate_axis(
        state.axes[filter.axis].motion, qd, [&] { y = 0; },
        [&] { return y += filter.share * (qd - y); });
  }
}

void fit_polynomials(const Plan& plan, State& state) noexcept {
  for (std::size_t i = 0; i < plan.least_squares.size(); ++i) {
    const LeastSquaresPlan& fit = plan.least_squares[i];
    WindowState& window = state.least_squares[i];
    const double q = state.q[fit.axis];
    estimate_axis(
        state.axes[fit.axis].motion, state.qd[fit.axis], [&] { fill_window(window, q); },
        [&] {
          push(window, q);
          return weighted_slope(fit, window);
        });
  }
}

void fit_ends(const Plan& plan, State& state) noexcept {
  for (std::size_t i = 0; i < plan.foaws.size(); ++i) {
    const FoawPlan& fit = plan.foaws[i];
    WindowState& window = state.foaws[i];
    const double q = state.q[fit.axis];
    estimate_axis(
        state.axes[fit.axis].motion, state.qd[fit.axis], [&] { fill_window(window, q); },
        [&] {
          push(window, q);
          return end_fit_slope(fit, window) * plan.rate_Hz;
        });
  }
}

void track_positions(const Plan& plan, State& state) noexcept {
  for (std::size_t i = 0; i < plan.alpha_beta_gammas.size(); ++i) {
    const AlphaBetaGammaPlan& gains = plan.alpha_beta_gammas[i];
    AlphaBetaGammaState& tracked = state.alpha_beta_gammas[i];
    const double q = state.q[gains.axis];
    estimate_axis(
        state.axes[gains.axis].motion, state.qd[gains.axis], [&] { tracked = {.q = q}; },
        [&] { return track(gains, tracked, q, plan.period_s); });
  }
}

}  // namespace

void estimate_velocity(const Plan& plan, State& state) noexcept {
  filter_differences(plan, state);
  fit_polynomials(plan, state);
  fit_ends(plan, state);
  track_positions(plan, state);
}

}  // namespace hapticd::control
