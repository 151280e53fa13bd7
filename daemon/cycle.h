// One tick around step(): request, collect, step, command, record. The servo thread, `hapticctl simulate` and the
// benchmarks run this same code; only the clock that they pass in differs.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "control/build/program.h"
#include "control/record.h"
#include "control/rt/spsc_ring.h"
#include "control/step.h"
#include "drivers/device.h"

namespace hapticd::daemon {

/// CLOCK_MONOTONIC in ns, or what stands for it.
using Now = std::int64_t (*)() noexcept;

/// What the caller knows of this tick.
struct CycleInput {
  drivers::TickTime time;
  std::int64_t missed_ticks = 0;
  Fault host_fault = Fault::none;
  double host_fault_found = 0;
  double host_fault_allowed = 0;
  bool enable = false;
  bool clear_fault = false;
};

class Cycle {
 public:
  /// Devices in plan order; `axes[i]` is the number of axes of device i.
  Cycle(std::vector<drivers::Device*> devices, const control::Plan& plan);

  /// Runs one tick. `ring` may be nullptr: no record. Afterwards output() and phases() tell about it.
  void run(build::Program& program, const CycleInput& input, Now now, rt::SpscRing* ring) noexcept;

  const control::TickOutput& output() const noexcept { return output_; }
  const control::PhaseTimes& phases() const noexcept { return phases_; }
  /// All devices reported their power stage on in the last tick.
  bool armed() const noexcept { return armed_; }
  std::span<const AxisSample> samples() const noexcept { return samples_; }

  /// Zero force to every device, with the state's efforts zero as well. For every way out.
  void stop() noexcept;

 private:
  void request_all(const drivers::TickTime& time) noexcept;
  void collect_all(const drivers::TickTime& time, Now now) noexcept;
  void supervise(control::TickInput& input) noexcept;
  void command_all() noexcept;
  void set_armed(bool armed) noexcept;

  struct Slot {
    drivers::Device* device;
    std::size_t first_axis, axes;
    bool complete;
  };
  std::vector<Slot> slots_;
  std::vector<AxisSample> samples_;
  std::vector<Aux> aux_;
  std::vector<double> delivered_;
  control::TickOutput output_;
  control::PhaseTimes phases_;
  std::uint32_t sequence_ = 0;
  bool armed_ = false;
  bool arm_wanted_ = false;
  bool was_enabled_ = false;
};

}  // namespace hapticd::daemon
