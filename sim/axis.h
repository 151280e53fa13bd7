// One simulated axis: plant and hand, the wires with their delay, encoder and amplifier.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/converters.h"
#include "sim/noise.h"
#include "sim/options.h"
#include "sim/plant.h"
#include "sim/script.h"

namespace hapticd::sim {

/// What an axis really does; no loop gets to see it. Extremes and works are since connect(),
/// observed at sub-steps.
struct Truth {
  double position_m = 0;
  double velocity_m_s = 0;
  double min_position_m = 0;
  double max_position_m = 0;
  double effort_N = 0;        ///< that acted last
  double script_force_N = 0;  ///< that acted last
  double rest_m = 0;          ///< of the hand's spring, now
  double effort_work_J = 0;   ///< that the actuator put into the mass
  double script_work_J = 0;   ///< that the hand's scripted force put into the mass
  double energy_J = 0;        ///< kinetic, and that of the hand's spring
};

/// How time is cut: a period into `substeps` sub-steps.
struct TimeGrid {
  double period_s = 0;
  int substeps = 1;
  double substep_s() const noexcept { return period_s / substeps; }
};

class Axis {
 public:
  /// Set-up: allocates all that run_tick() needs. `index` selects the noise stream of `seed`.
  Axis(const AxisOptions& axis, const HandOptions& hand, TimeGrid grid, std::uint64_t seed,
       std::size_t index);

  /// One period. The first sub-step is number `script_substep` of the hand's script (negative:
  /// before it).
  void run_tick(std::int64_t script_substep) noexcept;
  /// The effort from now on, after the delay. Returns what the amplifier makes of it.
  double command(double effort_N) noexcept;
  /// Power off: no force from now on, whatever is still on its way.
  void cut() noexcept;
  void restart_script() noexcept { script_.restart(); }
  /// Draws noise: once a tick.
  double read_encoder(double offset_m) noexcept;

  const Truth& truth() const noexcept { return truth_; }
  /// Positions [m] at the ends of the sub-steps of the last period.
  std::span<const double> trace() const noexcept { return trace_; }

 private:
  // A run of time in which no input changes its law: a sub-step, or a part of one where the delayed
  // effort changes.
  struct Segment {
    Propagator propagator;
    std::size_t effort_age = 0;  ///< periods since the command that acts now
    double begin_s = 0;          ///< within its sub-step
    bool last = true;            ///< of its sub-step
  };
  void cut_period(TimeGrid grid, double delay_s);
  void add_segment(double begin_s, double end_s, std::size_t effort_age, bool last);
  void run_segment(const Segment& segment, const ScriptValue& hand) noexcept;
  void observe_substep(std::size_t substep) noexcept;

  Encoder encoder_;
  Amplifier amplifier_;
  Noise noise_;
  double noise_counts_;
  Plant plant_;
  Script script_;
  std::vector<Segment> segments_;  ///< of one period
  std::vector<double> efforts_;    ///< [N] by age in periods
  double held_N_ = 0;              ///< the last command
  Truth truth_;
  std::vector<double> trace_;
};

}  // namespace hapticd::sim
