// What the other joints of a linkage take of the motion of the one that is identified, as damping of that one. Held
// joints give way a little; their holds have dampers, and they have friction of their own. Over a window of periodic
// motion the energy is the same at both ends, so that the work of the efforts is
//
//   sum tau qd = b sum qd^2 + c sum |qd| + [b_j sum qd_j^2 + c_j sum |qd_j| - sum tau_j qd_j],
//
// and a fit of the one joint counts the bracket as its own friction: at most bracket / sum qd^2 too much damping.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace hapticd::identify {

class HeldLoss {
 public:
  /// `axis`: the one that is identified; the others are held.
  HeldLoss(std::size_t axes, std::size_t axis, double period_s);

  /// Positions (m or rad) and efforts (N or N m) of all axes in one tick.
  void tick(std::span<const double> positions, std::span<const double> efforts);

  /// Damping, in the units of the axis, of the worst window that moved it. `viscous`, `coulomb`: friction that the
  /// held joints are taken to have, each.
  double most(double viscous, double coulomb) const;

 private:
  static constexpr std::size_t kSpan = 5;  // ticks of a velocity
  struct Window {
    double moved = 0;  ///< sum qd^2 of the axis
    double work = 0;   ///< -sum tau_j qd_j
    double held = 0;   ///< sum qd_j^2
    double slid = 0;   ///< sum |qd_j|
  };
  struct Sample {
    std::vector<double> position, effort;
  };

  std::size_t axis_;
  double period_s_;
  std::size_t ticks_ = 0, in_window_ = 0;
  std::array<Sample, kSpan> samples_;  // ring, by tick
  std::vector<Window> windows_;
};

}  // namespace hapticd::identify
