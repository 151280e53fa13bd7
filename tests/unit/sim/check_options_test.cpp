#include "sim/check_options.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "bench_device.h"
#include "five_bar.h"

namespace hapticd::sim {
namespace {

TEST(SimOptions, AGoodDeviceHasNoProblem) {
  EXPECT_EQ(first_problem(free_mass()), "");
}

struct Wrong {
  const char* expected;  ///< stands in the message
  std::function<void(DeviceOptions&)> spoil;
};

TEST(SimOptions, EveryValueOutOfRangeIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Wrong wrongs[] = {
      {"axes: expected at least one", [](auto& o) { o.axes.clear(); }},
      {"period_s: expected a number > 0, found 0", [](auto& o) { o.period_s = 0; }},
      {"ramp_s", [](auto& o) { o.ramp_s = -1; }},
      {"substeps: expected 1 to 10000, found 0", [](auto& o) { o.substeps = 0; }},
      {"axis 0: mass_kg: expected a number > 0, found 0", [](auto& o) { o.axes[0].mass_kg = 0; }},
      {"damping_Ns_m", [](auto& o) { o.axes[0].damping_Ns_m = -1; }},
      {"coulomb_N", [&](auto& o) { o.axes[0].coulomb_N = nan; }},
      {"delay_s", [](auto& o) { o.axes[0].delay_s = -1e-9; }},
      {"at most 1000 periods", [](auto& o) { o.axes[0].delay_s = 2; }},
      {"position_m", [&](auto& o) { o.axes[0].position_m = nan; }},
      {"counts_per_m", [](auto& o) { o.axes[0].counts_per_m = 0; }},
      {"encoder_bits: expected 0 to 52, found 53", [](auto& o) { o.axes[0].encoder_bits = 53; }},
      {"noise_counts", [](auto& o) { o.axes[0].noise_counts = -1; }},
      {"dac_step_N", [](auto& o) { o.axes[0].dac_step_N = -1; }},
      {"dac_step_N", [](auto& o) { o.axes[0].dac_step_N = 101; }},
      {"max_effort_N", [](auto& o) { o.axes[0].max_effort_N = 0; }},
      {"hand mass_kg", [](auto& o) { o.hand.mass_kg = -1; }},
      {"hand stiffness_N_m", [](auto& o) { o.hand.stiffness_N_m = -1; }},
      {"hand damping_Ns_m", [&](auto& o) { o.hand.damping_Ns_m = nan; }},
      {"at_s: expected a time not before 0.5, found 0.25",
       [](auto& o) {
         o.hand.script = {{.at_s = 0.5}, {.at_s = 0.25}};
       }},
      {"force_N", [&](auto& o) { o.hand.script = {{.force_N = nan}}; }},
      {"failure axis: expected an axis of the device, found 1",
       [](auto& o) { o.failures = {{.axis = 1}}; }},
      {"failure at_s", [](auto& o) { o.failures = {{.at_s = -1}}; }},
      {"substeps: expected more",
       [](auto& o) {
         o.axes[0].coulomb_N = 1;
         o.hand.stiffness_N_m = 1e8;
       }},
  };
  for (const Wrong& wrong : wrongs) {
    DeviceOptions options = free_mass();
    wrong.spoil(options);
    EXPECT_NE(first_problem(options).find(wrong.expected), std::string::npos)
        << "expected: " << wrong.expected << "\nfound: " << first_problem(options);
  }
}

TEST(SimOptions, EveryInputOutOfRangeIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Wrong wrongs[] = {
      {"zero_m", [&](auto& o) { o.axes[0].zero_m = nan; }},
      {"index_m", [&](auto& o) { o.axes[0].index_m = nan; }},
      {"homed_at_s: expected a number >= 0, found -1", [](auto& o) { o.axes[0].homed_at_s = -1; }},
      {"axis 0: stops max_m: expected a number > min_m, which is 1, found 1",
       [](auto& o) {
         o.axes[0].stops = StopOptions{1, 1};
       }},
      {"stops max_m",
       [&](auto& o) {
         o.axes[0].stops = StopOptions{nan, 1};
       }},
      {"position_m: expected between the stops, 0.1 to 1, found 0",
       [](auto& o) {
         o.axes[0].stops = StopOptions{0.1, 1};
       }},
      {"digital at_s: expected a time not before 2, found 1",
       [](auto& o) {
         o.digital = {{2, 0}, {1, 0}};
       }},
      {"force_sensor noise_N", [](auto& o) { o.force_sensor = ForceSensorOptions{.noise_N = -1}; }},
  };
  for (const Wrong& wrong : wrongs) {
    DeviceOptions options = free_mass();
    wrong.spoil(options);
    EXPECT_NE(first_problem(options).find(wrong.expected), std::string::npos)
        << "expected: " << wrong.expected << "\nfound: " << first_problem(options);
  }
}

TEST(SimOptions, EveryValueOfALinkageOutOfRangeIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Wrong wrongs[] = {
      {"inner_link_kg", [](auto& o) { o.linkage->inner_link_kg = -1; }},
      {"outer_link_kg", [&](auto& o) { o.linkage->outer_link_kg = nan; }},
      {"tip_kg", [](auto& o) { o.linkage->tip_kg = -1; }},
      {"gravity", [&](auto& o) { o.linkage->gravity[2] = nan; }},
      {"hand_direction: expected a vector of length 1, found 2",
       [](auto& o) {
         o.linkage->hand_direction = {0, 2, 0};
       }},
      {"inner_link_kg, outer_link_kg: expected 0",
       [](auto& o) { o.linkage->geometry = control::LinearMap{}; }},
      {"axes: expected 2, one for each joint of the linkage, found 3",
       [](auto& o) { o.axes.push_back(o.axes[0]); }},
      {"axes: expected at most 6", [](auto& o) { o.axes.resize(7, o.axes[0]); }},
      {"position_m: expected joints that the linkage can take together",
       [](auto& o) {
         o.axes[0].position_m = 3.14;
         o.axes[1].position_m = 0;
       }},
      {"substeps: expected at least", [](auto& o) { o.hand.stiffness_N_m = 1e7; }},
      {"substeps: expected at least", [](auto& o) { o.hand.damping_Ns_m = 1e3; }},
      {"substeps: expected at least", [](auto& o) { o.axes[1].damping_Ns_m = 10; }},
  };
  EXPECT_EQ(first_problem(five_bar()), "");
  for (const Wrong& wrong : wrongs) {
    DeviceOptions options = five_bar();
    wrong.spoil(options);
    EXPECT_NE(first_problem(options).find(wrong.expected), std::string::npos)
        << "expected: " << wrong.expected << "\nfound: " << first_problem(options);
  }
}

TEST(SimOptions, ConnectRefusesAndNamesTheDevice) {
  DeviceOptions options = free_mass();
  options.axes[0].mass_kg = -1;
  SimDevice device(options);
  const auto connected = device.connect();
  ASSERT_FALSE(connected.has_value());
  EXPECT_NE(connected.error().text.find("bench"), std::string::npos);
  EXPECT_EQ(connected.error().code, ExitCode::bad_data);
}

}  // namespace
}  // namespace hapticd::sim
