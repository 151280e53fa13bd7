// A hand on the axis, seen by a force sensor; and axes that are only held.
#include "control/identify/hand.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "control/identify/hold.h"
#include "tests/unit/identify/bench_axis.h"

namespace hapticd::identify {
namespace {

test::BenchRun held_run(const sim::AxisOptions& axis, const sim::HandOptions& hand,
                        std::uint64_t seed) {
  sim::DeviceOptions device = test::bench_axis(axis, seed);
  device.hand = hand;
  device.force_sensor = sim::ForceSensorOptions{.noise_N = 0.02};
  ExcitationOptions excitation = test::bench_excitation(Method::stepped);
  excitation.high_Hz = 20;
  excitation.low_Hz = 1;
  excitation.force = 4;
  return test::run_bench(device, excitation);
}

TEST(HandFit, IntervalsAreTrueAndNarrow) {
  int inside = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    test::Draw draw(seed);
    const sim::HandOptions hand{.mass_kg = draw.between(0.05, 0.3),
                                .stiffness_N_m = draw.between(100, 600),
                                .damping_Ns_m = draw.between(1, 5),
                                .script = {}};
    const sim::AxisOptions axis = test::any_axis(seed);
    const test::BenchRun run = held_run(axis, hand, seed);
    ASSERT_EQ(run.runner.ended(), Ended::complete) << run.runner.why();
    const auto fitted = fit_hand(run.runner.record(), run.hand_force, run.runner.measured(),
                                 {.delay_s = axis.delay_s});
    ASSERT_TRUE(fitted) << fitted.error().text;
    inside += std::abs(fitted->value.mass - hand.mass_kg) <= fitted->half_width.mass;
    inside += std::abs(fitted->value.viscous - hand.damping_Ns_m) <= fitted->half_width.viscous;
    inside +=
        std::abs(fitted->value.stiffness - hand.stiffness_N_m) <= fitted->half_width.stiffness;
    EXPECT_LT(fitted->half_width.mass, 0.1 * hand.mass_kg) << seed;
    EXPECT_LT(fitted->half_width.stiffness, 0.1 * hand.stiffness_N_m) << seed;
    for (const ResponsePoint& point : fitted->force_per_position)
      EXPECT_GT(point.coherence, 0.99) << point.frequency_Hz;
  }
  EXPECT_GE(inside, 57);  // of 60
}

TEST(HandFit, ASilentSensorIsNoHand) {
  const test::BenchRun run = held_run(test::any_axis(1), {}, 1);
  const Signal silence(run.runner.record().samples.size(), 0.0);
  const auto fitted = fit_hand(run.runner.record(), silence, run.runner.measured(), {});
  ASSERT_FALSE(fitted);
  EXPECT_THAT(fitted.error().text, testing::HasSubstr("is a hand on the axis?"));
}

TEST(HandFit, AFewFrequenciesAreTooFew) {
  const test::BenchRun run = held_run(test::any_axis(1), {}, 1);
  const std::vector<Measured> measured = run.runner.measured();
  EXPECT_FALSE(fit_hand(run.runner.record(), run.hand_force, std::span(measured).first(4), {}));
}

// A push of half the force that it has moves it by little, known mass or not.
TEST(Hold, HoldsAgainstAPush) {
  for (const double mass : {0.0, 0.05}) {
    sim::DeviceOptions options = test::bench_axis({.mass_kg = 0.05,
                                                   .damping_Ns_m = 0.2,
                                                   .delay_s = 0.001,
                                                   .noise_counts = 0.5,
                                                   .max_effort_N = 8});
    options.hand.script = {{.at_s = 1.5, .force_N = 1}};
    sim::SimDevice device(options);
    ASSERT_TRUE(device.connect());
    device.set_armed(true);
    Hold hold({.mass = mass, .force = 2, .travel = 0.02}, options.period_s);
    AxisSample sample;
    Aux aux;
    double delivered = 0;
    for (std::int64_t tick = 0; tick < 5000; ++tick) {
      device.request({.tick = tick, .start_ns = 0, .deadline_ns = 0});
      device.collect({&sample, 1}, aux);
      const double effort = hold.tick(sample.raw / test::kCountsPerM, tick % 50 != 0);
      EXPECT_LE(std::abs(effort), 2);
      device.command({&effort, 1}, {&delivered, 1});
    }
    EXPECT_LT(hold.strayed(), 0.02);
    EXPECT_LT(std::abs(device.truth(0).velocity_m_s), 0.01);
  }
}

}  // namespace
}  // namespace hapticd::identify
