// Axes as they really move while one linear hand holds them together:
//
//   x' = v,   M v' = u - b v - F,   xi' = A xi + B v,   F = C xi + D v
//
// M, b masses and dampers of the axes, u their motors' efforts. Between two changes of u (held) the
// solution is a matrix exponential of all axes and states together, so nothing is lost to
// integration whatever the interval and however stiff the hand.
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "sim/options.h"

namespace hapticd::sim {

/// How far (x, v, xi) move over one interval of fixed length per unit of (v, xi, u); made at
/// set-up, used in the loop.
struct SharedPropagator {
  double length_s = 0;
  Eigen::MatrixXd change;
};

class SharedPlant {
 public:
  /// `axes` move together; of the hand's, number j is axes[held[j]]. At rest but for the velocities
  /// that the hand names. Set-up only.
  SharedPlant(std::span<const AxisOptions> axes, const SharedHandOptions& hand,
              std::span<const std::size_t> held);

  /// For intervals of `length_s` > 0. Set-up only.
  SharedPropagator propagator(double length_s) const;

  void set_effort(std::size_t axis, double effort_N) noexcept {
    state_[at_effort(axis)] = effort_N;
  }
  /// Moves on by one interval.
  void advance(const SharedPropagator& propagator) noexcept;

  double position_m(std::size_t axis) const noexcept { return state_[index(axis)]; }
  double velocity_m_s(std::size_t axis) const noexcept { return state_[axes_ + index(axis)]; }
  double kinetic_J(std::size_t axis) const noexcept;
  /// Of the hand on the axis: -F.
  double hand_force_N(std::size_t axis) const noexcept;

 private:
  using Index = Eigen::Index;
  static Index index(std::size_t i) noexcept { return static_cast<Index>(i); }
  Index at_effort(std::size_t axis) const noexcept { return 2 * axes_ + states_ + index(axis); }
  Eigen::MatrixXd rates() const;

  Index axes_, states_;
  Eigen::VectorXd mass_kg_, damping_Ns_m_;
  Eigen::MatrixXd force_;   ///< F = force (v, xi) on every axis
  Eigen::MatrixXd memory_;  ///< xi' = memory (v, xi)
  Eigen::VectorXd state_;   ///< (x, v, xi, u)
  Eigen::VectorXd change_;  ///< of (x, v, xi) in the last interval
};

}  // namespace hapticd::sim
