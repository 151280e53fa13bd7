// What a held joint takes, against motions whose work is known in closed form.
#include "control/identify/held_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hapticd::identify {
namespace {

constexpr double kPeriod_s = 1e-3;

/// Both swing at 4 Hz; the hold of the second is spring and damper. 2 s.
HeldLoss swing(double own, double held, double damper) {
  HeldLoss loss(2, 0, kPeriod_s);
  const double w = 2 * std::numbers::pi * 4;
  for (int k = 0; k < 2000; ++k) {
    const double t = k * kPeriod_s, q = held * std::sin(w * t + 0.4);
    const double v = held * w * std::cos(w * t + 0.4);
    loss.tick(std::array{own * std::sin(w * t), q}, std::array{1.0, -30 * q - damper * v});
  }
  return loss;
}

TEST(HeldLoss, IsTheHoldsDamperByTheSquareOfTheMotions) {
  EXPECT_NEAR(swing(0.1, 0.02, 0.5).most(0, 0), 0.5 * 0.04, 1e-4);
  EXPECT_NEAR(swing(0.1, 0, 0.5).most(0, 0), 0, 1e-12);
  EXPECT_NEAR(swing(0.1, 0.02, 0).most(0, 0), 0, 1e-4);  // a spring takes nothing
}

TEST(HeldLoss, CountsTheFrictionThatHeldJointsAreTakenToHave) {
  const HeldLoss loss = swing(0.1, 0.02, 0);
  const double w = 2 * std::numbers::pi * 4;
  EXPECT_NEAR(loss.most(0.05, 0), 0.05 * 0.04, 1e-4);
  // mean |v_j| / mean v_i^2 of sines: (2/pi) held w / (own^2 w^2 / 2)
  const double slid = (2 / std::numbers::pi) * 0.02 * w / (0.5 * 0.01 * w * w);
  EXPECT_NEAR(loss.most(0, 0.002), 0.002 * slid, 0.03 * 0.002 * slid);
}

TEST(HeldLoss, WithoutMotionOrSamplesThereIsNone) {
  EXPECT_EQ(HeldLoss(2, 0, kPeriod_s).most(1, 1), 0);
  HeldLoss lost(2, 0, kPeriod_s);
  for (int k = 0; k < 100; ++k) lost.tick(std::array<double, 2>{NAN, NAN}, std::array{0.0, 0.0});
  EXPECT_EQ(lost.most(1, 1), 0);
}

}  // namespace
}  // namespace hapticd::identify
