#include "sim/time_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hapticd::sim {
namespace {

// At any time t of a period, the command that acts is the latest that is at least `delay` old.
TEST(TimeGrid, EveryAxisHasTheCommandThatItsDelayLetsThrough) {
  const std::vector<double> delays_s = {0, 0.0001, 0.00025, 0.0009999999, 0.001, 0.00314};
  const std::vector<Segment> segments = cut_period({1e-3, 4}, delays_s);
  double begin_s = 0;
  int substep = 0;
  for (const Segment& segment : segments) {
    EXPECT_NEAR(segment.begin_s, begin_s, 1e-15) << "without gaps";
    ASSERT_GT(segment.end_s, segment.begin_s);
    const double middle_s = substep * 0.25e-3 + (segment.begin_s + segment.end_s) / 2;
    for (std::size_t i = 0; i < delays_s.size(); ++i) {
      const double age = std::max(0.0, std::ceil((delays_s[i] - middle_s) / 1e-3));
      EXPECT_EQ(segment.effort_age[i], age) << "delay " << delays_s[i] << " at " << middle_s;
    }
    begin_s = segment.last ? 0 : segment.end_s;
    substep += segment.last;
  }
  EXPECT_EQ(substep, 4);
  EXPECT_EQ(segments.size(), 4u + 3u) << "0.25 ms cuts nothing, 0.1, 0.14 and 0.9999999 ms do";
}

TEST(TimeGrid, ATickIsTheFirstAtOrAfterItsTime) {
  EXPECT_EQ(tick_at(0, 1e-3), 0);
  EXPECT_EQ(tick_at(0.3, 1e-3), 300);  // 0.3 / 0.001 is more in binary
  EXPECT_EQ(tick_at(0.3001, 1e-3), 301);
}

}  // namespace
}  // namespace hapticd::sim
