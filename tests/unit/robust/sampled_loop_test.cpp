// The exact sampled loop of the paper's wall against figures computed elsewhere
// (tests/data/paper2/design.json) and closed forms.
#include "control/design/check/sampled_loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "control/design/synthesis/exact_index.h"
#include "tests/support/observer_radii.h"
#include "tests/support/paper2_loop.h"

namespace hapticd::test {
namespace {

using check::LoopCase;

const nlohmann::json& exact_tables(const std::string& name) {
  return paper2_design().at("grid_tables_w1_is_100_over_s_plus_100").at(name);
}

const synthesis::Rational kStep{Vector::Ones(1), Eigen::Vector2d(0, 1)};
synthesis::WallMeant meant_wall(bool step = false) {
  synthesis::WallMeant meant{.stiffness_N_m = 1000, .damping_Ns_m = 1};
  if (step) meant.weight = kStep;
  return meant;
}

TEST(SampledLoop, RadiiAreTheReferences) {
  const auto& grid = paper2_design().at("grid_tables_w1_is_100_over_s_plus_100").at("grid");
  for (const ExactCase& c : kExact) {
    for (std::size_t i = 0; i < grid.size(); ++i)
      EXPECT_NEAR(check::loop_radius(loop_of(c.wall(), grid[i]), c.device()),
                  exact_tables(c.table).at("rho")[i].get<double>(), 2e-6)
          << c.table << ", B_c " << grid[i];
  }
}

TEST(SampledLoop, IndicesAreTheReferences) {
  const auto& grid = paper2_design().at("grid_tables_w1_is_100_over_s_plus_100").at("grid");
  for (const ExactCase& c : kExact) {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      for (const bool step : {false, true}) {
        const auto& expected = exact_tables(c.table).at(step ? "Jstep" : "J")[i];
        const double index =
            synthesis::exact_index(loop_of(c.wall(), grid[i]), c.device(), meant_wall(step));
        if (expected.is_string()) {
          EXPECT_TRUE(std::isinf(index)) << c.table << ", B_c " << grid[i];
        } else {
          EXPECT_NEAR(index / expected.get<double>(), 1, 1e-6) << c.table << ", B_c " << grid[i];
        }
      }
    }
  }
}

TEST(SampledLoop, MostTransparentDampersAreTheReferences) {
  for (const ExactCase& c : kExact) {
    for (const bool step : {false, true}) {
      const auto index = [&](double damper) {
        return synthesis::exact_index(loop_of(c.wall(), damper), c.device(), meant_wall(step));
      };
      const synthesis::Least best = synthesis::least(index, {.low = 0.5, .high = 25, .points = 40});
      EXPECT_NEAR(best.x,
                  exact_tables(c.table).at(step ? "argmin_step" : "argmin_w1_100").get<double>(),
                  2e-4)
          << c.table;
      EXPECT_NEAR(best.value / exact_tables(c.table).at(step ? "Jmin_step" : "Jmin").get<double>(),
                  1, 1e-6)
          << c.table;
    }
  }
}

TEST(SampledLoop, WithAClassicObserverRadiiAreTheReferences) {
  for (const test::ObserverRadii& row : test::kObserverRadii) {
    for (std::size_t i = 0; i < std::size(test::kObserverCutoff_Hz); ++i) {
      synthesis::SampledWall wall = paper2_wall();
      wall.observer = build::observer(0, 0,
                                      {.mode = build::ObserverMode::classic,
                                       .nominal_mass_kg = 0.01,
                                       .nominal_damping_Ns_m = 0.022,
                                       .cutoff_Hz = test::kObserverCutoff_Hz[i],
                                       .order = row.order,
                                       .delay_ticks = static_cast<std::uint16_t>(row.late),
                                       .max_output = 1e9},
                                      kPeriod_s);
      const bool free = row.wall_Ns_m == 0;
      auto cases = check::scaled_devices(paper2_device(row.late ? kPeriod_s : 0), 0.5,
                                         free ? 0 : 0.5, {-1, -0.5, 0, 0.5, 1});
      for (LoopCase& one : cases) one.contact = free ? 0 : 1;
      EXPECT_NEAR(check::worst_of(loop_of(wall, row.wall_Ns_m), cases).radius, row.radius[i], 1e-4)
          << "order " << row.order << ", wall " << row.wall_Ns_m << ", late " << row.late << ", "
          << test::kObserverCutoff_Hz[i] << " Hz";
    }
  }
}

TEST(SampledLoop, HandMassAtWhichAClassicObserverFailsIsTheReferences) {
  // The reference's grid of masses has steps of 1 %.
  const struct {
    double damper, cutoff_Hz, hand_kg;
  } rows[] = {{8, 1, 1.252},  {8, 2, 0.651},   {8, 5, 0.289},   {8, 10, 0.168}, {15, 1, 2.520},
              {15, 5, 0.651}, {15, 10, 0.416}, {15, 20, 0.285}, {5, 1, 0.739},  {5, 10, 0.089}};
  for (const auto& row : rows) {
    synthesis::SampledWall wall = paper2_wall();
    wall.observer = build::observer(0, 0,
                                    {.mode = build::ObserverMode::classic,
                                     .nominal_mass_kg = 0.01,
                                     .nominal_damping_Ns_m = 0.022,
                                     .cutoff_Hz = row.cutoff_Hz,
                                     .order = 1,
                                     .max_output = 1e9},
                                    kPeriod_s);
    LoopCase light = paper2_device(), heavy = paper2_device();
    light.hand_kg = 0.988 * row.hand_kg;
    heavy.hand_kg = 1.012 * row.hand_kg;
    const auto loop = loop_of(wall, row.damper);
    EXPECT_LT(check::loop_radius(loop, light), 1) << row.damper << ", " << row.cutoff_Hz;
    EXPECT_GT(check::loop_radius(loop, heavy), 1) << row.damper << ", " << row.cutoff_Hz;
  }
}

TEST(SampledLoop, ASceneBehindASpringAndADamperIsItsSeries) {
  // A wall of 3000 N/m behind 1500 N/m: 1000 N/m in all, without a damper.
  const System scene = check::constant(Matrix::Constant(1, 1, 3000.0));
  const check::SampledLoop loop{
      .force = check::rendered_scene(check::behind_spring_damper(scene, 1500, 0, kPeriod_s))};
  LoopCase device = paper2_device();
  device.damping_Ns_m = 2;
  EXPECT_NEAR(check::loop_radius(loop, device),
              check::loop_radius(loop_of(paper2_wall(), 0), device), 1e-9);
}

TEST(SampledLoop, RefusesWhatIsNoLoop) {
  const auto loop = loop_of(paper2_wall(), 5);
  LoopCase device = paper2_device();
  device.mass_kg = 0;
  EXPECT_TRUE(std::isnan(check::loop_radius(loop, device)));
  EXPECT_TRUE(std::isnan(synthesis::exact_index(loop, device, meant_wall())));
  device = paper2_device(-1e-6);
  EXPECT_TRUE(std::isnan(check::loop_radius(loop, device)));
  check::SampledLoop broken = loop;
  broken.force.D(0, 0) = std::nan("");
  EXPECT_TRUE(std::isnan(check::loop_radius(broken, paper2_device())));
  EXPECT_TRUE(std::isnan(check::worst_of(broken, paper2_box()).radius));
  EXPECT_FALSE(check::all_stable(broken, paper2_box()));
}

}  // namespace
}  // namespace hapticd::test
