// What a box of devices does in a period, enclosed: against the matrix exponential of devices in it.
#include "control/design/check/held_box.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "control/design/check/sampled_loop.h"
#include "tests/support/paper2.h"
#include "tests/support/period.h"

namespace hapticd::test {
namespace {

using check::HeldBox;
using check::HeldRange;

/// (Phi, Gamma before, Gamma after) of one device, from its matrix exponentials.
HeldRange::Gains gains_of(const std::array<double, 4>& at) {
  const check::LoopCase one{.mass_kg = 1 / at[0], .damping_Ns_m = at[1], .hand_N_m = at[2]};
  const check::Held whole = held_device(one, kPeriod_s),
                    after = held_device(one, kPeriod_s - at[3]);
  HeldRange::Gains gains;
  gains << whole.phi, whole.gamma - after.gamma, after.gamma;
  return gains;
}

HeldBox random_cell(std::mt19937& random) {
  std::uniform_real_distribution<double> one(0, 1);
  const double width = std::pow(10, -4 * one(random));
  const double g = std::pow(10, 2.5 * one(random)), b = std::pow(10, 2 - 3 * one(random)) / g;
  const double k = one(random) < 0.3 ? 0 : std::pow(10, 5 - 3 * one(random)) / g;
  const double t = one(random) < 0.3 ? 0 : 0.5e-3 * one(random);
  const auto side = [&](double low) { return check::Interval(low, low * (1 + width)); };
  return {side(g), side(b), side(k), check::Interval(t, t + 0.5e-3 * width * one(random))};
}

TEST(HeldBox, EnclosesEveryDeviceInIt) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> one(0, 1);
  for (int trial = 0; trial < 300; ++trial) {
    const HeldBox cell = random_cell(random);
    const auto range = check::held_range(cell, kPeriod_s);
    ASSERT_TRUE(range) << trial;
    for (int point = 0; point < 20; ++point) {
      std::array<double, 4> at{};
      HeldRange::Gains affine = range->centre;
      for (std::size_t i = 0; i < 4; ++i) {
        const double share = point < 16 ? (point >> i & 1) : one(random);
        at[i] = cell[i].low + share * (cell[i].high - cell[i].low);
        affine += (2 * share - 1) * range->half[i];
      }
      const HeldRange::Gains off = (gains_of(at) - affine).cwiseAbs();
      // The exponential that it is held against is rounded, too.
      const HeldRange::Gains allowed =
          range->remainder + 1e-13 * gains_of(at).cwiseAbs() + HeldRange::Gains::Constant(1e-16);
      EXPECT_TRUE((off.array() <= allowed.array()).all()) << trial << '\n'
                                                          << off << '\n'
                                                          << allowed;
    }
  }
}

TEST(HeldBox, RemainderIsOfSecondOrder) {
  const auto size_of = [](double width) {
    const HeldBox cell = {
        check::Interval(100, 100 * (1 + width)), check::Interval(0.5, 0.5 + width),
        check::Interval(800, 800 * (1 + width)), check::Interval(0, 1e-4 * width)};
    return check::held_range(cell, kPeriod_s)->remainder.norm();
  };
  EXPECT_NEAR(size_of(0.1) / size_of(0.05), 4, 0.3);
  EXPECT_LT(size_of(0), 1e-11);
}

TEST(HeldBox, GivesUpOnDevicesThatAreTooFastForASeries) {
  EXPECT_FALSE(check::held_range({check::Interval(1e6), check::Interval(100), 0, 0}, kPeriod_s));
  EXPECT_FALSE(
      check::held_range({check::Interval(std::nan("")), check::Interval(1), 0, 0}, kPeriod_s));
}

}  // namespace
}  // namespace hapticd::test
