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
#include "control/scene/plane.h"

namespace hapticd::control {

/// One axis: from the device's raw value to q (m or rad), and what its actuator may get.
struct AxisPlan {
  double unit_per_raw = 1;  ///< m or rad per raw unit, sign included
  double offset = 0;        ///< q = unit_per_raw * (unwrapped raw) + offset [m or rad]
  double modulus_raw = 0;   ///< raw values wrap at this; 0: they do not wrap
  double max_effort = 0;    ///< N or N m, > 0: what the actuator can deliver
  double max_velocity = 0;  ///< m/s or rad/s, > 0: beyond it a fault
  double max_step = 0;      ///< m or rad in one tick, >= max_velocity * period: beyond it a jump
};

/// An axis whose encoder is watched for being stuck (only axes that ask for it are here).
struct StuckWatch {
  std::uint16_t axis = 0;
  std::uint32_t ticks = 0;  ///< this many ticks of the very same raw value under force are a fault
  double min_effort = 0;    ///< N or N m: below it nobody expects motion
};

/// An axis that is a coordinate of its contact (Cartesian devices).
struct CartesianAxis {
  std::uint16_t axis = 0;
  std::uint16_t coordinate = 0;
};

/// One device: a run of axes and the contact that they move.
struct DevicePlan {
  std::uint16_t first_axis = 0;
  std::uint16_t axes = 0;
  std::uint16_t first_coordinate = 0;
  std::uint16_t coordinates = 0;
  double max_force = 0;      ///< N, > 0: norm of the contact force
  double max_slew = 0;       ///< N per tick: norm of the change of the contact force
  double ramp_per_tick = 1;  ///< share of the force that one tick of the ramp adds or takes
  std::uint32_t max_stale_ticks = 0;
};

/// One array of a record: `count` values of `bytes` bytes each from `offset` on.
struct RecordArray {
  std::uint32_t offset = 0;
  std::uint32_t count = 0;
};

/// Where each array stands in a record; the header comes first (control/record.h).
struct RecordLayout {
  RecordArray raw, age_ns, delivered;  ///< per axis
  RecordArray q, qd, effort;  ///< per axis; from here to `force` one block, as in State::recorded
  RecordArray x, scene_force, force;  ///< per contact coordinate
  RecordArray aux;                    ///< per device
  RecordArray freshness;              ///< per axis
  std::uint32_t bytes = 0;            ///< of a whole record, a multiple of 8
};

struct Plan {
  double period_s = 1e-3;
  double rate_Hz = 1e3;
  std::span<const AxisPlan> axes;
  std::span<const DevicePlan> devices;
  std::span<const CartesianAxis> cartesian_axes;
  std::span<const StuckWatch> stuck_watches;
  std::span<const PlaneContact> planes;
  std::size_t coordinates = 0;
  RecordLayout record;
};

}  // namespace hapticd::control
