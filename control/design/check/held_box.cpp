#include "control/design/check/held_box.h"

#include <cmath>
#include <vector>

namespace hapticd::check {
namespace {

using Jet4 = Jet<4>;
using Enclosure = std::array<Jet4, 8>;  ///< G, row by row
constexpr int kMostTerms = 100;

/// How much of p, p' and S is left out after `terms` terms, and the steps d in g, B, k, t by which
/// the arguments were enlarged for it.
struct Tail {
  int terms = 0;
  double p = 0, rate = 0, sum = 0;
  std::array<double, 4> step{};
};

/// sum over n >= first of x^n/n!.
double exponential_tail(double x, int first) {
  double term = 1;
  for (int n = 1; n <= first; ++n) term *= x / n;
  return 1.01 * term / (1 - x / (first + 1));
}

std::optional<Tail> tail_of(const HeldBox& cell, double period_s) {
  constexpr double kNegligible = 1e-18;
  const double g = cell[0].high, T = period_s;
  Tail tail;
  tail.step = {g, std::max(cell[1].high, 0.05 / (g * T)),
               std::max(cell[2].high, 0.05 / (g * T * T)), T};
  const double a = 2 * g * (cell[1].high + tail.step[1]), w = 2 * g * (cell[2].high + tail.step[2]);
  const double r = 1.01 * (0.5 * a + std::sqrt(0.25 * a * a + w)), x = 2 * r * T;
  if (!(x < 0.25 * kMostTerms)) return std::nullopt;
  for (int n = 4; n <= kMostTerms; ++n) {
    if (n <= x || !(exponential_tail(x, n - 1) < kNegligible)) continue;
    tail.terms = n;
    tail.rate = exponential_tail(x, n - 1);
    tail.p = exponential_tail(x, n) / r;
    tail.sum = exponential_tail(x, n + 1) / (r * r);
    return tail;
  }
  return std::nullopt;
}

Jet4 with_tail(Jet4 jet, double by, const Tail& tail) {
  const auto symmetric = [](double size) { return Interval(-size, size); };
  jet.value = jet.value + symmetric(by);
  for (std::size_t i = 0; i < 4; ++i) {
    jet.slope[i] = jet.slope[i] + symmetric(by / tail.step[i]);
    for (std::size_t j = 0; j <= i; ++j) {
      Interval& bend = jet.bend[Jet4::pair(i, j)];
      bend = bend + symmetric(2 * by / (tail.step[i] * tail.step[j]));
    }
  }
  return jet;
}

struct Sums {
  Jet4 p, rate, sum;
};

/// p, p' and S at h. The factors 1/n are rounded; operator* widens by more than that.
Sums sums(const std::vector<Jet4>& y, const Jet4& h, const Tail& tail) {
  const int last = tail.terms - 1;
  const auto at = [&](int n) { return y[static_cast<std::size_t>(n)]; };
  Jet4 p = at(last), sum = at(last), rate = at(last);
  for (int n = last - 1; n >= 1; --n) {
    p = at(n) + (1.0 / (n + 1)) * (h * p);
    sum = at(n) + (1.0 / (n + 2)) * (h * sum);
    rate = at(n) + (1.0 / n) * (h * rate);
  }
  return {with_tail(h * p, tail.p, tail), with_tail(rate, tail.rate, tail),
          with_tail(0.5 * (h * (h * sum)), tail.sum, tail)};
}

Enclosure enclosure(const HeldBox& box, double period_s, const Tail& tail) {
  const Jet4 g = Jet4::variable(box[0], 0), damping = Jet4::variable(box[1], 1);
  const Jet4 spring = Jet4::variable(box[2], 2), fraction = Jet4::variable(box[3], 3);
  const Jet4 a = g * damping, w = g * spring;
  std::vector<Jet4> y = {Jet4(0), Jet4(1)};
  for (int n = 2; n < tail.terms; ++n)
    y.push_back((-1.0) * (w * y[y.size() - 2] + a * y[y.size() - 1]));
  const Sums whole = sums(y, Jet4(period_s), tail);
  const Sums after = sums(y, Jet4(period_s) - fraction, tail);
  const Jet4 gamma_x = g * after.sum, gamma_v = g * after.p;
  return {Jet4(1) - w * whole.sum, whole.p,    g * whole.sum - gamma_x, gamma_x,
          (-1.0) * (w * whole.p),  whole.rate, g * whole.p - gamma_v,   gamma_v};
}

double middle(const Interval& range) {
  return 0.5 * (range.low + range.high);
}
/// Largest distance from the computed middle.
double radius(const Interval& range) {
  const double centre = middle(range);
  return std::max(range.high - centre, centre - range.low) * (1 + 1e-15);
}

}  // namespace

std::optional<HeldRange> held_range(const HeldBox& cell, double period_s) {
  constexpr double kCornerRounding = 1e-15;  // of the affine part's sum at a corner, relative
  const std::optional<Tail> tail = tail_of(cell, period_s);
  if (!tail) return std::nullopt;
  HeldBox centre;
  std::array<double, 4> half{};
  for (std::size_t i = 0; i < 4; ++i) {
    centre[i] = middle(cell[i]);
    half[i] = radius(cell[i]);
  }
  const Enclosure at_centre = enclosure(centre, period_s, *tail);
  const Enclosure over_cell = enclosure(cell, period_s, *tail);
  HeldRange range;
  for (std::size_t entry = 0; entry < 8; ++entry) {
    const auto row = static_cast<Eigen::Index>(entry / 4),
               column = static_cast<Eigen::Index>(entry % 4);
    const Jet4& c = at_centre[entry];
    range.centre(row, column) = middle(c.value);
    double rest = radius(c.value), size = std::abs(middle(c.value));
    for (std::size_t i = 0; i < 4; ++i) {
      const double spread = middle(c.slope[i]) * half[i];
      range.half[i](row, column) = spread;
      size += std::abs(spread);
      rest += radius(c.slope[i]) * half[i];
      double curved = 0;
      for (std::size_t j = 0; j < 4; ++j)
        curved += 0.5 * over_cell[entry].bend[Jet4::pair(i, j)].size() * half[i] * half[j];
      rest += curved;
    }
    range.remainder(row, column) = rest * (1 + kCornerRounding) + kCornerRounding * size;
  }
  if (!range.centre.allFinite() || !range.remainder.allFinite()) return std::nullopt;
  return range;
}

}  // namespace hapticd::check
