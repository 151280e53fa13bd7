#include "sim/converters.h"

#include <gtest/gtest.h>

#include <limits>

namespace hapticd::sim {
namespace {

TEST(Encoder, RoundsDownOnBothSidesOfZero) {
  const Encoder encoder({.counts_per_m = 1000, .encoder_bits = 0});
  EXPECT_EQ(encoder.counts(0, 0), 0);
  EXPECT_EQ(encoder.counts(0.0019, 0), 1);
  EXPECT_EQ(encoder.counts(-0.0001, 0), -1);
  EXPECT_EQ(encoder.counts(0.0019, 0.2), 2) << "noise comes before rounding";
}

TEST(Encoder, WrapsIntoItsBits) {
  const Encoder encoder({.counts_per_m = 1000, .encoder_bits = 4});
  EXPECT_EQ(encoder.counts(0.0155, 0), 15);
  EXPECT_EQ(encoder.counts(0.0165, 0), 0);
  EXPECT_EQ(encoder.counts(-0.0005, 0), 15);
  EXPECT_EQ(encoder.counts(-0.0165, 0), 15);
  EXPECT_EQ(encoder.counts(1.6015, 0), 1);
}

TEST(Encoder, NegativeCountsAreAReversedEncoder) {
  const Encoder encoder({.counts_per_m = -1000, .encoder_bits = 32});
  EXPECT_EQ(encoder.counts(-0.0025, 0), 2);
  EXPECT_EQ(encoder.counts(0.0015, 0), 4294967296.0 - 2);
  EXPECT_EQ(encoder.counts(0, 0), 0);
}

TEST(Amplifier, SaturatesAndOtherwiseCarriesExactlyWithoutSteps) {
  const Amplifier amplifier({.max_effort_N = 8});
  EXPECT_EQ(amplifier.carried_N(3.14159), 3.14159);
  EXPECT_EQ(amplifier.carried_N(9), 8);
  EXPECT_EQ(amplifier.carried_N(-std::numeric_limits<double>::infinity()), -8);
}

TEST(Amplifier, RoundsToItsStepsTheSameWayOnBothSides) {
  const Amplifier amplifier({.dac_step_N = 0.25, .max_effort_N = 8});
  EXPECT_EQ(amplifier.carried_N(0.124), 0);
  EXPECT_EQ(amplifier.carried_N(0.125), 0.25);
  EXPECT_EQ(amplifier.carried_N(-0.125), -0.25);
  EXPECT_EQ(amplifier.carried_N(1.1), 1);
}

TEST(Amplifier, NeverRoundsBeyondItsRange) {
  const Amplifier coarse({.dac_step_N = 0.3, .max_effort_N = 1});
  EXPECT_DOUBLE_EQ(coarse.carried_N(100), 0.9);
  const Amplifier even({.dac_step_N = 0.1, .max_effort_N = 8});
  EXPECT_DOUBLE_EQ(even.carried_N(100), 8) << "8 / 0.1 is below 80 in binary";
}

TEST(Amplifier, CarriesNothingForWhatIsNotANumber) {
  const Amplifier amplifier({.max_effort_N = 8});
  EXPECT_EQ(amplifier.carried_N(std::numeric_limits<double>::quiet_NaN()), 0);
}

}  // namespace
}  // namespace hapticd::sim
