// A linkage as it really moves: joints with inertia, dampers, Coulomb friction and end stops, the
// masses between them, and a hand that holds the tip.
//
//   M(q) q'' = load(q, q') + efforts - b q' + friction + stops + J' F
//   F = u (f - k (u.(p - p0) - r(t))) - b_h p'
//
// (M and load: joint_mass.h; the hand's mass is in M.) Runge-Kutta of fourth order. A five-bar of
// the size of a hand that turns at 2 rad/s keeps its energy to 1e-9 a second with steps of 0.5 ms:
// two sub-steps at 1 kHz.
//
// Friction of a joint that slides is its Coulomb force, held; the step is cut where a joint comes
// to rest, so its work is never positive. A joint at rest for which less than the Coulomb force is
// enough does not move at all.
#pragma once
#include <array>
#include <optional>

#include "sim/end_stops.h"
#include "sim/joint_mass.h"
#include "sim/options.h"

namespace hapticd::sim {

/// What acts over one interval.
struct LinkageInput {
  Joints effort = Joints::Zero();  ///< N m or N, held
  double force_N = 0;              ///< of the script, held
  double rest_m = 0;               ///< of the hand's spring, when the interval begins
  double rest_rate_m_s = 0;        ///< held
};

class LinkagePlant {
 public:
  /// At rest where the options say; it has a pose there. Set-up only.
  explicit LinkagePlant(const DeviceOptions& options);

  void advance(double length_s, const LinkageInput& input) noexcept;
  void set_velocity(const Joints& qd) noexcept { motion_.qd = qd; }

  const Joints& q() const noexcept { return motion_.q; }
  const Joints& qd() const noexcept { return motion_.qd; }
  const Eigen::Vector3d& tip() const noexcept { return tip_; }
  /// From where the tip started, along the hand's direction.
  double displacement_m() const noexcept { return direction_.dot(tip_ - start_); }
  Eigen::Vector3d tip_velocity() noexcept;
  /// Kinetic, of the hand's spring at rest at `rest_m` and of the stops, and of height.
  double energy_J(double rest_m) noexcept;
  double effort_work_J(std::size_t joint) const noexcept { return effort_work_J_[joint]; }
  double hand_work_J() const noexcept { return script_work_J_ + motion_.rest_work_J; }
  double lost_J() const noexcept { return motion_.lost_J; }
  /// Of the hand on the tip, device frame: F - m_hand p'' while `input` acts.
  Eigen::Vector3d hand_force_N(const LinkageInput& input) noexcept;

 private:
  // What the integrator carries along; also its rate.
  struct Motion {
    Joints q = Joints::Zero();
    Joints qd = Joints::Zero();
    double rest_work_J = 0;
    double lost_J = 0;
    Motion plus(double share, const Motion& other) const noexcept;
  };
  struct Contact {
    Joints friction = Joints::Zero();      ///< held force on the joints that slide
    std::array<bool, kMaxJoints> stuck{};  ///< joints that friction does not let move
  };
  struct Reversal {
    int joint = -1;    ///< that comes to rest first; -1: none
    double share = 1;  ///< of the step, after which it does
  };
  static Joints solve(JointMatrix mass, Joints force, const Contact& contact) noexcept;
  Eigen::Vector3d held_force_N(const Motion& at, const LinkageInput& input,
                               double time_s) const noexcept;
  std::optional<Motion> rate(const Motion& at, const LinkageInput& input, double time_s,
                             const Contact& contact) noexcept;
  std::optional<Motion> step(const LinkageInput& input, double time_s, double length_s,
                             const Contact& contact) noexcept;
  Contact grip(const LinkageInput& input, double time_s) noexcept;
  void hold_resting(const Joints& acceleration, Contact& contact) noexcept;
  Reversal first_reversal(const Motion& next, const Contact& contact) const noexcept;
  void accept(const Motion& next, const LinkageInput& input) noexcept;
  void stop(int joint, Contact& contact) noexcept;
  void stop_dead() noexcept;

  JointMass mass_;
  int joints_;
  Joints damping_ = Joints::Zero();
  Joints coulomb_ = Joints::Zero();
  bool rubs_ = false;  ///< some joint has Coulomb friction
  std::array<EndStops, kMaxJoints> stops_;
  HandOptions hand_;
  Eigen::Vector3d direction_;
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d tip_ = Eigen::Vector3d::Zero();
  Motion motion_;
  JointDynamics here_;  ///< as last computed
  std::array<double, kMaxJoints> effort_work_J_{};
  double script_work_J_ = 0;
};

}  // namespace hapticd::sim
