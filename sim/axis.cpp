#include "sim/axis.h"

#include <algorithm>
#include <cmath>

namespace hapticd::sim {
namespace {

PlantOptions plant_options(const AxisOptions& axis, const HandOptions& hand) {
  return {.mass_kg = axis.mass_kg + hand.mass_kg,
          .damping_Ns_m = axis.damping_Ns_m + hand.damping_Ns_m,
          .stiffness_N_m = hand.stiffness_N_m,
          .coulomb_N = axis.coulomb_N};
}

}  // namespace

Axis::Axis(const AxisOptions& axis, const HandOptions& hand, TimeGrid grid, std::uint64_t seed,
           std::size_t index)
    : encoder_(axis),
      amplifier_(axis),
      noise_(seed, index),
      noise_counts_(axis.noise_counts),
      plant_(plant_options(axis, hand), axis.position_m),
      script_(hand.script, axis.position_m, grid.substep_s()),
      trace_(static_cast<std::size_t>(grid.substeps), axis.position_m) {
  truth_.position_m = truth_.min_position_m = truth_.max_position_m = axis.position_m;
  truth_.rest_m = axis.position_m;
  cut_period(grid, axis.delay_s);
}

// A delay of n periods and a rest: in each period the command of n+1 periods ago acts until the
// rest has passed, then that of n periods ago. The sub-step in which that happens is cut in two, so
// the change is exact.
void Axis::cut_period(TimeGrid grid, double delay_s) {
  constexpr double kSnap = 1e-9;  // of a period: closer than this is the same time
  const double periods = delay_s / grid.period_s;
  const auto whole = static_cast<std::size_t>(std::floor(periods + kSnap));
  const double change_s = std::max(0.0, delay_s - static_cast<double>(whole) * grid.period_s);
  const double substep_s = grid.substep_s();
  const double snap_s = kSnap * grid.period_s;
  for (int i = 0; i < grid.substeps; ++i) {
    const double until_change_s = change_s - i * substep_s;
    if (until_change_s <= snap_s) {
      add_segment(0, substep_s, whole, true);
    } else if (until_change_s >= substep_s - snap_s) {
      add_segment(0, substep_s, whole + 1, true);
    } else {
      add_segment(0, until_change_s, whole + 1, false);
      add_segment(until_change_s, substep_s, whole, true);
    }
  }
  efforts_.assign(whole + 2, 0.0);
}

void Axis::add_segment(double begin_s, double end_s, std::size_t effort_age, bool last) {
  segments_.push_back({plant_.propagator(end_s - begin_s), effort_age, begin_s, last});
}

void Axis::run_tick(std::int64_t script_substep) noexcept {
  std::copy_backward(efforts_.begin(), efforts_.end() - 1, efforts_.end());
  efforts_.front() = held_N_;
  std::size_t substep = 0;
  ScriptValue hand;
  for (const Segment& segment : segments_) {
    if (segment.begin_s == 0)
      hand = script_.at(script_substep + static_cast<std::int64_t>(substep));
    run_segment(segment, hand);
    if (segment.last) observe_substep(substep++);
  }
  truth_.energy_J = plant_.energy_J(truth_.rest_m);
}

void Axis::run_segment(const Segment& segment, const ScriptValue& hand) noexcept {
  const double before_m = plant_.position_m();
  const double rest_m = hand.rest_m + hand.rest_rate_m_s * segment.begin_s;
  truth_.effort_N = efforts_[segment.effort_age];
  truth_.script_force_N = hand.force_N;
  plant_.advance(segment.propagator, {truth_.effort_N + hand.force_N, rest_m, hand.rest_rate_m_s});
  truth_.rest_m = rest_m + hand.rest_rate_m_s * segment.propagator.length_s;
  const double step_m = plant_.position_m() - before_m;
  truth_.effort_work_J += truth_.effort_N * step_m;
  truth_.script_work_J += hand.force_N * step_m;
}

void Axis::observe_substep(std::size_t substep) noexcept {
  truth_.position_m = plant_.position_m();
  truth_.velocity_m_s = plant_.velocity_m_s();
  truth_.min_position_m = std::min(truth_.min_position_m, truth_.position_m);
  truth_.max_position_m = std::max(truth_.max_position_m, truth_.position_m);
  trace_[substep] = truth_.position_m;
}

double Axis::command(double effort_N) noexcept {
  held_N_ = amplifier_.carried_N(effort_N);
  return held_N_;
}

void Axis::cut() noexcept {
  held_N_ = 0;
  std::fill(efforts_.begin(), efforts_.end(), 0.0);
}

double Axis::read_encoder(double offset_m) noexcept {
  const double noise = noise_counts_ > 0 ? noise_counts_ * noise_.normal() : 0;
  return encoder_.counts(plant_.position_m() + offset_m, noise);
}

}  // namespace hapticd::sim
