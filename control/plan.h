// The plan: the immutable, preallocated result of compiling a config. It is all that the loop
// reads.
//
// Every kind of work is one packed array; what a scene does not name is an empty array. Spans point
// into the storage of build::Program, which outlives the plan's use by the servo thread.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "control/core/capacity.h"
#include "control/coupling/group.h"
#include "control/guard/bound.h"
#include "control/guard/limits.h"
#include "control/guard/passivity_controller.h"
#include "control/kinematics/kinematics.h"
#include "control/motion/estimators.h"
#include "control/motion/homing.h"
#include "control/observer/compensation.h"
#include "control/observer/observer.h"
#include "control/record_layout.h"
#include "control/scene/encounter.h"
#include "control/scene/fields.h"
#include "control/scene/mesh.h"
#include "control/scene/path.h"
#include "control/scene/plane.h"
#include "control/scene/shapes.h"

namespace hapticd::control {

/// One axis: from the device's raw value to q (m or rad), and what its actuator may get.
struct AxisPlan {
  double unit_per_raw = 1;  ///< m or rad per raw unit, sign included
  double offset = 0;        ///< q = unit_per_raw * (unwrapped raw) + offset [m or rad]
  double modulus_raw = 0;   ///< raw values wrap at this; 0: they do not wrap
  double max_effort = 0;    ///< N or N m, > 0: what the actuator can deliver
  double max_velocity = 0;  ///< m/s or rad/s, > 0: beyond it a fault
  double max_step = 0;      ///< m or rad in one tick, >= max_velocity * period: beyond it a jump
  double min_damping =
      0;  ///< N s/m or N m s/rad, >= 0: what the axis surely dissipates, friction compensation taken off
  double delay_share = 0;  ///< t / T in [0, 1): the fraction of a tick in the device's latency
  std::uint16_t delay_ticks = 0;  ///< n: the whole ticks in it, at most kMaxDelayTicks
};

/// An axis whose encoder is watched for being stuck (only axes that ask for it are here).
struct StuckWatch {
  std::uint16_t axis = 0;
  std::uint32_t ticks = 0;  ///< this many ticks of the very same raw value under force are a fault
  double min_effort = 0;    ///< N or N m: below it nobody expects motion
};

/// One device: a run of axes and the contact that they move.
struct DevicePlan {
  std::uint16_t first_axis = 0;
  std::uint16_t axes = 0;
  std::uint16_t first_coordinate = 0;
  std::uint16_t coordinates = 0;
  double max_force = 0;      ///< N in the scene's scale, > 0: norm of the contact force
  double max_slew = 0;       ///< N per tick: norm of the change of the contact force
  double ramp_per_tick = 1;  ///< share of the force that one tick of the ramp adds or takes
  std::uint32_t max_stale_ticks =
      0;  ///< the first stale tick holds, then forces fade out, then a fault
};

struct Plan {
  double period_s = 1e-3;
  double rate_Hz = 1e3;
  std::span<const AxisPlan> axes;
  std::span<const DevicePlan> devices;
  std::span<const StuckWatch> stuck_watches;
  std::span<const HomingPlan> homings;
  std::span<const LowPassPlan> low_passes;
  std::span<const LeastSquaresPlan> least_squares;
  std::span<const FoawPlan> foaws;
  std::span<const AlphaBetaGammaPlan> alpha_beta_gammas;

  std::span<const CartesianAxis> cartesian_axes;
  std::span<const Linkage> linkages;
  std::span<const LinearMap> linear_maps;
  std::span<const FiveBar> five_bars;
  std::span<const Delta> deltas;
  std::span<const Serial> serials;

  std::span<const ForceSensor> force_sensors;
  std::span<const GravityAxis> gravity_axes;
  std::span<const GravityTip> gravity_tips;
  std::span<const FrictionAxis> frictions;
  std::span<const ObserverPlan> axis_observers;
  std::span<const ObserverPlan> contact_observers;

  std::span<const PlaneContact> planes;   ///< those that need nothing of what follows
  std::span<const ContactPlan> contacts;  ///< one per device; empty: a scene of planes at most
  std::span<const Encounter> encounters;  ///< by contact, those without bounds last
  std::span<const Plane> free_planes;
  std::span<const Relief> reliefs;
  std::span<const Box> boxes;
  std::span<const Sphere> spheres;
  std::span<const Cylinder> cylinders;
  std::span<const Capsule> capsules;
  std::span<const Mesh> meshes;
  std::span<const PointGuide> point_guides;
  std::span<const LineGuide> line_guides;
  std::span<const CurveGuide> curve_guides;
  std::span<const Vec3> curve_points;
  std::span<const ViscousField> viscous_fields;
  std::span<const ConstantField> constant_fields;
  std::span<const Detents> detents;
  std::span<const Magnet> magnets;
  std::span<const Vibration> vibrations;
  std::span<const Path> paths;
  std::span<const Waypoint> waypoints;

  std::span<const GroupPlan> groups;
  std::span<const std::uint16_t> group_contacts;
  std::span<const double> gains;

  std::span<const TravelPlan> travels;
  std::span<const PowerLimit> power_limits;
  std::span<const ThermalPlan> thermals;
  std::span<const WorkspacePlan> workspaces;
  std::span<const EnableInput> enable_inputs;
  std::span<const PassivityPlan> passivity_controllers;
  std::size_t coordinates = 0;
  RecordLayout record;
};

}  // namespace hapticd::control
