#include "daemon/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace hapticd::daemon {
namespace {

TEST(Histogram, EveryEdgeIsTheLastValueOfItsBucket) {
  for (std::size_t i = 0; i + 1 < Histogram::kBuckets; ++i) {
    const std::uint64_t edge = Histogram::upper_edge(i);
    ASSERT_EQ(Histogram::index(edge), i);
    ASSERT_EQ(Histogram::index(edge + 1), i + 1);
  }
}

TEST(Histogram, ABucketIsNeverWiderThanAThirtySecondOfItsValues) {
  for (std::size_t i = 1; i + 1 < Histogram::kBuckets; ++i) {
    const std::uint64_t lowest = Histogram::upper_edge(i - 1) + 1;
    const std::uint64_t error = Histogram::upper_edge(i) - lowest;
    ASSERT_LE(error * 32, lowest) << "bucket " << i;
  }
}

TEST(Histogram, SmallValuesAreExact) {
  Histogram histogram;
  for (int ns = 0; ns < 64; ++ns) histogram.add(ns);
  EXPECT_EQ(histogram.percentile_ns(0.5), 32u);
  EXPECT_EQ(histogram.percentile_ns(0), 0u);
  EXPECT_EQ(histogram.percentile_ns(1), 63u);
}

TEST(Histogram, EmptyGivesZero) {
  const Histogram histogram;
  EXPECT_EQ(histogram.percentile_ns(0.5), 0u);
  EXPECT_EQ(histogram.percentile_ns(1), 0u);
  EXPECT_EQ(histogram.max_ns(), 0u);
}

TEST(Histogram, NegativeCountsAsZero) {
  Histogram histogram;
  histogram.add(-5);
  EXPECT_EQ(histogram.count(), 1u);
  EXPECT_EQ(histogram.percentile_ns(1), 0u);
}

TEST(Histogram, WhatIsBeyondTheLastBucketIsReportedAsTheMaximum) {
  Histogram histogram;
  constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  histogram.add(1000);
  histogram.add(kHour_ns);
  EXPECT_EQ(histogram.percentile_ns(1), static_cast<std::uint64_t>(kHour_ns));
  EXPECT_EQ(histogram.percentile_ns(0.5), static_cast<std::uint64_t>(kHour_ns));
  EXPECT_LT(histogram.percentile_ns(0), 1032u);
}

/// Durations like a loop's: mostly short, some long by decades.
std::vector<std::int64_t> durations(std::size_t n, double spread) {
  std::mt19937_64 random(7);
  std::lognormal_distribution<double> value(std::log(20'000.0), spread);
  std::vector<std::int64_t> values(n);
  for (std::int64_t& v : values) v = static_cast<std::int64_t>(value(random));
  return values;
}

TEST(Histogram, PercentilesAgreeWithSortedValuesToAThirtySecond) {
  for (const double spread : {0.1, 1.0, 3.0}) {
    std::vector<std::int64_t> values = durations(10'007, spread);
    Histogram histogram;
    for (const std::int64_t v : values) histogram.add(v);
    std::sort(values.begin(), values.end());
    for (const double share : {0.0, 0.01, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0}) {
      const auto position = static_cast<std::size_t>(share * static_cast<double>(values.size()));
      const auto exact = static_cast<double>(values[std::min(position, values.size() - 1)]);
      const auto found = static_cast<double>(histogram.percentile_ns(share));
      EXPECT_GE(found, exact) << "share " << share;
      EXPECT_LE(found, exact * (1 + 1.0 / 32)) << "share " << share;
    }
    EXPECT_EQ(histogram.max_ns(), static_cast<std::uint64_t>(values.back()));
  }
}

}  // namespace
}  // namespace hapticd::daemon
