// What a period does to a held device, for a whole box of devices and latencies at once:
//
//   (x, v)' = G (x, v, u before, u after),  G = [Phi(T), Gamma(T) - Gamma(T - t), Gamma(T - t)]
//
// (Phi(T - t) Gamma(t) = Gamma(T) - Gamma(T - t): a command that does not change.) With g = 1/M, a = g B,
// w = g k everything is one series: Y_0 = 0, Y_1 = 1, Y_{n+2} = -w Y_n - a Y_{n+1},
//
//   p(h) = sum Y_n h^n/n!,  S = integral of p,  Gamma(h) = g (S, p),
//   Phi(h) = [1 - w S, p ; -w p, p'].
//
// G is enclosed over a cell of (g, B, k, t) by its value and slopes at the centre and its second
// derivatives over the cell (interval.h): the affine part, whose values are the hull of those at the
// cell's corners, and a remainder in every entry.
//
// What the series leaves out after N terms. |Y_n| is at most the same polynomial with all signs
// positive, and that at most r^(n-1) where r^2 = a r + w. A power series f with coefficients >= 0 in p >=
// 0 has f_i(p) <= f(p + d)/d_i and f_ij(p) <= 2 f(p + d)/(d_i d_j), all terms of its Taylor series
// being >= 0: so the tail at enlarged arguments bounds its derivatives, too.
#pragma once
#include <array>
#include <optional>

#include "control/design/check/interval.h"
#include "control/design/check/linear.h"

namespace hapticd::check {

/// A box of (1/M, B, k, t): 1/kg, N s/m, N/m, s.
using HeldBox = std::array<Interval, 4>;

struct HeldRange {
  using Gains = Eigen::Matrix<double, 2, 4>;
  Gains centre;
  std::array<Gains, 4> half;  ///< affine part: slope times half the cell's side
  Gains remainder;            ///< bound of the rest, entry by entry
};

/// Nothing where the device is too fast between two ticks for the series, and where an entry is not
/// finite. 0 < g, 0 <= t <= T.
std::optional<HeldRange> held_range(const HeldBox& cell, double period_s);

}  // namespace hapticd::check
