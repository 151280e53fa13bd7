// One axis in closed loop with the real observe() kernel: exact plant, command from a virtual wall
// (both ways, backward difference), hand pushing on the device.
#pragma once
#include <algorithm>

#include "control/build/filters.h"
#include "control/observer/observer.h"
#include "tests/support/held_mass.h"
#include "tests/support/period.h"

namespace hapticd::test {

/// The paper's device: 0.01 kg, 0.022 N s/m, observer without any bound and without a blend.
inline build::ObserverFigures paper_observer(build::ObserverMode mode, double cutoff_Hz,
                                             int order) {
  return {.mode = mode,
          .nominal_mass_kg = 0.01,
          .nominal_damping_Ns_m = 0.022,
          .cutoff_Hz = cutoff_Hz,
          .order = order,
          .max_output = 1e12};
}

struct ObservedLoop {
  HeldMass plant{.mass_kg = 0.01, .damping_Ns_m = 0.022};
  control::ObserverPlan plan;
  control::ObserverState state{};
  double wall_N_m = 0, wall_Ns_m = 0;
  double max_command_N = 1e12;
  bool tell_unsaturated = false;  ///< the observer hears what was asked, not what was delivered
  bool late_sensor = false;       ///< a reading is the force of one period before, alone
  double last_hand = 0;
  double heard = 0;  ///< N: command that the observer takes for delivered
  double last_x = 0;
  bool started = false;

  explicit ObservedLoop(const build::ObserverFigures& figures)
      : plan(build::observer(0, 0, figures, kPeriod_s)) {}

  /// One tick: `command` of the scene beside the wall, `hand` on the device over the period after.
  void run(double command_N, double hand_N) {
    using control::Motion;
    const double compensation = control::observe(
        plan, state, started ? Motion::advanced : Motion::reseeded, plant.x, heard, hand_N);
    started = true;
    if (late_sensor) state.hand = {last_hand, last_hand};
    last_hand = hand_N;
    const double damping = wall_Ns_m * (plant.x - last_x) / kPeriod_s;
    const double asked = command_N - wall_N_m * plant.x - damping + compensation;
    const double delivered = std::clamp(asked, -max_command_N, max_command_N);
    heard = tell_unsaturated ? asked : delivered;
    last_x = plant.x;
    plant.advance(delivered + hand_N, kPeriod_s);
  }
};

}  // namespace hapticd::test
