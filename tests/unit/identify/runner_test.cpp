// What an axis may and may not go through while it is identified.
#include "control/identify/runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/identify/bench_axis.h"

namespace hapticd::identify {
namespace {

using testing::HasSubstr;

constexpr sim::AxisOptions kEveryday{.mass_kg = 0.05,
                                     .damping_Ns_m = 1.37,
                                     .coulomb_N = 0.1,
                                     .delay_s = 0.0007,
                                     .noise_counts = 0.5,
                                     .max_effort_N = 8};

// Axes of very different mass and friction, sticky and slippery ones among them.
TEST(Runner, HoldsItsBounds) {
  for (const Method method : {Method::stepped, Method::chirp}) {
    const ExcitationOptions options = test::bench_excitation(method);
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      sim::AxisOptions axis = test::any_axis(seed);
      test::Draw draw(seed);
      axis.coulomb_N = draw.between(0, 1);
      axis.mass_kg = draw.around(0.05, 5);
      const test::BenchRun run = test::run_bench(test::bench_axis(axis, seed), options);
      EXPECT_LE(run.greatest_effort, options.force);
      EXPECT_LE(run.greatest_deviation, 1.05 * options.travel) << seed;
      EXPECT_LE(run.greatest_speed, 1.1 * options.speed) << seed;
      EXPECT_EQ(run.runner.ended(), Ended::complete) << seed << ": " << run.runner.why();
    }
  }
}

// No jump of more than the sine itself makes from tick to tick, and what the encoder's steps do to
// the damper.
TEST(Runner, NothingKicks) {
  for (const Method method : {Method::stepped, Method::chirp}) {
    const ExcitationOptions options = test::bench_excitation(method);
    const test::BenchRun run = test::run_bench(test::bench_axis(kEveryday), options);
    const double sine = 2 * 3.1416 * options.high_Hz * 1e-3 * 0.8 * options.force;
    EXPECT_LE(run.greatest_step, sine + 0.2);
    const auto& samples = run.runner.record().samples;
    for (std::size_t i = 0; i < 40; ++i) EXPECT_LE(std::abs(samples[i].effort), 0.1);
    EXPECT_LE(std::abs(samples[samples.size() - 3].effort), 0.3);
    EXPECT_EQ(samples.back().effort, 0);
    EXPECT_EQ(run.runner.progress(), 1);
  }
}

// A third of its force is needed to hold its weight.
TEST(Runner, AnAxisMayHaveWeight) {
  sim::DeviceOptions device = test::bench_axis(kEveryday);
  device.hand.script = {{.at_s = 0, .force_N = -1}};
  const test::BenchRun run = test::run_bench(device, test::bench_excitation(Method::stepped));
  EXPECT_EQ(run.runner.ended(), Ended::complete) << run.runner.why();
}

// Two thirds of the force are friction, and hardly anything damps: the amplitude that is wanted lies
// between rest and too much.
TEST(Runner, AnAxisThatSticksAndSlipsComesToAnEnd) {
  const sim::AxisOptions axis{.mass_kg = 0.0435,
                              .damping_Ns_m = 0.162,
                              .coulomb_N = 1.894,
                              .delay_s = 0.0004,
                              .noise_counts = 0.5,
                              .max_effort_N = 8};
  ExcitationOptions options = test::bench_excitation(Method::stepped);
  options.travel = 0.02;
  options.steps = 12;
  options.blocks = 8;
  const test::BenchRun run = test::run_bench(test::bench_axis(axis), options);
  EXPECT_NE(run.runner.ended(), Ended::running);
  EXPECT_LT(run.runner.record().samples.size(), 120'000u);
}

TEST(Runner, WhoeverPushesTheAxisOutOfItsTravelEndsIt) {
  sim::DeviceOptions device = test::bench_axis(kEveryday);
  device.hand.script = {{.at_s = 0, .force_N = 0}, {.at_s = 2, .force_N = 1.3}};
  ExcitationOptions options = test::bench_excitation(Method::stepped);
  options.speed = 5;
  const test::BenchRun run = test::run_bench(device, options);
  EXPECT_EQ(run.runner.ended(), Ended::too_far);
  EXPECT_THAT(run.runner.why(), HasSubstr("allowed are 0.03"));
  EXPECT_EQ(run.runner.record().samples.back().effort, 0);
}

TEST(Runner, TooFastEndsIt) {
  sim::DeviceOptions device = test::bench_axis(kEveryday);
  device.hand.script = {{.at_s = 0, .force_N = 0}, {.at_s = 2, .force_N = 6}};
  ExcitationOptions options = test::bench_excitation(Method::stepped);
  options.speed = 0.1;
  const test::BenchRun run = test::run_bench(device, options);
  EXPECT_EQ(run.runner.ended(), Ended::too_fast);
  EXPECT_THAT(run.runner.why(), HasSubstr("allow more speed, or less force"));
}

TEST(Runner, SamplesThatStayAwayEndIt) {
  const auto run =
      test::run_bench(test::bench_axis(kEveryday), test::bench_excitation(Method::stepped),
                      [](std::int64_t tick) { return tick >= 1500; });
  EXPECT_EQ(run.runner.ended(), Ended::no_samples);
  EXPECT_THAT(run.runner.why(), HasSubstr("no fresh position for 11 ticks"));
}

TEST(Excitation, BlocksAreWholePeriodsAndWholeTicks) {
  const test::BenchRun run =
      test::run_bench(test::bench_axis(kEveryday), test::bench_excitation(Method::stepped));
  const std::vector<Measured> measured = run.runner.measured();
  ASSERT_EQ(measured.size(), 8u);
  for (const Measured& at : measured) {
    EXPECT_NEAR(at.frequency_Hz * 1e-3 * static_cast<double>(at.block_ticks), at.periods, 1e-9);
    EXPECT_GE(static_cast<double>(at.block_ticks) * 1e-3, 0.0999);
    EXPECT_LE(at.begin + at.ticks(), run.runner.record().samples.size());
  }
  EXPECT_NEAR(measured.front().frequency_Hz, 50, 1);
  EXPECT_NEAR(measured.back().frequency_Hz, 2, 0.05);
}

}  // namespace
}  // namespace hapticd::identify
