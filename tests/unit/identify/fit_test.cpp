// Identification end to end on simulated axes: are the intervals true, and are they small?
#include "control/identify/fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "control/identify/first_guess.h"
#include "tests/unit/identify/bench_axis.h"

namespace hapticd::identify {
namespace {

const FitOptions kFit{.high_Hz = 50, .longest_delay_s = 5e-3};

Result<Fit> identified(const sim::AxisOptions& axis, Method method, std::uint64_t seed) {
  const test::BenchRun run =
      test::run_bench(test::bench_axis(axis, seed), test::bench_excitation(method));
  if (run.runner.ended() != Ended::complete) return fail(ExitCode::no, run.runner.why());
  return fit(run.runner.record(), kFit);
}

/// Over many axes: how often the truth was inside, and the widths of the intervals.
class Score {
 public:
  void add(const Fit& fit, const sim::AxisOptions& truth) {
    one(0, fit.value.mass, fit.half_width.mass, truth.mass_kg, truth.mass_kg);
    one(1, fit.value.viscous, fit.half_width.viscous, truth.damping_Ns_m, truth.damping_Ns_m);
    one(2, fit.value.coulomb, fit.half_width.coulomb, truth.coulomb_N, truth.coulomb_N);
    one(3, fit.value.delay_s, fit.half_width.delay_s, truth.delay_s, 1);
  }
  int inside(std::size_t parameter) const { return inside_[parameter]; }
  double median_half_width(std::size_t parameter) {
    auto& widths = widths_[parameter];
    std::nth_element(widths.begin(),
                     widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2), widths.end());
    return widths[widths.size() / 2];
  }

 private:
  void one(std::size_t parameter, double value, double half_width, double truth, double unit) {
    inside_[parameter] += std::abs(value - truth) <= half_width;
    widths_[parameter].push_back(half_width / unit);
  }
  std::array<int, 4> inside_{};
  std::array<std::vector<double>, 4> widths_;
};

constexpr std::array<const char*, 4> kNames{"mass", "viscous", "coulomb", "delay"};

// 99 % intervals hold in at least 95 of 100, and are as narrow as was promised. Every axis is
// another one, so no start can be the truth.
TEST(Identify, IntervalsAreTrueAndNarrow) {
  Score score;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const sim::AxisOptions axis = test::any_axis(seed);
    const auto fitted = identified(axis, Method::stepped, seed);
    ASSERT_TRUE(fitted) << seed << ": " << fitted.error().text;
    score.add(*fitted, axis);
  }
  constexpr std::array<double, 4> kAllowed{0.02, 0.10, 0.15, 1e-4};
  for (std::size_t p = 0; p < 4; ++p) {
    EXPECT_GE(score.inside(p), 95) << kNames[p];
    EXPECT_LE(score.median_half_width(p), kAllowed[p]) << kNames[p];
    RecordProperty(std::string(kNames[p]) + "_inside_of_100", score.inside(p));
    RecordProperty(std::string(kNames[p]) + "_half_width",
                   std::to_string(score.median_half_width(p)));
  }
}

TEST(Identify, AChirpTellsTheSame) {
  Score score;
  for (std::uint64_t seed = 201; seed <= 220; ++seed) {
    const sim::AxisOptions axis = test::any_axis(seed);
    const auto fitted = identified(axis, Method::chirp, seed);
    ASSERT_TRUE(fitted) << seed << ": " << fitted.error().text;
    score.add(*fitted, axis);
  }
  for (std::size_t p = 0; p < 4; ++p) EXPECT_GE(score.inside(p), 19) << kNames[p];
}

// With so much noise, friction that turns round at an unknown moment has no part in the intervals.
TEST(Identify, IntervalsAreTrueWhereNoiseMakesThem) {
  Score score;
  for (std::uint64_t seed = 301; seed <= 320; ++seed) {
    sim::AxisOptions axis = test::any_axis(seed);
    axis.noise_counts = 30;
    const auto fitted = identified(axis, Method::stepped, seed);
    ASSERT_TRUE(fitted) << seed << ": " << fitted.error().text;
    score.add(*fitted, axis);
  }
  for (std::size_t p = 0; p < 4; ++p) EXPECT_GE(score.inside(p), 19) << kNames[p];
}

TEST(Identify, NoFrictionIsInsideItsInterval) {
  sim::AxisOptions axis = test::any_axis(1);
  axis.coulomb_N = 0;
  const auto fitted = identified(axis, Method::stepped, 1);
  ASSERT_TRUE(fitted) << fitted.error().text;
  EXPECT_LE(fitted->value.coulomb, fitted->half_width.coulomb);
  EXPECT_LT(fitted->half_width.coulomb, 1e-3);
}

// Units do not matter: a wheel with a 15-bit encoder on each turn.
TEST(Identify, ARotaryAxisIsNoDifferent) {
  const sim::AxisOptions axis{.mass_kg = 2e-4,
                              .damping_Ns_m = 1.3e-3,
                              .coulomb_N = 2e-3,
                              .delay_s = 0.0013,
                              .position_m = 3.1,
                              .noise_counts = 0.5,
                              .max_effort_N = 0.4};
  sim::DeviceOptions device = test::bench_axis(axis);
  device.axes[0].counts_per_m = 32768 / 6.283185307;
  device.axes[0].position_m = 3.1;
  ExcitationOptions excitation = test::bench_excitation(Method::stepped);
  excitation.force = 0.1;
  excitation.travel = 0.5;
  excitation.speed = 10;
  const test::BenchRun run = test::run_bench(device, excitation);
  const auto fitted = fit(run.runner.record(), kFit);
  ASSERT_TRUE(fitted) << fitted.error().text;
  EXPECT_NEAR(fitted->value.mass, axis.mass_kg, fitted->half_width.mass);
  EXPECT_NEAR(fitted->value.viscous, axis.damping_Ns_m, fitted->half_width.viscous);
  EXPECT_NEAR(fitted->value.coulomb, axis.coulomb_N, fitted->half_width.coulomb);
  EXPECT_NEAR(fitted->value.delay_s, axis.delay_s, fitted->half_width.delay_s);
  EXPECT_LT(fitted->half_width.mass, 0.02 * axis.mass_kg);
}

// Lost samples are left out; they are not taken for measurements.
TEST(Identify, LostSamplesDoNoHarm) {
  const sim::AxisOptions axis = test::any_axis(2);
  const auto run = test::run_bench(test::bench_axis(axis), test::bench_excitation(Method::stepped),
                                   [](std::int64_t tick) { return tick % 97 < 2; });
  const auto fitted = fit(run.runner.record(), kFit);
  ASSERT_TRUE(fitted) << fitted.error().text;
  EXPECT_NEAR(fitted->value.mass, axis.mass_kg, fitted->half_width.mass);
  EXPECT_NEAR(fitted->value.delay_s, axis.delay_s, fitted->half_width.delay_s);
}

TEST(Identify, EndsWhenItIsTold) {
  const auto run =
      test::run_bench(test::bench_axis(test::any_axis(1)), test::bench_excitation(Method::stepped));
  int asked = 0;
  const auto fitted =
      fit(run.runner.record(),
          {.high_Hz = 50, .longest_delay_s = 5e-3, .proceed = [&](int) { return ++asked < 2; }});
  ASSERT_FALSE(fitted);
  EXPECT_EQ(fitted.error().code, ExitCode::try_again);
  EXPECT_EQ(asked, 2);
}

// What holds an axis against its weight is found too.
TEST(Identify, WeightIsFound) {
  sim::DeviceOptions device = test::bench_axis(test::any_axis(4), 4);
  device.hand.script = {{.at_s = 0, .force_N = -0.8}};
  const auto run = test::run_bench(device, test::bench_excitation(Method::stepped));
  ASSERT_EQ(run.runner.ended(), Ended::complete) << run.runner.why();
  const auto fitted = fit(run.runner.record(), kFit);
  ASSERT_TRUE(fitted) << fitted.error().text;
  EXPECT_NEAR(fitted->value.bias, -0.8, fitted->half_width.bias);
  EXPECT_NEAR(fitted->value.mass, device.axes[0].mass_kg, fitted->half_width.mass);
}

TEST(Identify, TheFirstGuessIsNearAndNotTheTruth) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const sim::AxisOptions axis = test::any_axis(seed);
    const auto run =
        test::run_bench(test::bench_axis(axis, seed), test::bench_excitation(Method::stepped));
    const auto guess = first_guess(run.runner.record(), {50, 5e-3});
    ASSERT_TRUE(guess);
    EXPECT_NEAR(guess->mass / axis.mass_kg, 1, 0.1) << seed;
    EXPECT_NEAR(guess->viscous / axis.damping_Ns_m, 1, 0.3) << seed;
    EXPECT_NE(guess->mass, axis.mass_kg);
    EXPECT_NE(guess->delay_s, axis.delay_s);
  }
}

TEST(Identify, AnAxisThatStandsFastTellsNothing) {
  sim::AxisOptions axis = test::any_axis(1);
  axis.coulomb_N = 4;
  for (const double noise : {0.0, 0.5}) {
    axis.noise_counts = noise;
    const auto fitted = identified(axis, Method::stepped, 1);
    ASSERT_FALSE(fitted);
    EXPECT_THAT(fitted.error().text, testing::HasSubstr("hardly moved"));
  }
}

TEST(Identify, AShortRecordTellsNothing) {
  auto run =
      test::run_bench(test::bench_axis(test::any_axis(1)), test::bench_excitation(Method::stepped));
  Record record = run.runner.record();
  record.samples.resize(1200);
  const auto fitted = fit(record, kFit);
  ASSERT_FALSE(fitted);
  EXPECT_THAT(fitted.error().text, testing::HasSubstr("too short"));
  record.samples.clear();
  EXPECT_FALSE(fit(record, kFit));
}

}  // namespace
}  // namespace hapticd::identify
