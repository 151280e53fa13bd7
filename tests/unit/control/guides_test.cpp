// Reference: closed forms, and a search over all segments of a curve.
#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <vector>

#include "control/scene/shapes.h"

namespace hapticd::control {
namespace {

constexpr double kGuideEverywhere = std::numeric_limits<double>::infinity();

TEST(PointGuide, PullsFromWithinItsRangeOnly) {
  PointGuide guide{.at = {1, 2, 3}, .range = 0.06};
  const Nearest found = nearest(guide, {1, 2.03, 2.96});
  EXPECT_NEAR(found.depth, 0.05, 1e-15);
  EXPECT_LT(norm(found.normal - Vec3{0, -0.6, 0.8}), 1e-14);
  EXPECT_LT(norm(found.point - guide.at), 1e-15);
  EXPECT_LE(nearest(guide, {1, 2, 3.0601}).depth, 0);
  guide.range = kGuideEverywhere;
  EXPECT_EQ(nearest(guide, {1, 2, 1e6}).depth, 1e6 - 3);
  EXPECT_LE(nearest(guide, guide.at).depth, 0) << "already there";
}

TEST(LineGuide, PullsToItsSegmentAndPastItsEndsToThem) {
  const LineGuide guide{.centre = {0, 0, 1}, .axis = {1, 0, 0}, .half = 0.5, .range = 0.2};
  const Nearest beside = nearest(guide, {0.3, 0.1, 1});
  EXPECT_NEAR(beside.depth, 0.1, 1e-16);
  EXPECT_LT(norm(beside.point - Vec3{0.3, 0, 1}), 1e-16);
  const Nearest past = nearest(guide, {-0.53, 0, 1.04});
  EXPECT_NEAR(past.depth, 0.05, 1e-16);
  EXPECT_LT(norm(past.point - Vec3{-0.5, 0, 1}), 1e-16);
  EXPECT_LE(nearest(guide, {0, 0.21, 1}).depth, 0);
  EXPECT_LE(nearest(guide, {0.2, 0, 1}).depth, 0);
}

TEST(LineGuide, WithoutEndsPullsAtRightAnglesEverywhere) {
  const LineGuide guide{.axis = {0, 0, 1}, .half = kGuideEverywhere, .range = kGuideEverywhere};
  const Nearest found = nearest(guide, {0.3, 0.4, 1e3});
  EXPECT_NEAR(found.depth, 0.5, 1e-15);
  EXPECT_LT(norm(found.point - Vec3{0, 0, 1e3}), 1e-15);
}

/// A trefoil knot, so that parts of the curve that are far along it come near in space.
std::vector<Vec3> trefoil(int segments) {
  std::vector<Vec3> curve;
  for (int i = 0; i < segments; ++i) {
    const double t = 2 * std::numbers::pi * i / segments;
    curve.push_back({0.03 * (std::sin(t) + 2 * std::sin(2 * t)),
                     0.03 * (std::cos(t) - 2 * std::cos(2 * t)), -0.03 * std::sin(3 * t)});
  }
  curve.push_back(curve.front());
  return curve;
}

/// By the law of cosines and an area, not by a projection.
double distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const double ab = norm(b - a), ap = norm(p - a), bp = norm(p - b);
  const double along = (ap * ap - bp * bp + ab * ab) / (2 * ab);
  if (along <= 0) return ap;
  if (along >= ab) return bp;
  return norm(cross(b - a, p - a)) / ab;
}

double distance_to_all(const std::vector<Vec3>& curve, const Vec3& p) {
  double least = kGuideEverywhere;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i)
    least = std::min(least, distance_to_segment(curve[i], curve[i + 1], p));
  return least;
}

CurveGuide whole(const std::vector<Vec3>& curve, double range = kGuideEverywhere) {
  return {.first = 0, .count = static_cast<std::uint32_t>(curve.size()), .range = range};
}

TEST(CurveGuide, WalksAlongAllOfAClosedCurve) {
  const std::vector<Vec3> curve = trefoil(300);
  for (const bool backwards : {false, true}) {
    std::uint32_t segment = 0;
    for (int i = 0; i <= 7000; ++i) {  // twice around and a bit, 5 mm beside it
      const double at = (backwards ? 7000 - i : i) * 0.1;
      const auto k = static_cast<std::size_t>(at) % 300;
      const Vec3 point =
          curve[k] + (at - std::floor(at)) * (curve[k + 1] - curve[k]) + Vec3{0.003, 0.004, 0};
      const Nearest found = nearest(whole(curve), curve, point, segment);
      // In the hollow of a corner both segments are local answers, apart by less than the sagitta.
      const double least = distance_to_all(curve, point);
      ASSERT_GT(found.depth, least - 1e-15) << i;
      ASSERT_LT(found.depth, least + 5e-6) << i;
      ASSERT_NEAR(norm(found.point - point), found.depth, 1e-15);
    }
  }
}

TEST(CurveGuide, HoldsOnToItsPartOfTheCurveWhereAnotherComesNearer) {
  const std::vector<Vec3> hairpin{{0, 0, 0}, {1, 0, 0}, {1, 0.02, 0}, {0, 0.02, 0}};
  std::uint32_t segment = 0;
  EXPECT_EQ(nearest(whole(hairpin), hairpin, {0.5, 0.005, 0}, segment).normal, (Vec3{0, -1, 0}));
  EXPECT_EQ(segment, 1u);
  EXPECT_NEAR(nearest(whole(hairpin), hairpin, {0.5, 0.015, 0}, segment).depth, 0.015, 1e-16);
  segment = 0;  // not from here on, but anew
  EXPECT_NEAR(nearest(whole(hairpin), hairpin, {0.5, 0.015, 0}, segment).depth, 0.005, 1e-16);
  EXPECT_EQ(segment, 3u);
}

TEST(CurveGuide, StopsAtTheEndsOfAnOpenCurve) {
  const std::vector<Vec3> curve{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  std::uint32_t segment = 1;
  EXPECT_EQ(nearest(whole(curve), curve, {5, 0, 0}, segment).point, (Vec3{3, 0, 0}));
  EXPECT_EQ(segment, 3u);
  EXPECT_EQ(nearest(whole(curve), curve, {-4, 3, 0}, segment).depth, 5);
  EXPECT_EQ(segment, 1u);
}

TEST(CurveGuide, OutOfRangeItForgetsWhereItWas) {
  const std::vector<Vec3> hairpin{{0, 0, 0}, {1, 0, 0}, {1, 0.2, 0}, {0, 0.2, 0}};
  std::uint32_t segment = 0;
  EXPECT_GT(nearest(whole(hairpin, 0.03), hairpin, {0.5, 0.02, 0}, segment).depth, 0);
  EXPECT_LE(nearest(whole(hairpin, 0.03), hairpin, {0.5, 0.1, 0}, segment).depth, 0);
  EXPECT_NEAR(nearest(whole(hairpin, 0.03), hairpin, {0.5, 0.19, 0}, segment).depth, 0.01, 1e-16);
}

TEST(CurveGuide, IsOnlyItsOwnPartOfTheVertices) {
  const std::vector<Vec3> two{{0, 0, 0}, {1, 0, 0}, {0, 5, 0}, {1, 5, 0}, {2, 5, 0}};
  const CurveGuide second{.first = 2, .count = 3, .range = kGuideEverywhere};
  std::uint32_t segment = 0;
  EXPECT_EQ(nearest(second, two, {0.5, 0, 0}, segment).point, (Vec3{0.5, 5, 0}));
  EXPECT_EQ(segment, 1u);
  segment = 3;  // the curve has two segments only
  EXPECT_EQ(nearest(second, two, {1.5, 0, 0}, segment).point, (Vec3{1.5, 5, 0}));
  EXPECT_EQ(segment, 2u);
}

}  // namespace
}  // namespace hapticd::control
