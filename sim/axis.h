// One simulated axis that is on its own: plant and hand.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/options.h"
#include "sim/plant.h"
#include "sim/script.h"
#include "sim/time_grid.h"
#include "sim/truth.h"
#include "sim/wires.h"

namespace hapticd::sim {

class Axis {
 public:
  /// Set-up: allocates all that run_tick() needs.
  Axis(const AxisOptions& axis, const HandOptions& hand, TimeGrid grid);

  /// One period. The first sub-step is number `script_substep` of the hand's script (negative:
  /// before it).
  void run_tick(Wires& wires, std::int64_t script_substep) noexcept;
  void restart_script() noexcept { script_.restart(); }
  /// Of the hand on the axis at the start of that sub-step, the effort that acted last still on:
  /// script + spring + damper - m_hand x''.
  double hand_force_N(std::int64_t script_substep) noexcept;

  const Truth& truth() const noexcept { return truth_; }
  /// Positions [m] at the ends of the sub-steps of the last period.
  std::span<const double> trace() const noexcept { return trace_; }

 private:
  struct Piece {
    Segment segment;
    Propagator propagator;
  };
  void run_piece(const Piece& piece, const ScriptValue& hand, Wires& wires) noexcept;
  void observe_substep(std::size_t substep) noexcept;

  HandOptions hand_;
  Plant plant_;
  Script script_;
  std::vector<Piece> pieces_;  ///< of one period
  Truth truth_;
  std::vector<double> trace_;
};

}  // namespace hapticd::sim
