// Frequency response and coherence, against systems whose answer is known.
#include "control/identify/response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/noise.h"
#include "tests/unit/identify/bench_axis.h"

namespace hapticd::identify {
namespace {

using Complex = std::complex<double>;

TEST(Response, AmplitudeOfASineOnASlopeIsExact) {
  for (const bool hann : {false, true}) {
    Signal signal;
    const Complex amplitude = std::polar(0.3, 1.1);
    for (int n = 0; n < 200; ++n) {
      const double turn = 2 * std::numbers::pi * n / 200;
      signal.push_back((amplitude * std::polar(1.0, turn)).real() + 5 + 0.01 * n);
    }
    EXPECT_LT(std::abs(coefficient(signal, 1, hann) - amplitude), 1e-12);
  }
}

// y = u + noise: coherence is the share of the power at that frequency that comes from u,
// |U|^2/(|U|^2 + |N|^2) with E|N|^2 = 4 sigma^2 / block.
TEST(Response, CoherenceIsTheShareOfTheInput) {
  constexpr int kBlocks = 2000, kTicks = 100;
  const Measured measured{
      .frequency_Hz = 50, .periods = 5, .begin = 0, .block_ticks = kTicks, .blocks = kBlocks};
  for (const double sigma : {0.0, 1.0, 3.0}) {
    sim::Noise noise(7, 0);
    Signal input, output;
    for (int n = 0; n < kBlocks * kTicks; ++n) {
      input.push_back(std::sin(2 * std::numbers::pi * 5 * n / kTicks));
      output.push_back(2 * input.back() + sigma * noise.normal());
    }
    const auto points = stepped_response(output, input, std::span(&measured, 1));
    const double share = 4 / (4 + 4 * sigma * sigma / kTicks);
    EXPECT_NEAR(points[0].coherence, share, 0.01) << sigma;
    EXPECT_NEAR(points[0].response.real(), 2, 0.03);
    EXPECT_EQ(points[0].stretches, kBlocks);
  }
}

TEST(Response, SignalsThatHaveNothingInCommonHaveNoCoherence) {
  const Measured measured{.frequency_Hz = 20, .begin = 0, .block_ticks = 50, .blocks = 400};
  sim::Noise noise(7, 0);
  Signal input, output;
  for (std::size_t n = 0; n < measured.ticks(); ++n) {
    input.push_back(noise.normal());
    output.push_back(noise.normal());
  }
  EXPECT_LT(stepped_response(output, input, std::span(&measured, 1))[0].coherence, 0.02);
}

/// Position at the samples per held effort: z-transform of mass and damper behind a hold, with a
/// delay within a period (modified z-transform).
Complex sampled_axis(const sim::AxisOptions& axis, double frequency_Hz, double period_s) {
  const double rate = axis.damping_Ns_m / axis.mass_kg;
  const auto velocity = [&](double s) { return -std::expm1(-rate * s) / axis.damping_Ns_m; };
  const auto way = [&](double s) { return s / axis.damping_Ns_m - velocity(s) / rate; };
  const double rest_s = period_s - axis.delay_s;  // what of a period the newest effort acts
  const Complex z = std::polar(1.0, 2 * std::numbers::pi * frequency_Hz * period_s);
  const double decay = std::exp(-rate * period_s);
  const Complex v_new = velocity(rest_s), v_old = velocity(axis.delay_s) * std::exp(-rate * rest_s);
  const Complex v = (v_new + v_old / z) / (z - decay);
  const double drift = -std::expm1(-rate * period_s) / rate;
  const double fall_old =
      way(axis.delay_s) + velocity(axis.delay_s) * -std::expm1(-rate * rest_s) / rate;
  return (drift * v + way(rest_s) + fall_old / z) / (z - 1.0);
}

TEST(Response, OfAMassAndADamperIsThatOfItsSampledModel) {
  const sim::AxisOptions axis{
      .mass_kg = 0.05, .damping_Ns_m = 1.37, .delay_s = 0.0006, .max_effort_N = 8};
  const test::BenchRun run =
      test::run_bench(test::bench_axis(axis), test::bench_excitation(Method::stepped));
  const Record& record = run.runner.record();
  const auto points = stepped_response(positions(record), efforts(record), run.runner.measured());
  ASSERT_EQ(points.size(), 8u);
  for (const ResponsePoint& point : points) {
    const Complex expected = sampled_axis(axis, point.frequency_Hz, record.period_s);
    EXPECT_LT(std::abs(point.response / expected - 1.0), 0.02) << point.frequency_Hz;
    EXPECT_GT(point.coherence, 0.999);
  }
}

TEST(Response, AChirpTellsTheSame) {
  const sim::AxisOptions axis{
      .mass_kg = 0.05, .damping_Ns_m = 1.37, .delay_s = 0.0006, .max_effort_N = 8};
  const test::BenchRun run =
      test::run_bench(test::bench_axis(axis), test::bench_excitation(Method::chirp));
  const Record& record = run.runner.record();
  for (const ResponsePoint& point :
       chirp_response(positions(record), efforts(record),
                      {.low_Hz = 3, .high_Hz = 40, .points = 8, .period_s = record.period_s})) {
    const Complex expected = sampled_axis(axis, point.frequency_Hz, record.period_s);
    EXPECT_LT(std::abs(point.response / expected - 1.0), 0.1) << point.frequency_Hz;
    EXPECT_GT(point.coherence, 0.95) << point.frequency_Hz;
  }
}

}  // namespace
}  // namespace hapticd::identify
