// All that the loop changes, sized by the plan and preallocated by build::Program.
#pragma once
#include <cstdint>
#include <span>

#include "control/core/fault.h"
#include "control/core/motion.h"
#include "control/guard/ledger.h"
#include "control/guard/passivity_controller.h"
#include "control/kinematics/kinematics.h"
#include "control/motion/estimators.h"
#include "control/motion/homing.h"
#include "control/observer/observer.h"
#include "control/scene/encounter.h"

namespace hapticd::control {

/// Whether forces are on. Non-zero force only in `enabled`, where it fades in and out by the ramp,
/// and, bounded by the search's own limits, in `homing`.
enum class Mode : std::uint8_t { idle = 0, enabled = 1, fault = 2, homing = 3 };

struct AxisState {
  double raw = 0;                 ///< last raw value
  double unwrapped = 0;           ///< raw value counted on over every wrap
  double counts = 0;              ///< what this tick added to it
  double zero = 0;                ///< m or rad: added to q since the axis was homed
  std::uint32_t stale_ticks = 0;  ///< ticks since the last fresh sample
  std::uint32_t still_ticks = 0;  ///< ticks under force without any change of `raw` (stuck watch)
  bool seeded = false;            ///< a fresh value was seen: q is known, up to homing
  bool homed = false;             ///< q is absolute
  Motion motion = Motion::reseeded;
};

struct State {
  std::span<AxisState> axes;
  std::span<LedgerState> ledger;   ///< per axis
  std::span<HomingState> homings;  ///< beside the plan's arrays, entry by entry
  std::span<LowPassState> low_passes;
  std::span<WindowState> least_squares;
  std::span<WindowState> foaws;
  std::span<AlphaBetaGammaState> alpha_beta_gammas;
  std::span<LinkageState> linkages;
  std::span<ObserverState> axis_observers;
  std::span<ObserverState> contact_observers;
  std::span<PassivityState> passivity_controllers;
  std::span<double> heat;      ///< 0 to 1, beside plan.thermals
  std::span<double> jacobian;  ///< m or m/rad; Linkage::jacobian says where each begins

  std::span<EncounterState> encounters;  ///< beside plan.encounters
  std::span<MeshWalk> walks;             ///< of meshes; Encounter::walk
  std::span<std::uint32_t> segments;     ///< of curves; Encounter::walk
  std::span<ContactState> contacts;      ///< beside plan.contacts
  std::span<Member> members;             ///< beside plan.group_contacts; of this tick only
  std::span<std::uint32_t> near;         ///< encounters, from ContactPlan::first_encounter on
  std::span<double> coupling_memory;     ///< GroupPlan::first_memory
  std::span<double> network;             ///< GroupPlan::first_state
  double scene_time_s = 0;  ///< of this tick, since the loop started: where moving objects are
  double scene_last_s = 0;  ///< of the last tick

  // Everything recorded is one block, in the order of control/recorded.h: a record copies it whole.
  // A span whose work the plan does not name is empty.
  std::span<double> q;            ///< m or rad, per axis
  std::span<double> qd;           ///< m/s or rad/s, per axis
  std::span<double> gravity;      ///< N or N m, per axis: compensation, before ramp and fade
  std::span<double> friction;     ///< N or N m, per axis: compensation, before ramp and fade
  std::span<double> observer;     ///< N or N m, per axis: of axis observers, before ramp and fade
  std::span<double> residual;     ///< N or N m, per axis: of axis observers, before Q
  std::span<double> travel;       ///< N or N m, per axis: springs at the ends of the travel
  std::span<double> effort;       ///< N or N m, per axis: what is asked of the device
  std::span<double> x;            ///< m, contact coordinates
  std::span<double> hand_force;   ///< N, contact coordinates: of the hand, measured
  std::span<double> proxy;        ///< m, contact coordinates: y of the coupling, else x
  std::span<double> scene_force;  ///< N on the contacts, before any guard
  std::span<double> observer_force;    ///< N, of contact observers, before ramp and fade
  std::span<double> contact_residual;  ///< N, of contact observers, before Q
  std::span<double> limited;           ///< N: scene_force less what the guard let through
  std::span<double> force;             ///< N on the contacts, after the guard
  std::span<double> solve_error;       ///< N, per device: force that the last sweep still moved
  std::span<double> injected;          ///< J, per device: what moving and swinging objects gave
  std::span<double> work;              ///< J, per device: done by its motors since the start
  std::span<double> reserve;           ///< J, per device: of its passivity controller
  std::span<double> gain;              ///< 0 to 1, per device: of its passivity controller
  std::span<double> fade;  ///< 0 to 1, per device: what takes force out at once, of all reasons
  std::span<const double> recorded;

  std::span<double> v;  ///< m/s, contact coordinates
  /// N, contact coordinates: after the limits, before the fade; the slew limit starts from it.
  std::span<double> slewed;
  /// N, contact coordinates: contact force that was delivered; filled for contact observers.
  std::span<double> contact_delivered;
  /// N or N m, per axis: gravity, friction and travel in the last effort.
  std::span<double> feedforward;
  /// N or N m, per axis: all in the last effort that is not the contact force.
  std::span<double> beside;
  std::span<double> reach;  ///< 0 to 1, per device: 1 well inside the workspace (forward())
  std::span<double> ramp;   ///< 0 to 1, per device: share of the force that is let through
  Mode mode = Mode::idle;
  bool adopted = false;  ///< first tick after carry_over()
  FaultReport fault;
};

}  // namespace hapticd::control
