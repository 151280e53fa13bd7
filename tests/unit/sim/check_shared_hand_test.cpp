#include "sim/check_shared_hand.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "shared_bench.h"

namespace hapticd::sim {
namespace {

struct WrongHand {
  const char* expected;  ///< stands in the message
  std::function<void(SharedHandOptions&, std::vector<DeviceOptions>&)> spoil;
};

TEST(SharedHandOptions, WhatCannotBeHeldIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ASSERT_EQ(shared_hand_problem(dense_hand(), two_devices()), "");
  const WrongHand wrongs[] = {
      {"axes: expected at least one", [](auto& h, auto&) { h.axes.clear(); }},
      {"device: expected one of 2, counted from 0, found 2",
       [](auto& h, auto&) { h.axes[1].device = 2; }},
      {"axis: expected an axis of device right, found 1",
       [](auto& h, auto&) { h.axes[1].axis = 1; }},
      {"velocity_m_s", [&](auto& h, auto&) { h.axes[0].velocity_m_s = nan; }},
      {"found axis 0 of device left twice", [](auto& h, auto&) { h.axes[1].device = 0; }},
      {"states: expected at most 64, found 65", [](auto& h, auto&) { h.states = 65; }},
      {"A: expected 2 x 2 numbers, found 3", [](auto& h, auto&) { h.A.pop_back(); }},
      {"B: expected 2 x 2 numbers, found 5", [](auto& h, auto&) { h.B.push_back(1); }},
      {"C: expected numbers", [&](auto& h, auto&) { h.C[1] = nan; }},
      {"D: expected 2 x 2 numbers, found 0", [](auto& h, auto&) { h.D.clear(); }},
      {"device right: axis 0: mass_kg", [](auto&, auto& d) { d[1].axes[0].mass_kg = 0; }},
      {"device left: linkage: expected none", [](auto&, auto& d) { d[0].linkage.emplace(); }},
      {"device right: hand: expected none", [](auto&, auto& d) { d[1].hand.mass_kg = 0.1; }},
      {"device right: hand: expected none", [](auto&, auto& d) { d[1].hand.stiffness_N_m = 1; }},
      {"device right: hand: expected none", [](auto&, auto& d) { d[1].hand.damping_Ns_m = 1; }},
      {"device right: hand: expected none", [](auto&, auto& d) { d[1].hand.script = {{}}; }},
      {"device right: period_s: expected that of device left, 0.001, found 0.002",
       [](auto&, auto& d) { d[1].period_s = 2e-3; }},
      {"device right: substeps: expected those of device left, 10, found 5",
       [](auto&, auto& d) { d[1].substeps = 5; }},
      {"device left: axis 0: coulomb_N: expected 0 where a hand is shared, found 0.5",
       [](auto&, auto& d) { d[0].axes[0].coulomb_N = 0.5; }},
      {"device right: axis 0: stops: expected none",
       [](auto&, auto& d) {
         d[1].axes[0].stops = {-1, 1};
       }},
      {"axes: expected at most 48", [](auto&, auto& d) { d[0].axes.resize(48, d[0].axes[0]); }},
  };
  for (const WrongHand& wrong : wrongs) {
    SharedHandOptions hand = dense_hand();
    std::vector<DeviceOptions> devices = two_devices();
    wrong.spoil(hand, devices);
    const std::string problem = shared_hand_problem(hand, devices);
    EXPECT_NE(problem.find(wrong.expected), std::string::npos)
        << "expected: " << wrong.expected << "\nfound: " << problem;
  }
}

TEST(SharedHandOptions, ADeviceWhoseHandIsWrongDoesNotConnect) {
  SharedHandOptions hand = dense_hand();
  hand.D.clear();
  SimDevice device(std::make_shared<SharedHand>(hand, two_devices()), 1);
  device.disconnect();
  const auto connected = device.connect();
  ASSERT_FALSE(connected.has_value());
  EXPECT_EQ(connected.error().text,
            "simulated device right: shared hand: D: expected 2 x 2 numbers, found 0");
}

}  // namespace
}  // namespace hapticd::sim
