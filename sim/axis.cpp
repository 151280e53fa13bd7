#include "sim/axis.h"

#include <limits>

namespace hapticd::sim {
namespace {

PlantOptions plant_options(const AxisOptions& axis, const HandOptions& hand) {
  const double mass_kg = axis.mass_kg + hand.mass_kg;
  return {.mass_kg = mass_kg,
          .damping_Ns_m = axis.damping_Ns_m + hand.damping_Ns_m,
          .stiffness_N_m = hand.stiffness_N_m,
          .coulomb_N = axis.coulomb_N,
          .stops = end_stops(axis, mass_kg, std::numeric_limits<double>::infinity())};
}

}  // namespace

Axis::Axis(const AxisOptions& axis, const HandOptions& hand, TimeGrid grid)
    : hand_(hand),
      plant_(plant_options(axis, hand), axis.position_m),
      script_(hand.script, axis.position_m, grid.substep_s()),
      trace_(static_cast<std::size_t>(grid.substeps), axis.position_m) {
  truth_.position_m = truth_.min_position_m = truth_.max_position_m = axis.position_m;
  truth_.rest_m = axis.position_m;
  for (const Segment& segment : cut_period(grid, std::span(&axis.delay_s, 1))) {
    pieces_.push_back({segment, plant_.propagator(segment.end_s - segment.begin_s)});
  }
}

void Axis::run_tick(Wires& wires, std::int64_t script_substep) noexcept {
  wires.next_period();
  std::size_t substep = 0;
  ScriptValue hand;
  for (const Piece& piece : pieces_) {
    if (piece.segment.begin_s == 0)
      hand = script_.at(script_substep + static_cast<std::int64_t>(substep));
    run_piece(piece, hand, wires);
    if (piece.segment.last) observe_substep(substep++);
  }
  truth_.energy_J = plant_.energy_J(truth_.rest_m);
}

void Axis::run_piece(const Piece& piece, const ScriptValue& hand, Wires& wires) noexcept {
  const double before_m = plant_.position_m();
  const double rest_m = hand.rest_m + hand.rest_rate_m_s * piece.segment.begin_s;
  truth_.effort_N = wires.effort_N(piece.segment.effort_age[0]);
  truth_.script_force_N = hand.force_N;
  plant_.advance(piece.propagator, {truth_.effort_N + hand.force_N, rest_m, hand.rest_rate_m_s});
  truth_.rest_m = rest_m + hand.rest_rate_m_s * piece.propagator.length_s;
  const double step_m = plant_.position_m() - before_m;
  truth_.effort_work_J += truth_.effort_N * step_m;
  truth_.script_work_J += hand.force_N * step_m;
  wires.moved(before_m, plant_.position_m());
}

void Axis::observe_substep(std::size_t substep) noexcept {
  truth_.observe(plant_.position_m(), plant_.velocity_m_s());
  trace_[substep] = truth_.position_m;
}

double Axis::hand_force_N(std::int64_t script_substep) noexcept {
  const ScriptValue script = script_.at(script_substep);
  const double acceleration =
      plant_.acceleration_m_s2(truth_.effort_N + script.force_N, script.rest_m);
  return script.force_N - hand_.stiffness_N_m * (plant_.position_m() - script.rest_m) -
         hand_.damping_Ns_m * plant_.velocity_m_s() - hand_.mass_kg * acceleration;
}

}  // namespace hapticd::sim
