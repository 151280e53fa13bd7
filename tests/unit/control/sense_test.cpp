#include "control/motion/sense.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using test::Rig;
using test::spec_of;

TEST(Sense, VelocityIsTheBackwardDifference) {
  Rig rig(spec_of(1));
  rig.at(0.001);
  EXPECT_EQ(rig.program.state().qd[0], 0.0) << "nothing to take a difference with yet";
  rig.at(0.0015);
  EXPECT_NEAR(rig.program.state().q[0], 0.0015, 1e-15);
  EXPECT_NEAR(rig.program.state().qd[0], 0.5, 1e-12);
}

TEST(Sense, CounterJustBelowZeroStartsJustBelowZero) {
  Rig rig(spec_of(1));
  rig.samples[0].raw = 4294967295.0;
  rig.again();
  EXPECT_NEAR(rig.program.state().q[0], -1e-6, 1e-18);
}

TEST(Sense, WrappedCounterMovesOnWithoutAStep) {
  auto spec = spec_of(1);
  spec.axes[0].modulus_raw = 256;
  Rig rig(spec);
  double q = 0;
  rig.samples[0].raw = 0;
  rig.again();
  for (int i = 1; i < 1000; ++i) {  // 7 counts a tick: many turns of an 8 bit counter
    rig.samples[0].raw = (i * 7) % 256;
    rig.again();
    q = rig.program.state().q[0];
    ASSERT_NEAR(q, i * 7e-6, 1e-15);
    ASSERT_NEAR(rig.program.state().qd[0], 7e-3, 1e-12);
  }
  for (int i = 998; i > -1000; --i) {  // and back, below zero
    rig.samples[0].raw = ((i * 7) % 256 + 256) % 256;
    rig.again();
    ASSERT_NEAR(rig.program.state().q[0], i * 7e-6, 1e-15);
  }
}

TEST(Sense, NoDifferenceIsTakenOverMissedTicks) {
  Rig rig(spec_of(1));
  rig.at(0);
  rig.input.missed_ticks = 2;
  const TickOutput output = rig.at(0.003);
  EXPECT_EQ(rig.program.state().qd[0], 0.0);
  EXPECT_NEAR(rig.program.state().q[0], 0.003, 1e-15);
  EXPECT_TRUE(output.limits.has(Limit::reseeded));
  rig.input.missed_ticks = 0;
  rig.at(0.0031);
  EXPECT_NEAR(rig.program.state().qd[0], 0.1, 1e-12);
}

TEST(Sense, MissingSampleIsHeldAndNoDifferenceTakenOverIt) {
  Rig rig(spec_of(1));
  rig.at(0);
  rig.at(0.0001);
  rig.samples[0] = {.raw = 1e9, .freshness = Freshness::missing};
  EXPECT_TRUE(rig.run().limits.has(Limit::sample_held));
  EXPECT_NEAR(rig.program.state().q[0], 0.0001, 1e-15);
  const TickOutput output = rig.at(0.0003);
  EXPECT_TRUE(output.limits.has(Limit::reseeded));
  EXPECT_EQ(rig.program.state().qd[0], 0.0);
}

TEST(Sense, DeviceThatComesBackCountsFromElsewhere) {
  auto spec = spec_of(1);
  spec.axes[0].modulus_raw = 65536;
  Rig rig(spec);
  rig.samples[0].raw = 30000;
  rig.again();
  rig.samples[0].raw = 40000;  // past half of the range: counted on
  rig.again();
  EXPECT_NEAR(rig.program.state().q[0], 40000e-6, 1e-12);
  rig.samples[0].freshness = Freshness::missing;
  rig.run();
  rig.samples[0] = {.raw = 65535, .freshness = Freshness::first};
  const TickOutput output = rig.run();
  EXPECT_NEAR(rig.program.state().q[0], -1e-6, 1e-12) << "as if it had just been connected";
  EXPECT_EQ(rig.program.state().qd[0], 0.0);
  EXPECT_EQ(output.fault.code, Fault::none);
  EXPECT_FALSE(rig.program.state().ledger[0].known && rig.program.state().ledger[0].moved != 0)
      << "it did no work on the way";
}

TEST(Sense, ReversedEncoderWithOffset) {
  auto spec = spec_of(1);
  spec.axes[0].unit_per_raw = -1e-6;
  spec.axes[0].offset = 0.5;
  Rig rig(spec);
  rig.samples[0].raw = 1000;
  rig.again();
  EXPECT_NEAR(rig.program.state().q[0], 0.499, 1e-15);
}

TEST(Sense, NotANumberWhileIdleIsNoFaultAndIsForgotten) {
  Rig rig(spec_of(1));
  rig.at(0.001);
  rig.samples[0].raw = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(rig.again().fault.code, Fault::none);
  rig.at(0.001);
  EXPECT_NEAR(rig.program.state().q[0], 0.001, 1e-15);
  EXPECT_EQ(rig.at(0.001).fault.code, Fault::none);
}

}  // namespace
}  // namespace hapticd::control
