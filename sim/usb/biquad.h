// Low pass of second order at a fixed rate, transposed direct form II.
// Bilinear transform of 1 / (s^2 + s/Q + 1): K = tan(pi f/rate).
#pragma once
#include <cmath>
#include <numbers>

namespace hapticd::sim::usb {

class Biquad {
 public:
  Biquad() = default;  ///< lets all pass
  /// `frequency`: of the rate, < 0.5.
  Biquad(double frequency, double q) {
    const double k = std::tan(std::numbers::pi * frequency), all = 1 + k / q + k * k;
    a0_ = k * k / all;
    a1_ = 2 * a0_;
    a2_ = a0_;
    b1_ = 2 * (k * k - 1) / all;
    b2_ = (1 - k / q + k * k) / all;
  }

  double operator()(double in) {
    const double out = in * a0_ + z1_;
    z1_ = in * a1_ + z2_ - b1_ * out;
    z2_ = in * a2_ - b2_ * out;
    return out;
  }

 private:
  double a0_ = 1, a1_ = 0, a2_ = 0, b1_ = 0, b2_ = 0, z1_ = 0, z2_ = 0;
};

}  // namespace hapticd::sim::usb
