// RMS errors of the velocity estimators, through step(), against figures computed elsewhere
// (tests/data/paper2/velocity_rms.inc).
//
// Where on the encoder's grid those paths start is not published; the error depends on it. The
// ramp's start follows from its eight rows without estimator, and every row is then exact. For sine
// and contact a published figure has to be one of those that starts along one count give.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "control/build/filters.h"
#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using test::Rig;

struct Row {
  std::string estimator;
  int bits;
  double rms_m_s[3];
};
const Row kRows[] = {
#include "tests/data/paper2/velocity_rms.inc"
};

struct Path {
  std::vector<double> x, v;
};

constexpr std::size_t kSkip = 100;  // ticks at the start that the error is not taken over

Path ramp() {
  Path path;
  for (int k = 0; k < 2000; ++k) {
    path.x.push_back(80.8e-6 + 5e-3 * 1e-3 * k);
    path.v.push_back(5e-3);
  }
  return path;
}

Path sine() {
  Path path;
  for (int k = 0; k < 2000; ++k) {
    const double angle = 2 * M_PI * 5 * 1e-3 * k;
    path.x.push_back(0.01 * std::sin(angle));
    path.v.push_back(0.01 * 2 * M_PI * 5 * std::cos(angle));
  }
  return path;
}

/// 150 ms towards the wall, which then holds on to the mass.
Path contact() {
  Path path;
  double x = -0.03, v = 0.2;
  constexpr double kStep_s = 1e-6;
  for (int k = 0; k < 300; ++k) {
    path.x.push_back(x);
    path.v.push_back(v);
    for (int i = 0; i < 1000; ++i) {
      if (k >= 150) v -= (1000 * x + 5 * v) / 0.2 * kStep_s;
      x += v * kStep_s;
    }
  }
  return path;
}

build::ProgramSpec spec_with(const std::string& estimator, double count_m) {
  build::ProgramSpec spec = test::spec_of(1);
  spec.axes[0].unit_per_raw = count_m;
  const auto parameter = [&] { return std::stod(estimator.substr(estimator.rfind('_') + 1)); };
  const auto window = [&] { return static_cast<std::uint16_t>(parameter()); };
  if (estimator.starts_with("low_pass")) spec.low_passes = {build::low_pass(0, parameter(), 1e-3)};
  if (estimator.starts_with("linear"))
    spec.least_squares = {build::least_squares(0, window(), 1, 1e-3)};
  if (estimator.starts_with("quadratic"))
    spec.least_squares = {build::least_squares(0, window(), 2, 1e-3)};
  if (estimator.starts_with("foaw")) {
    const auto samples = static_cast<std::uint16_t>(window() + 1);  // published: intervals
    spec.foaws = {build::foaw(0, samples, count_m)};
  }
  if (estimator.starts_with("tracking"))
    spec.alpha_beta_gammas = {build::alpha_beta_gamma(0, parameter(), 1e-3)};
  return spec;
}

double rms_error(const Row& row, const Path& path, double start_m = 0) {
  const double count_m = 0.2 * 2 * M_PI / std::ldexp(1.0, row.bits);
  Rig rig(spec_with(row.estimator, count_m));
  double sum = 0;
  for (std::size_t k = 0; k < path.x.size(); ++k) {
    const double counts = std::floor((path.x[k] + start_m) / count_m);
    rig.samples[0].raw = counts < 0 ? counts + 4294967296.0 : counts;
    rig.again();
    const double error = rig.program.state().qd[0] - path.v[k];
    if (k >= kSkip) sum += error * error;
  }
  return std::sqrt(sum / static_cast<double>(path.x.size() - kSkip));
}

TEST(VelocityRms, RampAsPublished) {
  const Path path = ramp();
  for (const Row& row : kRows) {
    EXPECT_NEAR(rms_error(row, path), row.rms_m_s[0], 1e-3 * row.rms_m_s[0])
        << row.estimator << ", " << row.bits << " bit";
  }
}

struct Range {
  double low = 1e9, high = 0;
};

Range over_starts(const Row& row, const Path& path) {
  constexpr int kStarts = 32;
  const double count_m = 0.2 * 2 * M_PI / std::ldexp(1.0, row.bits);
  Range range;
  for (int i = 0; i < kStarts; ++i) {
    const double found = rms_error(row, path, (i + 0.5) / kStarts * count_m);
    range.low = std::min(range.low, found);
    range.high = std::max(range.high, found);
  }
  return range;
}

TEST(VelocityRms, SineAndContactAsPublishedForSomeStart) {
  const Path paths[] = {sine(), contact()};
  for (const Row& row : kRows) {
    for (std::size_t i = 0; i < std::size(paths); ++i) {
      const Range range = over_starts(row, paths[i]);
      const double published = row.rms_m_s[1 + i];
      EXPECT_GT(published, 0.99 * range.low) << row.estimator << ", " << row.bits << " bit, " << i;
      EXPECT_LT(published, 1.01 * range.high) << row.estimator << ", " << row.bits << " bit, " << i;
    }
  }
}

}  // namespace
}  // namespace hapticd::control
