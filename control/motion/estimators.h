// Velocity estimators other than the backward difference, which sense() takes by itself. Each kind
// is one packed array of the plan; an axis is in at most one of them.
//
// Every estimator starts anew (qd = 0) in a tick that took no difference (Motion::reseeded), and
// keeps what it has while the sample is held (Motion::held). Errors and delays of each:
// control/motion/README.md.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "control/core/capacity.h"

namespace hapticd::control {

struct Plan;
struct State;

/// First-order low-pass behind the backward difference: y += a (v - y).
struct LowPassPlan {
  std::uint16_t axis = 0;
  double share = 1;  ///< a = 1 - exp(-2 pi f_c T), in (0, 1]
};
struct LowPassState {
  double velocity = 0;
};

/// Least squares polynomial over the last `window` positions, its slope at the newest one
/// (Savitzky-Golay at the end of the window): qd_k = sum_i weights[i] (q_{k-i} - q_k).
/// While fewer samples are known the oldest stands for those before it.
///
///   degree 1:  weights[i] = 12 ((N-1)/2 - i) / (T N (N^2-1))
struct LeastSquaresPlan {
  std::uint16_t axis = 0;
  std::uint16_t window = 0;                  ///< degree + 1 to kMaxWindow samples
  std::array<double, kMaxWindow> weights{};  ///< 1/s, newest first
};

/// First-order adaptive windowing, end-fit (Janabi-Sharifi, Hayward, Chen 2000): the window grows
/// backwards as long as the line between its ends passes within `noise` of every position in it;
/// qd is the slope of the longest.
struct FoawPlan {
  std::uint16_t axis = 0;
  std::uint16_t window = 0;  ///< samples at most, 2 to kMaxWindow
  double noise = 0;          ///< m or rad, > 0: half-width of the band; one encoder count
};

/// The last positions of an axis. A ring that is written twice, so that the newest kMaxWindow are
/// always one run, newest first, whatever window a plan looks at.
struct WindowState {
  std::array<double, 2 * kMaxWindow> ring{};
  std::uint16_t head = 0;   ///< where the newest is, below kMaxWindow
  std::uint16_t known = 0;  ///< positions since the start without a gap, up to kMaxWindow

  const double* newest() const noexcept { return ring.data() + head; }
};

/// Third-order tracking filter with all poles at r = exp(-w T): position, velocity, acceleration
/// are predicted by constant acceleration and corrected by shares of what the position was off.
/// Gains 1 - r^3, 1.5 (1-r)^2 (1+r) / T, (1-r)^3 / T^2 (the last on x'' itself).
struct AlphaBetaGammaPlan {
  std::uint16_t axis = 0;
  double alpha = 0;  ///< 1
  double beta = 0;   ///< 1/s
  double gamma = 0;  ///< 1/s^2
};
struct AlphaBetaGammaState {
  double q = 0, qd = 0, qdd = 0;
};

/// Overwrites state.qd of the axes that have an estimator of their own.
void estimate_velocity(const Plan& plan, State& state) noexcept;

}  // namespace hapticd::control
