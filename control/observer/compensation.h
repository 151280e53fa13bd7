// Efforts that make a device feel lighter than it is: gravity, friction, observers.
// All are joint efforts beside the contact force; each is bounded, and the guard ramps and fades
// them. Contact-space observers act through J'.
#pragma once
#include <array>
#include <cstdint>

#include "control/core/capacity.h"
#include "control/core/findings.h"

namespace hapticd::control {

struct Plan;
struct State;
struct TickInput;

/// Constant and pendulum part of an axis' weight: effort = constant + swing cos(q + phase).
/// Weight of serial links and of the tip's mass comes from the kinematics.
struct GravityAxis {
  std::uint16_t axis = 0;
  double constant = 0;  ///< N or N m
  double swing = 0;     ///< N m
  double phase = 0;     ///< rad
};

/// A mass at the contact: tau = J' (m g up).
struct GravityTip {
  std::uint16_t device = 0;
  std::array<double, kMaxContactCoordinates> weight{};  ///< N on the contact's coordinates, upwards
};

/// effort = viscous qd + coulomb clamp(qd / smooth, -1, 1). The share that is compensated is in the
/// figures already. Its slope at rest, viscous + coulomb / smooth, is held below the device's own
/// damping by config/compile, so that rest stays stable and no limit cycle can start.
struct FrictionAxis {
  std::uint16_t axis = 0;
  double viscous = 0;  ///< N s/m or N m s/rad
  double coulomb = 0;  ///< N or N m
  double smooth = 1;   ///< m/s or rad/s, > 0
};

/// Channels of Aux::analogue that measure the hand's force, device frame [N].
struct ForceSensor {
  std::uint16_t device = 0;
  std::uint16_t channels = 0;  ///< 1 to 3: the first ones
  std::array<std::array<double, 3>, kMaxContactCoordinates>
      turn{};  ///< contact coordinates x channels
};

/// state.hand_force, gravity, friction, observer, observer_force from this tick's motion. Sets
/// Limit::compensation where an observer is at its bound.
void compensate(const Plan& plan, State& state, const TickInput& input,
                Findings& findings) noexcept;

}  // namespace hapticd::control
