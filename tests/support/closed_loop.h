// One axis against one wall in virtual time: the real Cycle and step() with a simulated device.
#pragma once
#include <cstdint>
#include <memory>

#include "control/build/program.h"
#include "control/rt/spsc_ring.h"
#include "daemon/cycle.h"
#include "sim/sim_device.h"

namespace hapticd::test {

/// A wall that fills x > surface_m, limits far out of the way, and the axis of the device as the
/// loop believes it to be.
struct LoopOptions {
  double stiffness_N_m = 0;  ///< 0: no wall at all
  double damping_Ns_m = 0;
  double surface_m = 0;
  double max_force_N = 1e12;
  double max_effort_N = 1e12;
  double max_velocity_m_s = 1e9;
  double max_step_m = 1e9;
  double ramp_per_tick = 1;
  std::uint32_t max_stale_ticks = 3;
  std::uint32_t stuck_ticks = 0;  ///< 0: no watch
  double stuck_min_effort_N = 0.1;
  std::uint16_t delay_ticks = 0;  ///< latency that the ledger books with: whole ticks
  double delay_share = 0;         ///< and the rest, as a share of a tick
};

/// A device of one axis with an encoder so fine that its quantisation is out of the way; no limit
/// bites.
sim::DeviceOptions one_axis_device(double mass_kg, double damping_Ns_m);

/// Every axis of the device is one contact coordinate.
build::ProgramSpec program_spec(const sim::DeviceOptions& device, const LoopOptions& options);

class ClosedLoop {
 public:
  /// Connected, forces wanted from the first tick on.
  ClosedLoop(const sim::DeviceOptions& device, const LoopOptions& options);

  /// One tick, `missed_ticks` periods later than usual. Afterwards tick() is the number of the tick
  /// that ran.
  const control::TickOutput& run(std::int64_t missed_ticks = 0);
  /// Ticks until forces are fully on: the device's script, if its ramp is the loop's, starts with
  /// the tick that just ran.
  void run_until_ramped();

  std::int64_t tick() const { return tick_; }
  double force_N() const { return program_->state().force[0]; }
  double effort_N() const { return cycle_->output().effort[0]; }
  const sim::SimDevice& device() const { return device_; }
  const control::State& state() const { return program_->state(); }
  const daemon::Cycle& cycle() const { return *cycle_; }
  bool enable = true;
  bool clear_fault = false;
  rt::SpscRing* ring = nullptr;
  build::Program& program() { return *program_; }

 private:
  sim::SimDevice device_;
  std::unique_ptr<build::Program> program_;
  std::unique_ptr<daemon::Cycle> cycle_;
  std::int64_t tick_ = -1;
};

}  // namespace hapticd::test
