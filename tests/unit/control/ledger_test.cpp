// The ledger against work summed by hand.
#include "control/guard/ledger.h"

#include <gtest/gtest.h>

#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using test::Rig;

/// One axis against a wall; the position of each tick is given, the work is summed beside it.
class Ledger : public testing::Test {
 protected:
  static build::ProgramSpec spec(std::uint16_t ticks = 0, double share = 0) {
    auto spec = test::spec_of(1);
    spec.planes = {test::wall(1000, 0)};
    spec.axes[0].delay_ticks = ticks;
    spec.axes[0].delay_share = share;
    return spec;
  }
  static double work(const Rig& rig) { return rig.program.state().work[0]; }
};

TEST_F(Ledger, BooksTheDeliveredEffortTimesTheWayOfItsPeriod) {
  Rig rig(spec());
  rig.enable_at(-1e-3);
  const double before = work(rig);
  const double effort = rig.program.state().effort[0];
  ASSERT_GT(effort, 0.5);
  rig.delivered[0] = 0.4;  // the device carried less than it was asked for
  rig.at(-1.25e-3);
  EXPECT_NEAR(work(rig) - before, 0.4 * -0.25e-3, 1e-18);
}

TEST_F(Ledger, LatencyMixesTheEffortsThatWereInForce) {
  Rig rig(spec(1, 0.25));
  rig.enable_at(0.1);  // out of contact: all efforts zero
  const double start = work(rig);
  const double efforts[] = {1, 2, 4, 8};
  double position = 0.1;
  double booked = start;
  for (int k = 0; k < 4; ++k) {
    rig.delivered[0] = efforts[k];
    position += 1e-3;
    rig.at(position);
    const double u1 = k >= 1 ? efforts[k - 1] : 0, u2 = k >= 2 ? efforts[k - 2] : 0;
    EXPECT_NEAR(work(rig) - booked, (0.75 * u1 + 0.25 * u2) * 1e-3, 1e-15) << k;
    booked = work(rig);
  }
}

TEST_F(Ledger, OverMissedTicksTheLastEffortWasHeld) {
  Rig rig(spec(0, 0.5));
  rig.enable_at(0.1);
  rig.delivered[0] = 1;
  rig.at(0.1);
  const double before = work(rig);
  rig.delivered[0] = 3;
  rig.input.missed_ticks = 3;
  rig.at(0.104);
  // Half a tick of 1 N, three and a half of 3 N, over 4 mm.
  EXPECT_NEAR(work(rig) - before, (0.5 * 1 + 3.5 * 3) / 4 * 4e-3, 1e-15);
}

TEST_F(Ledger, AHugeGapBooksTheHeldEffort) {
  Rig rig(spec());
  rig.enable_at(0.1);
  const double before = work(rig);
  rig.delivered[0] = 2;
  rig.input.missed_ticks = 1'000'000;
  rig.at(0.101);
  EXPECT_NEAR(work(rig) - before, 2e-3, 1e-15);
}

TEST_F(Ledger, SamplesThatDidNotComeAreBookedWithTheMeanEffortWhenOneComes) {
  Rig rig(spec());
  rig.enable_at(0.1);
  const double before = work(rig);
  rig.samples[0].freshness = Freshness::missing;
  rig.delivered[0] = 1;
  rig.run();
  EXPECT_EQ(work(rig), before);
  rig.samples[0].freshness = Freshness::missing;
  rig.delivered[0] = 2;
  rig.run();
  rig.delivered[0] = 6;
  rig.at(0.103);
  EXPECT_NEAR(work(rig) - before, 3.0 * 3e-3, 1e-15);
}

TEST_F(Ledger, DampingOverAGapIsThatOfTheMeanSpeed) {
  auto made = spec();
  made.axes[0].min_damping = 2;
  made.passivity_controllers = {{.device = 0, .budget = 1, .credit = 0.5, .rise = 1}};
  Rig rig(made);
  rig.enable_at(0.1);
  rig.input.missed_ticks = 3;
  rig.at(0.104);
  // 4 mm in four ticks are 1 m/s: 2 N s/m * (1 m/s)^2 * 4 ms.
  EXPECT_NEAR(rig.program.state().passivity_controllers[0].damped, 8e-3, 1e-12);
}

TEST_F(Ledger, AnEncoderThatJumpsDoesNoWork) {
  Rig rig(spec());
  rig.enable_at(-1e-3);
  const double before = work(rig);
  rig.delivered[0] = 4;
  rig.at(0.5);
  EXPECT_EQ(rig.program.state().fault.code, Fault::encoder_jump);
  EXPECT_EQ(work(rig), before);
}

TEST_F(Ledger, TheFirstSampleIsNoWay) {
  Rig rig(spec());
  rig.delivered[0] = 5;
  rig.at(0.5);
  EXPECT_EQ(work(rig), 0.0);
}

}  // namespace
}  // namespace hapticd::control
