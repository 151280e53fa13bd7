// One simulated linkage: its plant, the hand's script, and the delayed efforts of its joints.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/linkage_plant.h"
#include "sim/options.h"
#include "sim/script.h"
#include "sim/time_grid.h"
#include "sim/truth.h"
#include "sim/wires.h"

namespace hapticd::sim {

class Linkage {
 public:
  /// Set-up: allocates all that run_tick() needs.
  explicit Linkage(const DeviceOptions& options);

  /// One period. The first sub-step is number `script_substep` of the hand's script (negative:
  /// before it). `wires` of all joints.
  void run_tick(std::span<Wires> wires, std::int64_t script_substep) noexcept;
  void restart_script() noexcept { script_.restart(); }
  /// Of the hand on the tip at the start of that sub-step, the efforts that acted last still on;
  /// device frame.
  std::array<double, 3> hand_force_N(std::int64_t script_substep) noexcept;

  const Truth& truth(std::size_t joint) const noexcept { return truth_[joint]; }
  const TipTruth& tip() const noexcept { return tip_; }
  /// Positions of a joint at the ends of the sub-steps of the last period.
  std::span<const double> trace(std::size_t joint) const noexcept { return trace_[joint]; }

 private:
  void run_segment(const Segment& segment, const ScriptValue& hand,
                   std::span<Wires> wires) noexcept;
  void observe_substep(std::size_t substep) noexcept;
  void observe_tip() noexcept;

  LinkagePlant plant_;
  Script script_;
  std::vector<Segment> segments_;  ///< of one period
  LinkageInput input_;             ///< that acted last
  std::vector<Truth> truth_;
  TipTruth tip_;
  std::vector<std::vector<double>> trace_;
};

}  // namespace hapticd::sim
