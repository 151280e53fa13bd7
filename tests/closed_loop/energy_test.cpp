// Colgate's bound in the loop: a wall with k T/2 + b < b_device takes energy from every passive
// hand, never gives any.
//
// With depth p, e = p_k - p_{k-1}, P = max(p, 0) and the wall's storage S = (k/2) P^2 + (b/2T) e^2
// the sum W of S and of what the plant and the hand's spring hold falls in every tick (proof:
// control/design/check/stability.h). The hand only has to stand still in what it wants.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/closed_loop.h"
#include "tests/support/generators.h"

namespace hapticd::test {
namespace {

struct Wall {
  double stiffness_N_m = 0;
  double damping_Ns_m = 0;
  double surface_m = 0;
};

struct Energy {
  double start_J = 0;
  double largest_J = 0;
  double largest_rise_J = 0;  ///< from one tick to the next
};

// An encoder of 1e-12 m, so that its rounding does no work worth counting.
sim::DeviceOptions fine_device(double mass_kg, double damping_Ns_m) {
  sim::DeviceOptions device = one_axis_device(mass_kg, damping_Ns_m);
  device.axes[0].counts_per_m = 1e12;
  device.axes[0].encoder_bits = 0;
  return device;
}

// The device starts at rest at 0; at the first tick with force the hand wants to be at
// `device.hand.script[0]`.
Energy run(const sim::DeviceOptions& device, const Wall& wall) {
  ClosedLoop loop(device, {.stiffness_N_m = wall.stiffness_N_m,
                           .damping_Ns_m = wall.damping_Ns_m,
                           .surface_m = wall.surface_m});
  loop.run_until_ramped();
  loop.run();
  Energy result;
  double last_J = 0, last_p_m = 0;
  for (int i = 0; i < 1500; ++i, loop.run()) {
    const double p_m = loop.state().x[0] - wall.surface_m;
    const double e_m = p_m - last_p_m;
    const double depth_m = std::max(p_m, 0.0);
    const double total_J = loop.device().truth(0).energy_J +
                           0.5 * wall.stiffness_N_m * depth_m * depth_m +
                           0.5 * wall.damping_Ns_m / device.period_s * e_m * e_m;
    last_p_m = p_m;
    if (i == 1) result.start_J = total_J;
    if (i > 1) result.largest_rise_J = std::max(result.largest_rise_J, total_J - last_J);
    if (i > 0) result.largest_J = std::max(result.largest_J, total_J);
    last_J = total_J;
  }
  return result;
}

sim::HandOptions hand(double mass_kg, double stiffness_N_m, double damping_Ns_m, double rest_m) {
  return {.mass_kg = mass_kg,
          .stiffness_N_m = stiffness_N_m,
          .damping_Ns_m = damping_Ns_m,
          .script = {{.at_s = 0, .force_N = 0, .position_m = rest_m}}};
}

RC_GTEST_PROP(WallEnergy, NeverRisesBelowTheBoundForAnyPassiveHand, ()) {
  sim::DeviceOptions device = fine_device(any_number(0.005, 0.5), any_number(0.05, 5));
  device.axes[0].coulomb_N = *rc::gen::element(0.0, 0.05, 0.5);
  device.hand =
      hand(any_number(0, 1), any_number(1, 2000), any_number(0, 5), any_number(-0.02, 0.04));
  const double used = any_number(0.01, 1) * device.axes[0].damping_Ns_m;
  const double damper_share = any_number(0, 1);
  const Wall wall{.stiffness_N_m = 2 * used * (1 - damper_share) / device.period_s,
                  .damping_Ns_m = used * damper_share,
                  .surface_m = any_number(-0.01, 0.02)};
  const Energy energy = run(device, wall);
  RC_ASSERT(energy.largest_rise_J <= 1e-9 * energy.largest_J + 1e-13);
}

TEST(WallEnergy, RisesWithFarTooMuchWallDampingOnALightDevice) {
  sim::DeviceOptions device = fine_device(0.01, 0.022);
  device.hand = hand(0, 500, 0, 0.01);
  const Energy energy =
      run(device, {.stiffness_N_m = 1000, .damping_Ns_m = 25, .surface_m = 0.002});
  EXPECT_GT(energy.largest_J, 2 * energy.start_J);
}

TEST(WallEnergy, RisesWithFarTooMuchStiffness) {
  sim::DeviceOptions device = fine_device(0.1, 0.1);
  device.hand = hand(0.2, 200, 0, 0.01);
  const Energy energy =
      run(device, {.stiffness_N_m = 20'000, .damping_Ns_m = 0, .surface_m = 0.002});
  EXPECT_GT(energy.largest_rise_J, 1e-3 * energy.start_J);
}

}  // namespace
}  // namespace hapticd::test
