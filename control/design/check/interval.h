// Intervals, and functions of a few variables with slope and curvature over a box (second-order
// jets): what a proof over all poses of a linkage is computed with.
//
// Every operation widens its result by a few units in the last place, so that what is computed
// encloses what is meant. Outside the domain of a root or a division bounds are infinite, never
// wrong.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace hapticd::check {

struct Interval {
  double low = 0, high = 0;
  Interval() = default;
  Interval(double value) : low(value), high(value) {}
  Interval(double l, double h) : low(l), high(h) {}
  double size() const { return std::max(std::abs(low), std::abs(high)); }
};

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();
inline const Interval kAnything(-kInfinite, kInfinite);

/// A little wider than it was computed; what is no number is anything.
inline Interval widened(double low, double high) {
  constexpr double kUlps = 4 * std::numeric_limits<double>::epsilon();
  constexpr double kTiny = 1e-300;
  if (!(low <= high)) return kAnything;
  return {low - kUlps * std::abs(low) - kTiny, high + kUlps * std::abs(high) + kTiny};
}

inline Interval operator+(Interval a, Interval b) {
  return widened(a.low + b.low, a.high + b.high);
}
inline Interval operator-(Interval a) {
  return {-a.high, -a.low};
}
inline Interval operator-(Interval a, Interval b) {
  return a + (-b);
}
inline Interval operator*(Interval a, Interval b) {
  const std::array<double, 4> p = {a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high};
  for (const double value : p)
    if (std::isnan(value)) return kAnything;
  return widened(std::min({p[0], p[1], p[2], p[3]}), std::max({p[0], p[1], p[2], p[3]}));
}
inline Interval inverse(Interval a) {
  if (!(a.low > 0) && !(a.high < 0)) return kAnything;
  return widened(1 / a.high, 1 / a.low);
}
inline Interval square(Interval a) {
  const double most = a.size();
  const double least = a.low > 0 ? a.low : a.high < 0 ? -a.high : 0;
  return widened(least * least, most * most);
}
/// Of what is positive in it.
inline Interval root(Interval a) {
  if (!(a.high >= 0)) return kAnything;
  return widened(std::sqrt(std::max(0.0, a.low)), std::sqrt(a.high));
}

/// Value, gradient and second derivative of a function of N variables over a box.
template <std::size_t N>
struct Jet {
  static constexpr std::size_t kPairs = N * (N + 1) / 2;
  Interval value;
  std::array<Interval, N> slope{};
  std::array<Interval, kPairs> bend{};  ///< (0,0), (1,0), (1,1), (2,0), ...

  Jet() = default;
  Jet(double constant) : value(constant) {}
  static Jet variable(Interval range, std::size_t index) {
    Jet made;
    made.value = range;
    made.slope[index] = 1;
    return made;
  }
  static constexpr std::size_t pair(std::size_t i, std::size_t j) {
    return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
  }
};

template <std::size_t N>
Jet<N> operator+(const Jet<N>& a, const Jet<N>& b) {
  Jet<N> sum;
  sum.value = a.value + b.value;
  for (std::size_t i = 0; i < N; ++i) sum.slope[i] = a.slope[i] + b.slope[i];
  for (std::size_t k = 0; k < Jet<N>::kPairs; ++k) sum.bend[k] = a.bend[k] + b.bend[k];
  return sum;
}

template <std::size_t N>
Jet<N> operator*(double factor, const Jet<N>& a) {
  Jet<N> scaled;
  scaled.value = Interval(factor) * a.value;
  for (std::size_t i = 0; i < N; ++i) scaled.slope[i] = Interval(factor) * a.slope[i];
  for (std::size_t k = 0; k < Jet<N>::kPairs; ++k) scaled.bend[k] = Interval(factor) * a.bend[k];
  return scaled;
}

template <std::size_t N>
Jet<N> operator-(const Jet<N>& a, const Jet<N>& b) {
  return a + (-1.0) * b;
}

/// f(a), by f and its first two derivatives over the range of a.
template <std::size_t N>
Jet<N> chain(const Jet<N>& a, Interval f, Interval f1, Interval f2) {
  Jet<N> out;
  out.value = f;
  for (std::size_t i = 0; i < N; ++i) out.slope[i] = f1 * a.slope[i];
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const std::size_t k = Jet<N>::pair(i, j);
      const Interval both = i == j ? square(a.slope[i]) : a.slope[i] * a.slope[j];
      out.bend[k] = f1 * a.bend[k] + f2 * both;
    }
  }
  return out;
}

template <std::size_t N>
Jet<N> square(const Jet<N>& a) {
  return chain(a, square(a.value), Interval(2) * a.value, Interval(2));
}

template <std::size_t N>
Jet<N> inverse(const Jet<N>& a) {
  const Interval f = inverse(a.value), f1 = -square(f);
  return chain(a, f, f1, Interval(-2) * f1 * f);
}

template <std::size_t N>
Jet<N> root(const Jet<N>& a) {
  const Interval f = root(a.value), f1 = inverse(Interval(2) * f);
  return chain(a, f, f1, -(f1 * inverse(Interval(2) * a.value)));
}

template <std::size_t N>
Jet<N> operator*(const Jet<N>& a, const Jet<N>& b) {
  Jet<N> out;
  out.value = a.value * b.value;
  for (std::size_t i = 0; i < N; ++i) out.slope[i] = a.value * b.slope[i] + a.slope[i] * b.value;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const std::size_t k = Jet<N>::pair(i, j);
      out.bend[k] = a.value * b.bend[k] + a.bend[k] * b.value + a.slope[i] * b.slope[j] +
                    a.slope[j] * b.slope[i];
    }
  }
  return out;
}

/// arccos a; slope and bend are infinite where a reaches 1. Its value is of no use to anybody and
/// left out.
template <std::size_t N>
Jet<N> arc_cosine(const Jet<N>& a) {
  const Interval rest = Interval(1) - square(a.value);
  const Interval f1 = rest.low > 0 ? -inverse(root(rest)) : kAnything;
  const Interval f2 = rest.low > 0 ? a.value * f1 * inverse(rest) : kAnything;
  return chain(a, kAnything, f1, f2);
}

/// The direction of (x, y), value left out:
///   grad = (x grad y - y grad x) / r^2, whose gradient follows by the quotient rule,
///   f_x = -y/r^2, f_y = x/r^2, f_xx = -f_yy = 2 x y / r^4, f_xy = (y^2 - x^2) / r^4
template <std::size_t N>
Jet<N> direction(const Jet<N>& y, const Jet<N>& x) {
  const Interval over = inverse(square(x.value) + square(y.value));
  const Interval fx = -(y.value * over), fy = x.value * over;
  const Interval fxx = Interval(-2) * fx * fy, fxy = square(fx) - square(fy);
  Jet<N> out;
  out.value = kAnything;
  for (std::size_t i = 0; i < N; ++i) out.slope[i] = fx * x.slope[i] + fy * y.slope[i];
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const std::size_t k = Jet<N>::pair(i, j);
      const Interval xx = x.slope[i] * x.slope[j], yy = y.slope[i] * y.slope[j];
      const Interval xy = x.slope[i] * y.slope[j] + x.slope[j] * y.slope[i];
      out.bend[k] = fx * x.bend[k] + fy * y.bend[k] + fxx * (xx - yy) + fxy * xy;
    }
  }
  return out;
}

}  // namespace hapticd::check
