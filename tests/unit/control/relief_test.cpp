// Reference: a search over the graph that the centre of a ball can go down to,
//
//   E(u) = max over |d| <= r of height(u + d) + sqrt(r^2 - d^2)
//
// which knows nothing of normals, half waves or Newton; and closed forms on crests and in grooves.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <random>

#include "control/scene/shapes.h"

namespace hapticd::control {
namespace {

using std::numbers::pi;

/// By golden sections, where there is one minimum only.
double least_between(double low, double high, const std::function<double(double)>& f) {
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  for (int i = 0; i < 70; ++i) {
    const double left = high - ratio * (high - low), right = low + ratio * (high - low);
    if (f(left) < f(right))
      high = right;
    else
      low = left;
  }
  return f((low + high) / 2);
}

/// The least value of f between a and b: every dip of a grid is looked into.
double least(double a, double b, int grid, const std::function<double(double)>& f) {
  const double step = (b - a) / grid;
  double best = std::min(f(a), f(b));
  double before = f(a), here = f(a + step);
  for (int i = 1; i < grid; ++i) {
    const double after = f(a + (i + 1) * step), at = a + i * step;
    if (here <= before && here <= after)
      best = std::min(best, least_between(at - step, at + step, f));
    before = here;
    here = after;
  }
  return best;
}

struct Ripple {
  double amplitude, wavelength;
  Relief::Profile profile;
  Relief relief() const {
    return {.normal = {0, 0, 1},
            .along = {1, 0, 0},
            .amplitude = amplitude,
            .wavelength = wavelength,
            .profile = profile};
  }
  double height(double u) const {
    const double s = 2 * pi * u / wavelength;
    return profile == Relief::Profile::sinusoid ? amplitude * std::sin(s)
                                                : amplitude * std::min(0.0, std::cos(s));
  }
  double envelope(double u, double r) const {
    if (r == 0) return height(u);
    const int grid = 60 + static_cast<int>(60 * r / wavelength);
    // By angle around the ball, where the ball's own outline is smooth.
    return -least(-pi / 2, pi / 2, grid,
                  [&](double a) { return -height(u + r * std::sin(a)) - r * std::cos(a); });
  }
  /// Distance from a place below E to what lies above E.
  double depth(double u, double w, double r) const {
    const double lift = envelope(u, r) - w;
    return least(u - lift, u + lift, 120,
                 [&](double c) { return std::hypot(c - u, std::max(0.0, envelope(c, r) - w)); });
  }
};

class ReliefSearch : public ::testing::TestWithParam<Ripple> {};

TEST_P(ReliefSearch, NoFreePointIsNearerAndTheAnswerIsFree) {
  const Ripple& ripple = GetParam();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  int met = 0;
  for (const double r : {0.0, 0.2, 1.5}) {
    for (int i = 0; i < 12; ++i) {
      const double radius = r * ripple.wavelength;
      const double u = ripple.wavelength * (4 * share(random) - 2);
      const double top = ripple.envelope(u, radius);
      const double w = top - std::pow(share(random), 2) * 3 * ripple.amplitude;
      const Vec3 point{u, 0.3, w}, from{u + 0.1 * ripple.wavelength, 0.3, top};
      const Nearest found = nearest(ripple.relief(), point, from, radius);
      const double tolerance = 1e-9 * ripple.wavelength;
      EXPECT_NEAR(found.depth, ripple.depth(u, w, radius), tolerance) << u << ' ' << w;
      if (!(found.depth > 0)) continue;
      ++met;
      EXPECT_GT(found.point.z, ripple.envelope(found.point.x, radius) - tolerance);
      EXPECT_NEAR(norm(found.normal), 1, 1e-15);
      EXPECT_EQ(found.point.y, 0.3);
    }
  }
  EXPECT_GT(met, 30);
}

INSTANTIATE_TEST_SUITE_P(Ripples, ReliefSearch,
                         ::testing::Values(Ripple{1e-4, 1e-3, Relief::Profile::sinusoid},
                                           Ripple{1e-3, 1e-3, Relief::Profile::sinusoid},
                                           Ripple{2e-5, 1e-2, Relief::Profile::sinusoid},
                                           Ripple{1e-4, 1e-3, Relief::Profile::groove},
                                           Ripple{1e-3, 1e-3, Relief::Profile::groove},
                                           Ripple{2e-5, 1e-2, Relief::Profile::groove}));

TEST(ReliefShape, WithoutAmplitudeIsAPlane) {
  const Relief flat{.normal = {0, 0.6, 0.8}, .along = {1, 0, 0}, .offset = 0.1, .wavelength = 1e-3};
  const Vec3 point{0.37, 0.06, 0.07};
  const Nearest found = nearest(flat, point, point, 0.005);
  EXPECT_NEAR(found.depth, 0.1 + 0.005 - 0.092, 1e-16);
  EXPECT_LT(norm(found.normal - flat.normal), 1e-14);
}

TEST(ReliefShape, TheWayOutOfAWaveEndsOnItAtARightAngle) {
  const Relief wave{.normal = {0, 0, 1}, .along = {1, 0, 0}, .amplitude = 1e-4, .wavelength = 1e-3};
  const double k = 2 * pi / 1e-3;
  for (int i = 0; i < 500; ++i) {
    const double u = -2e-3 + i * 8.3e-6;
    for (const double below : {1e-7, 1e-4, 1e-3}) {
      const Vec3 point{u, 0, 1e-4 * std::sin(k * u) - below};
      const Nearest found = nearest(wave, point, {u + 3e-4, 0, 0}, 0);
      EXPECT_NEAR(found.point.z, 1e-4 * std::sin(k * found.point.x), 1e-17);
      EXPECT_NEAR(found.normal.x + found.normal.z * 0.1e-3 * k * std::cos(k * found.point.x), 0,
                  1e-12);
    }
  }
}

TEST(ReliefShape, OnCrestsAndInTroughsTheWayIsStraightUp) {
  const Relief wave{.normal = {0, 0, 1}, .along = {0, 1, 0}, .amplitude = 1e-4, .wavelength = 4e-3};
  for (int i = -3; i <= 3; ++i) {  // a shallow place: 4 mm waves of 0.1 mm curve with 4 mm
    const Nearest crest = nearest(wave, {0, (i + 0.25) * 4e-3, -1e-3}, {}, 0.002);
    EXPECT_NEAR(crest.depth, 3.1e-3, 1e-16);
    EXPECT_NEAR(crest.normal.z, 1, 1e-15);
    const Nearest trough = nearest(wave, {0, (i + 0.75) * 4e-3, -1e-3}, {}, 0.002);
    EXPECT_NEAR(trough.depth, 2.9e-3, 1e-16);
    EXPECT_NEAR(trough.normal.z, 1, 1e-15);
  }
}

TEST(ReliefShape, DeepUnderACrestTheWayBackIsTheWayOut) {
  const Relief wave{.normal = {0, 0, 1}, .along = {1, 0, 0}, .amplitude = 1e-3, .wavelength = 4e-3};
  const Vec3 deep{1e-3, 0, -3e-3};
  const Nearest left = nearest(wave, deep, {0.5e-3, 0, 0}, 0);
  const Nearest right = nearest(wave, deep, {1.5e-3, 0, 0}, 0);
  EXPECT_LT(left.point.x, 1e-3);
  EXPECT_NEAR(left.point.x - 1e-3, 1e-3 - right.point.x, 1e-12);
  EXPECT_NEAR(left.depth, right.depth, 1e-15);
  EXPECT_LT(left.depth, 3.9e-3) << "the crest itself is 4 mm away";
  EXPECT_NEAR(nearest(wave, deep, {1e-3, 0, 1e-3}, 0).depth, left.depth, 1e-15) << "from the crest";
}

const Relief kGrooves{.normal = {0, 0, 1},
                      .along = {1, 0, 0},
                      .amplitude = 1e-3,
                      .wavelength = 4e-3,
                      .profile = Relief::Profile::groove};

TEST(ReliefShape, ABallRestsOnBothEdgesOfAGroove) {
  const double r = 5e-3, rest = std::sqrt(r * r - 1e-6);  // edges 1 mm left and right
  for (const double aside : {-2e-4, 0.0, 1e-4}) {
    const Nearest found = nearest(kGrooves, {2e-3 + aside, 0, rest - 2e-3}, {}, r);
    EXPECT_LT(norm(found.point - Vec3{2e-3, 0, rest}), 1e-16) << aside;
    EXPECT_NEAR(found.depth, std::hypot(aside, 2e-3), 1e-16);
  }
}

TEST(ReliefShape, ABallRollsOverTheEdgeOfAGroove) {
  const double r = 0.2e-3;  // 2 um above the edge, a little into the groove
  const Nearest found = nearest(kGrooves, {1e-3 + 6e-5, 0, 8e-5}, {}, r);
  EXPECT_NEAR(found.depth, 1e-4, 1e-16);
  EXPECT_LT(norm(found.normal - Vec3{0.6, 0, 0.8}), 1e-12);
}

TEST(ReliefShape, UnderTheFlatTheGrooveIsTheWayOutWhereItIsNearer) {
  EXPECT_EQ(nearest(kGrooves, {0.5e-3, 0, -0.4e-3}, {}, 0).normal.z, 1);
  const Nearest aside = nearest(kGrooves, {0.98e-3, 0, -0.5e-3}, {}, 0);
  EXPECT_GT(aside.normal.x, 0.5);
  EXPECT_NEAR(aside.point.z, 1e-3 * std::cos(pi / 2 * aside.point.x / 1e-3), 1e-12);
}

}  // namespace
}  // namespace hapticd::control
