// One tick around step(): request, collect, step, command, record. The servo thread, `hapticctl
// simulate` and the benchmarks run this same code; only the clock that they pass in differs.
#pragma once
#include <array>
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
  FaultReport host_fault{};
  bool enable = false;
  bool clear_fault = false;
  bool unproven = false;
};

class Cycle {
 public:
  /// Devices in plan order. A plan that is swapped in later has the same devices and axes.
  Cycle(std::vector<drivers::Device*> devices, const control::Plan& plan);
  Cycle(const Cycle&) = delete;
  Cycle& operator=(const Cycle&) = delete;

  /// Runs one tick. `ring` may be nullptr: no record. Afterwards the getters tell about it.
  void run(build::Program& program, const CycleInput& input, Now now,
           rt::SpscRing* ring) noexcept HAPTICD_NONBLOCKING;

  /// A stop cycle, for every way out: zero force to every device, power stages off.
  void stop() noexcept;

  const control::TickOutput& output() const noexcept { return output_; }
  const control::PhaseTimes& phases() const noexcept { return phases_; }
  /// Every device had its power stage on.
  bool armed() const noexcept { return armed_; }
  std::span<const AxisSample> samples() const noexcept { return samples_; }
  /// Likewise, by device.
  std::span<const Aux> aux() const noexcept { return aux_; }

 private:
  struct Slot {
    drivers::Device* device;
    std::size_t first_axis, axes;
    bool complete;
  };

  void request_all(const drivers::TickTime& time) noexcept;
  void collect_all(const drivers::TickTime& time, Now now) noexcept;
  bool collect_waiting() noexcept;
  bool wait_for_buses(std::int64_t timeout_ns) noexcept;
  void fill_tick(control::Mode mode, const CycleInput& input) noexcept;
  void command_all() noexcept;
  void set_armed(bool armed) noexcept;
  void record(const build::Program& program, std::int64_t start_ns, rt::SpscRing& ring) noexcept;

  std::vector<Slot> slots_;
  std::vector<AxisSample> samples_;
  std::vector<Aux> aux_;
  std::array<std::vector<double>, 2>
      delivered_;  // of the last tick (step reads it) and of this one
  std::size_t last_ = 0;
  control::TickInput tick_;
  control::TickOutput output_;
  control::PhaseTimes phases_;
  std::uint32_t sequence_ = 0;
  bool armed_ = false;
  bool arm_wanted_ = false;
};

/// Largest norm of the force on any one contact after the last tick [N].
double largest_contact_force_N(const build::Program& program) noexcept;

}  // namespace hapticd::daemon
