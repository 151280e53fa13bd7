#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "daemon/reload_rules.h"

namespace hapticd::daemon {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

config::Compiled compiled() {
  config::Compiled result;
  config::Axis axis;
  axis.name = "x";
  axis.encoder.counts_per_m = 1e5;
  axis.actuator.max_force_N = 8;
  config::Device device;
  device.name = "left";
  device.axes = {axis};
  device.sim = config::Sim{};
  result.document.config.devices = {device};
  sim::DeviceOptions simulated;
  simulated.axes = {sim::AxisOptions{.mass_kg = 0.05, .damping_Ns_m = 1}};
  result.simulated = {simulated};
  return result;
}

std::vector<std::string> after(const std::function<void(config::Compiled&)>& change) {
  config::Compiled fresh = compiled();
  change(fresh);
  return reload_obstacles(compiled(), fresh);
}

std::vector<std::string> after_config(const std::function<void(config::Config&)>& change) {
  return after([&](config::Compiled& fresh) { change(fresh.document.config); });
}

auto refused_for(const std::string& key) {
  return ElementsAre(AllOf(HasSubstr(key + " changed"), HasSubstr("disable first")));
}

TEST(Reload, NothingChangedIsNoObstacle) {
  EXPECT_THAT(after_config([](auto&) {}), IsEmpty());
}

TEST(Reload, SceneGuardModelsEstimatorsStabilityStartAndTelemetryMayChange) {
  EXPECT_THAT(after([](config::Compiled& fresh) {
                config::Config& c = fresh.document.config;
                c.scene = {config::Plane{}};
                c.guard.max_force_N = 3;
                c.devices[0].guard.ramp_s = 0.1;
                c.devices[0].latency_s = 1e-4;
                c.devices[0].axes[0].model = config::AxisModel{.mass_kg = 1, .damping_Ns_m = 1};
                c.devices[0].axes[0].encoder.stuck_s = 0.5;
                c.devices[0].axes[0].actuator.continuous_force_N = 2;
                c.devices[0].axes[0].actuator.thermal_time_s = 5;
                c.devices[0].axes[0].velocity.estimator = config::Estimator::low_pass;
                c.devices[0].axes[0].travel = config::Travel{};
                c.devices[0].enable_inputs = {config::EnableInput{}};
                c.stability.require = config::Require::none;
                c.start.enable = config::EnableWhen::when_ready;
                c.telemetry.record = "file";
                fresh.simulated[0].ramp_s = 0.1;
              }),
              IsEmpty());
}

TEST(Reload, EffortsBesideTheContactForceWouldStep) {
  EXPECT_THAT(after_config([](auto& c) {
                c.devices[0].axes[0].observer.mode = config::ObserverMode::model;
              }),
              refused_for("devices[0].axes[0].observer"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].axes[0].compensation.coulomb_share = 0.5; }),
              refused_for("devices[0].axes[0].compensation"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].gravity = config::Gravity{}; }),
              refused_for("devices[0].gravity"));
}

TEST(Reload, TheLoopNeedsARestart) {
  EXPECT_THAT(after_config([](auto& c) { c.loop.rate_Hz = 2000; }), refused_for("loop.rate_Hz"));
  EXPECT_THAT(after_config([](auto& c) { c.loop.priority = 1; }), refused_for("loop.priority"));
  EXPECT_THAT(after_config([](auto& c) { c.loop.cpu = 1; }), refused_for("loop.cpu"));
  EXPECT_THAT(after_config([](auto& c) { c.loop.max_gap_ticks = 1; }),
              refused_for("loop.max_gap_ticks"));
  EXPECT_THAT(after_config([](auto& c) { c.loop.max_missed_per_s = 1; }),
              refused_for("loop.max_missed_per_s"));
}

TEST(Reload, TheSocketNeedsARestart) {
  EXPECT_THAT(after_config([](auto& c) { c.control.socket = "/tmp/other"; }),
              refused_for("control.socket"));
}

TEST(Reload, DevicesAndAxesNeedARestart) {
  EXPECT_THAT(after_config([](auto& c) { c.devices.push_back(c.devices[0]); }),
              refused_for("devices (their number)"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].name = "right"; }),
              refused_for("devices[0].name"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].axes[0].name = "y"; }),
              refused_for("devices[0].axes[0].name"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].axes[0].encoder.bits = 16; }),
              refused_for("devices[0].axes[0].encoder"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].axes[0].actuator.max_force_N = 1; }),
              refused_for("devices[0].axes[0].actuator"));
  EXPECT_THAT(after_config([](auto& c) {
                c.devices[0].kinematics = config::Cartesian{.directions = {config::Direction::y}};
              }),
              refused_for("devices[0].kinematics"));
  EXPECT_THAT(after_config([](auto& c) {
                c.devices[0].pose.position_m = {1, 0, 0};
              }),
              refused_for("devices[0].pose"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].workspace_scale = 2; }),
              refused_for("devices[0].workspace_scale"));
}

TEST(Reload, WhatADeviceOnUsbIsToldNeedsARestart) {
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].usb = config::UsbDevice{.serial = "a"}; }),
              refused_for("devices[0].usb"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].falcon = config::Falcon{}; }),
              refused_for("devices[0].falcon"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].report = config::Report{}; }),
              refused_for("devices[0].report"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].openffboard = config::OpenFfboard{}; }),
              refused_for("devices[0].openffboard"));
}

TEST(Reload, WhereAnAxisFindsItsReferenceNeedsARestart) {
  EXPECT_THAT(after_config([](auto& c) {
                c.devices[0].axes[0].homing.by = config::HomingMethod::hard_stop;
              }),
              refused_for("devices[0].axes[0].homing"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].axes[0].homing.position_m = 0.1; }),
              refused_for("devices[0].axes[0].homing"));
}

TEST(Reload, AWholeTickOfLatencyNeedsARestartAndAShareOfOneDoesNot) {
  build::ProgramSpec running;
  running.axes.resize(2);
  running.axis_names = {"left.x", "left.y"};
  build::ProgramSpec fresh = running;
  fresh.axes[1].delay_share = 0.5;
  EXPECT_THAT(latency_obstacles(running, fresh), IsEmpty());
  fresh.axes[1].delay_ticks = 1;
  EXPECT_THAT(latency_obstacles(running, fresh),
              ElementsAre(AllOf(HasSubstr("the latency of left.y"), HasSubstr("disable first"))));
}

TEST(Reload, TheSimulatedTruthNeedsARestart) {
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].sim->hand.mass_kg = 1; }),
              refused_for("devices[0].sim.hand"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].sim->seed = 9; }),
              refused_for("devices[0].sim.seed"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].sim->failures = {config::SimFailure{}}; }),
              refused_for("devices[0].sim.failures"));
  EXPECT_THAT(after_config([](auto& c) { c.devices[0].sim->linkage.tip_kg = 1; }),
              refused_for("devices[0].sim.linkage"));
  EXPECT_THAT(after_config([](auto& c) {
                c.devices[0].sim->digital = {{1, 1}};
              }),
              refused_for("devices[0].sim.digital"));
  for (const auto& change : std::vector<std::function<void(sim::AxisOptions&)>>{
           [](auto& axis) { axis.mass_kg = 1; }, [](auto& axis) { axis.index_m = 0.01; },
           [](auto& axis) {
             axis.stops = sim::StopOptions{-1, 1};
           },
           [](auto& axis) { axis.relative = true; }, [](auto& axis) { axis.homed_at_s = 1; }}) {
    EXPECT_THAT(after([&](config::Compiled& fresh) { change(fresh.simulated[0].axes[0]); }),
                ElementsAre(HasSubstr("devices[0].sim.axes")));
  }
  EXPECT_THAT(after([](config::Compiled& fresh) {
                fresh.simulated[0].force_sensor = sim::ForceSensorOptions{};
              }),
              ElementsAre(HasSubstr("devices[0].sim.force_sensor")));
}

TEST(Reload, EveryObstacleIsNamedAtOnce) {
  const auto found = after_config([](auto& c) {
    c.loop.rate_Hz = 2000;
    c.devices[0].name = "right";
  });
  EXPECT_EQ(found.size(), 2u);
}

}  // namespace
}  // namespace hapticd::daemon
