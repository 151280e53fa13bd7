// Margins of the paper's wall in the exact sampled loop: dampers, uncertainty and stiffness that it
// tolerates, against figures computed elsewhere (tests/data/paper2/design.json) and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>

#include "control/design/synthesis/sampled_search.h"
#include "tests/support/paper2_loop.h"

namespace hapticd::test {
namespace {

using check::LoopCase;
using synthesis::Range;
using synthesis::Scan;

void expect_range(const std::optional<Range>& found, const nlohmann::json& expected,
                  const std::string& what) {
  ASSERT_EQ(found.has_value(), !expected.is_null()) << what;
  if (!found) return;
  EXPECT_NEAR(found->low, expected[0].get<double>(), 2e-4) << what;
  EXPECT_NEAR(found->high, expected[1].get<double>(), 2e-4) << what;
}

TEST(SampledMargins, StableDampersAreTheReferences) {
  const Scan scan{.low = 0.1, .high = 60};
  const auto& tables = paper2_design().at("exact_stability_intervals_Bc");
  for (const ExactCase& c : kExact) {
    const auto& table =
        tables.at(std::string(c.ideal ? "ideal" : "bd") + "_delay" + std::to_string(c.delay_ticks));
    const auto scaled = [&](double delta) {
      return check::scaled_devices(c.device(), 0.5, 0.5, {delta});
    };
    expect_range(stable_dampers(c.wall(), scaled(0), scan), table.at("m.01"), c.table);
    expect_range(stable_dampers(c.wall(), paper2_box(c.device().latency_s), scan),
                 table.at("robust"), c.table);
    if (table.contains("m.005b.011"))
      expect_range(stable_dampers(c.wall(), scaled(-1), scan), table.at("m.005b.011"), c.table);
    if (table.contains("m.015b.033"))
      expect_range(stable_dampers(c.wall(), scaled(1), scan), table.at("m.015b.033"), c.table);
  }
  EXPECT_FALSE(stable_dampers(paper2_wall(), {paper2_device(2 * kPeriod_s)}, scan));
}

TEST(SampledMargins, StableDampersOfAFrictionlessDeviceHaveAClosedForm) {
  LoopCase device = paper2_device();
  device.damping_Ns_m = 0;
  for (const double stiffness : {200., 1000., 3000.}) {
    synthesis::SampledWall wall = paper2_wall();
    wall.stiffness_N_m = stiffness;
    const double k = stiffness * 1e-6 / 0.01, p = 1 - k / 4, root = std::sqrt(p * p - k);
    const auto range = stable_dampers(wall, {device}, {.low = 0.05, .high = 60});
    ASSERT_TRUE(range);
    EXPECT_NEAR(range->low, (p - root) * 10, 1e-6);
    EXPECT_NEAR(range->high, (p + root) * 10, 1e-6);
    wall.velocity.reset();
    const auto ideal = stable_dampers(wall, {device}, {.low = 0.05, .high = 60});
    ASSERT_TRUE(ideal);
    EXPECT_NEAR(ideal->low, stiffness * 1e-3 / 2, 1e-6);
    EXPECT_NEAR(ideal->high, 20, 1e-6);
  }
}

/// The reference's intervals are the first and last stable point of a grid of 0.1.
void expect_grid_range(const synthesis::SampledWall& wall, const std::vector<LoopCase>& cases,
                       const nlohmann::json& expected, const std::string& what) {
  const auto stable = [&](double damper) {
    return check::all_stable(loop_of(wall, damper), cases);
  };
  if (expected.is_null()) {
    for (int i = 2; i <= 200; ++i) EXPECT_FALSE(stable(0.1 * i)) << what << ", B_c " << 0.1 * i;
    return;
  }
  const double low = expected[0], high = expected[1];
  EXPECT_TRUE(stable(low)) << what;
  EXPECT_TRUE(stable(0.5 * (low + high))) << what;
  EXPECT_TRUE(stable(high)) << what;
  EXPECT_FALSE(stable(high + 0.1)) << what;
  if (low > 0.25) {
    EXPECT_FALSE(stable(low - 0.1)) << what;
  }
}

TEST(SampledMargins, LatencyNarrowsTheDampersAsInTheReference) {
  for (const auto& [latency, table] :
       paper2_design().at("latency_us_to_Bc_interval_grid0.1").items()) {
    const double seconds = std::stod(latency) * 1e-6;
    expect_grid_range(paper2_wall(), {paper2_device(seconds)}, table.at("nominal"),
                      latency + " us");
    expect_grid_range(paper2_wall(), paper2_box(seconds), table.at("robust"),
                      latency + " us, any device");
  }
}

/// Position and velocity tracked with both poles at e^{-wT}: the loop has none such, the reference has.
System alpha_beta(double bandwidth_rad_s) {
  const double r = std::exp(-bandwidth_rad_s * kPeriod_s);
  const Eigen::Vector2d correct(1 - r * r, (1 - r) * (1 - r) / kPeriod_s);
  System g{Matrix(2, 2), correct, Matrix(1, 2), Matrix::Constant(1, 1, correct[1])};
  g.A << 1, kPeriod_s, 0, 1;
  g.A -= correct * g.A.row(0);
  g.C = g.A.row(1);
  return g;
}

TEST(SampledMargins, EstimatorsNarrowTheDampersAsInTheReference) {
  const auto low_pass = [](double cutoff_Hz) {
    return check::velocity_of(build::low_pass(0, cutoff_Hz, kPeriod_s), kPeriod_s);
  };
  const auto fit = [](std::uint16_t window, std::uint16_t degree) {
    return check::velocity_of(build::least_squares(0, window, degree, kPeriod_s));
  };
  const auto tracking = [](double bandwidth) {
    return check::velocity_of(build::alpha_beta_gamma(0, bandwidth, kPeriod_s), kPeriod_s);
  };
  const std::map<std::string, System> estimators = {{"BD", check::backward_difference(kPeriod_s)},
                                                    {"LP30", low_pass(30)},
                                                    {"LP60", low_pass(60)},
                                                    {"LP100", low_pass(100)},
                                                    {"LP200", low_pass(200)},
                                                    {"LS1 N4", fit(4, 1)},
                                                    {"LS1 N8", fit(8, 1)},
                                                    {"LS1 N16", fit(16, 1)},
                                                    {"LS2 N8", fit(8, 2)},
                                                    {"LS2 N16", fit(16, 2)},
                                                    {"ab400", alpha_beta(400)},
                                                    {"abg400", tracking(400)},
                                                    {"abg800", tracking(800)}};
  int rows = 0;
  for (const auto& [name, row] : paper2_design().at("exact_misc").items()) {
    if (!name.starts_with("est_")) continue;
    synthesis::SampledWall wall = paper2_wall(estimators.at(row[1]));
    wall.stiffness_N_m = row[0];
    expect_grid_range(wall, {paper2_device()}, row[2], name);
    expect_grid_range(wall, paper2_box(), row[3], name + ", any device");
    double radius = 0, damper = 0;
    ASSERT_EQ(
        std::sscanf(row[4].get<std::string>().c_str(), "best rho %lf at %lf", &radius, &damper), 2);
    EXPECT_NEAR(check::loop_radius(loop_of(wall, damper), paper2_device()), radius, 6e-4) << name;
    ++rows;
  }
  EXPECT_EQ(rows, 26);
}

TEST(SampledMargins, ToleratedUncertaintyIsTheReferences) {
  for (const char* name : {"Dmax_bd_d0", "Dmax_ideal_d0", "Dmax_bd_d1"}) {
    const bool ideal = std::string(name).find("ideal") != std::string::npos;
    const double latency = std::string(name).ends_with("d1") ? kPeriod_s : 0;
    for (const auto& [damper, expected] : paper2_design().at("exact_misc").at(name).items())
      EXPECT_NEAR(synthesis::largest_uncertainty(
                      loop_of(ideal ? paper2_wall(std::nullopt) : paper2_wall(), std::stod(damper)),
                      paper2_device(latency), 0.5, 0.5),
                  expected.get<double>(), 2e-4)
          << name << ", B_c " << damper;
  }
}

TEST(SampledMargins, LargestStiffnessIsTheReferences) {
  for (const auto& [latency, expected] : paper2_design().at("latency_us_to_Kmax_robust50").items())
    EXPECT_NEAR(largest_stiffness(paper2_wall(), paper2_box(std::stod(latency) * 1e-6),
                                  {.low = 300, .high = 6000, .points = 12},
                                  {.low = 0.2, .high = 20, .points = 40}) /
                    expected.get<double>(),
                1, 2e-3)
        << latency;
}

}  // namespace
}  // namespace hapticd::test
