#include "control/design/check/observer_level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hapticd::check {
namespace {

/// c0 + c1 u + c2 u^2.
using Quadratic = std::array<double, 3>;

/// Is it >= 0 on [low, high]? By Bernstein coefficients, halving where they do not tell.
bool is_nonnegative(const Quadratic& p, double low, double high, int halvings) {
  const auto at = [&](double u) { return p[0] + u * (p[1] + u * p[2]); };
  const double middle = p[0] + 0.5 * p[1] * (low + high) + p[2] * low * high;
  if (at(low) < 0 || at(high) < 0) return false;
  if (middle >= 0) return true;
  if (halvings == 0) return false;
  const double half = 0.5 * (low + high);
  return is_nonnegative(p, low, half, halvings - 1) && is_nonnegative(p, half, high, halvings - 1);
}

/// q1 q2 and T a1 a2 N.
struct Forms {
  Quadratic size, real;
};

Forms forms_of(const control::ObserverPlan& observer, double period_s) {
  const double c1 = 1 - observer.share, c2 = 1 - observer.second_share;
  const double i = observer.inertia, b = observer.damping;
  const double sum = c1 + c2, product = c1 * c2;
  // (i + b - i/z) (1/z - sum + product z): real parts of its powers of z are Chebyshev's 1, u, 2u^2-1.
  const double none = -(i + b) * sum - i * product;      // z^0
  const double one = (i + b) * (1 + product) + i * sum;  // z and 1/z
  const double two = -i;                                 // 1/z^2
  const double gain = period_s * observer.share * observer.second_share;
  const double p1 = 1 + c1 * c1, p2 = 1 + c2 * c2;
  return {.size = {p1 * p2, -2 * (c1 * p2 + c2 * p1), 4 * product},
          .real = {gain * (none - two), gain * one, gain * 2 * two}};
}

}  // namespace

bool leaves_no_level(const control::ObserverPlan& observer) {
  return observer.command_share != 0 || observer.hand_share != 0;
}

double observer_loss(const control::ObserverPlan& observer, double period_s) {
  constexpr int kHalvings = 40;
  const Forms forms = forms_of(observer, period_s);
  const auto holds = [&](double loss) {
    Quadratic p;
    for (std::size_t k = 0; k < p.size(); ++k) p[k] = loss * forms.size[k] + forms.real[k];
    return is_nonnegative(p, -1, 1, kHalvings);
  };
  if (holds(0)) return 0;
  double least = std::abs(period_s * (observer.inertia + observer.damping)) + 1e-12;
  int doublings = 0;
  while (!holds(least) && ++doublings < 200) least *= 2;
  if (!holds(least)) return std::numeric_limits<double>::infinity();
  double fails = 0;
  for (int step = 0; step < 60 && least - fails > 1e-9 * least; ++step) {
    const double middle = 0.5 * (fails + least);
    (holds(middle) ? least : fails) = middle;
  }
  return least * (1 + 1e-6);
}

}  // namespace hapticd::check
