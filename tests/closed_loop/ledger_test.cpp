// The energy ledger against the work that the simulated motor really did on the simulated mass,
// which is integrated over the sub-steps of the plant.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/closed_loop.h"
#include "tests/support/period.h"

namespace hapticd::test {
namespace {

constexpr double kMass_kg = 0.1;

sim::DeviceOptions device(double counts_per_m, double delay_s) {
  sim::DeviceOptions device = one_axis_device(kMass_kg, 1.0);
  device.axes[0].counts_per_m = counts_per_m;
  device.axes[0].encoder_bits = 0;
  device.axes[0].delay_s = delay_s;
  device.axes[0].position_m = -5e-3;
  device.substeps = 100;
  device.hand.stiffness_N_m = 200;
  device.hand.script = {{.at_s = 0.05, .position_m = 0.01},
                        {.at_s = 0.4, .position_m = 0.005},
                        {.at_s = 0.6, .position_m = -0.01}};
  return device;
}

struct Booked {
  double ledger_J = 0, truth_J = 0;
  double throughput_J = 0;     ///< sum of |work| of the ticks
  double delay_bound_J = 0;    ///< of ledger.h: sum of |e| a t (T - t) / 2
  double encoder_bound_J = 0;  ///< one count times the change of the effort in every tick
};

Booked run(double counts_per_m, double delay_s) {
  const double ticks = delay_s / kPeriod_s;
  const auto whole = static_cast<std::uint16_t>(ticks);
  const double share = ticks - whole;
  ClosedLoop loop(
      device(counts_per_m, delay_s),
      {.stiffness_N_m = 1500, .damping_Ns_m = 0.2, .delay_ticks = whole, .delay_share = share});
  Booked booked;
  double last_effort_N = 0, last_work_J = 0, last_v_m_s = 0, largest_a_m_s2 = 0, changes_N = 0;
  for (int i = 0; i < 1000; ++i) {
    loop.run();
    const sim::Truth& truth = loop.device().truth(0);
    const double change_N = std::abs(loop.effort_N() - last_effort_N);
    largest_a_m_s2 =
        std::max(largest_a_m_s2, 1.5 * std::abs(truth.velocity_m_s - last_v_m_s) / kPeriod_s);
    changes_N += change_N;
    booked.throughput_J += std::abs(truth.effort_work_J - last_work_J);
    last_effort_N = loop.effort_N();
    last_work_J = truth.effort_work_J;
    last_v_m_s = truth.velocity_m_s;
  }
  const double t_s = share * kPeriod_s;
  booked.ledger_J = loop.state().work[0];
  booked.truth_J = loop.device().truth(0).effort_work_J;
  booked.delay_bound_J = changes_N * largest_a_m_s2 * t_s * (kPeriod_s - t_s) / 2;
  booked.encoder_bound_J = (changes_N + std::abs(last_effort_N)) / counts_per_m;
  return booked;
}

TEST(Ledger, EqualsTheSimulatedWorkAtZeroLatencyAndFineEncoder) {
  const Booked booked = run(1e14, 0);
  ASSERT_GT(booked.throughput_J, 1e-2);
  EXPECT_NEAR(booked.ledger_J, booked.truth_J, 1e-9 * booked.throughput_J);
}

TEST(Ledger, EqualsItAtALatencyOfWholeTicks) {
  const Booked booked = run(1e14, 2e-3);
  ASSERT_GT(booked.throughput_J, 1e-2);
  EXPECT_NEAR(booked.ledger_J, booked.truth_J, 1e-9 * booked.throughput_J);
}

TEST(Ledger, StaysWithinItsBoundBetweenWholeTicks) {
  for (const double delay_s : {0.2e-3, 0.5e-3, 1.7e-3}) {
    const Booked booked = run(1e14, delay_s);
    EXPECT_LE(std::abs(booked.ledger_J - booked.truth_J), booked.delay_bound_J) << delay_s;
    EXPECT_LT(booked.delay_bound_J, 0.2 * booked.throughput_J) << "or the bound says nothing";
  }
}

TEST(Ledger, StaysWithinItsBoundBehindAnEncoder) {
  for (const double counts_per_m : {2e4, 2e5}) {
    const Booked booked = run(counts_per_m, 0);
    EXPECT_LE(std::abs(booked.ledger_J - booked.truth_J), booked.encoder_bound_J) << counts_per_m;
    EXPECT_GT(std::abs(booked.ledger_J - booked.truth_J), 1e-9 * booked.throughput_J)
        << "a coarse encoder must show, or the comparison is with itself";
  }
}

}  // namespace
}  // namespace hapticd::test
