#include "sim/noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hapticd::sim {
namespace {

TEST(Noise, HasMeanZeroAndDeviationOne) {
  constexpr int kDraws = 200'000;
  Noise noise(1, 0);
  double sum = 0, squares = 0, largest = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double value = noise.normal();
    sum += value;
    squares += value * value;
    largest = std::max(largest, std::abs(value));
  }
  EXPECT_NEAR(sum / kDraws, 0, 5 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1, 5 * std::sqrt(2.0 / kDraws));
  EXPECT_GT(largest, 3.5);
  EXPECT_LE(largest, 6);
}

TEST(Noise, TwoThirdsLieWithinOneDeviation) {
  Noise noise(7, 3);
  int within = 0;
  for (int i = 0; i < 100'000; ++i) within += std::abs(noise.normal()) < 1;
  EXPECT_NEAR(within / 1e5, 0.6827, 0.01);
}

double correlation(Noise a, Noise b) {
  double sum = 0;
  for (int i = 0; i < 10'000; ++i) sum += a.normal() * b.normal();
  return sum / 10'000;
}

TEST(Noise, StreamsAndSeedsAreIndependent) {
  EXPECT_NEAR(correlation(Noise(1, 0), Noise(1, 0)), 1, 0.1);
  EXPECT_NEAR(correlation(Noise(1, 0), Noise(1, 1)), 0, 0.05);
  EXPECT_NEAR(correlation(Noise(1, 0), Noise(2, 0)), 0, 0.05);
  EXPECT_NEAR(correlation(Noise(1, 1), Noise(2, 0)), 0, 0.05);
}

// The engine is fixed by the C++ standard and the rest is integer arithmetic: these are the same
// bits everywhere.
TEST(Noise, IsTheSameOnEveryMachine) {
  Noise noise(1, 0);
  const double first = noise.normal(), second = noise.normal();
  EXPECT_EQ(first * 65536 * 2, std::round(first * 65536 * 2));
  EXPECT_EQ(first, 1.442596435546875);
  EXPECT_EQ(second, -0.11480712890625);
}

}  // namespace
}  // namespace hapticd::sim
