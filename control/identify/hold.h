// Holds an axis where it is, by a spring, a damper, and an integrator that takes its weight: what the
// others do while one is identified.
#pragma once
#include <array>
#include <cstddef>

namespace hapticd::identify {

struct HoldOptions {
  double mass = 0;    ///< kg or kg m^2; 0: not known, the hold is then soft
  double force = 0;   ///< N or N m, > 0: at most
  double travel = 0;  ///< m or rad, > 0: where a soft hold pulls with all of its force
};

class Hold {
 public:
  /// A known mass is held with a sixtieth of the rate as corner, so that a few ticks of latency do
  /// no harm; critically damped.
  Hold(const HoldOptions& options, double period_s) noexcept;

  /// The effort of this tick; without a fresh position that of the last one.
  double tick(double position, bool fresh) noexcept;
  /// Greatest distance from where it began, once its weight was found (after a second).
  double strayed() const noexcept { return strayed_; }

 private:
  double period_s_;
  double force_;
  double stiffness_ = 0;
  double damping_ = 0;
  std::array<double, 3> last_{};  ///< positions, newest first
  double middle_ = 0;
  double effort_ = 0;
  double weight_ = 0;
  double held_s_ = 0;
  double strayed_ = 0;
  bool started_ = false;
};

}  // namespace hapticd::identify
