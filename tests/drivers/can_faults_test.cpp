// Everything that goes wrong on a bus: within how many ticks the motor is without force, which words name the cause, and
// that nothing old comes back when the operator enables again.
#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <functional>
#include <numbers>

#include "tests/drivers/can_configs.h"
#include "tests/drivers/can_rig.h"

namespace hapticd::test {
namespace {

using control::Mode;

/// guard.max_stale_ticks of the configs and one: samples are given up.
constexpr int kStale = 4;
/// The drives' watchdog in ticks, and two for what is on the bus.
constexpr int kWatchdog = 22;

Emulation usual_emulation() {
  Emulation emulation;
  emulation.cia402.rated_torque_Nm = 0.1;
  emulation.odrive.heartbeat_every_s = 0.1;
  return emulation;
}

/// A rig that has pressed against its wall for half a second.
std::unique_ptr<CanRig> pressing(const Bus& bus) {
  auto rig = std::make_unique<CanRig>(wall_on(bus), usual_emulation());
  if (auto info = rig->connect(); !info) throw std::runtime_error(info.error().text);
  if (!rig->enable()) throw std::runtime_error("not enabled: " + rig->fault_text());
  for (int i = 0; i < 500; ++i) rig->tick();
  if (rig->mode() != Mode::enabled || rig->motor_Nm() == 0) throw std::runtime_error("no force");
  return rig;
}

sim::can::Frame frame_of(std::uint32_t id, std::vector<std::uint8_t> data, std::uint8_t flags = 0) {
  sim::can::Frame frame{};
  frame.can_id = id;
  frame.len = static_cast<std::uint8_t>(data.size());
  frame.flags = flags;
  std::copy(data.begin(), data.end(), frame.data);
  return frame;
}

bool is(const Bus& bus, const char* driver) {
  return std::string(bus.driver) == driver;
}

/// A torque command of somebody else, to node 3.
sim::can::Frame foreign_command(const Bus& bus) {
  if (is(bus, "odrive")) return frame_of(3U << 5 | 0x0e, {0, 0, 0x80, 0x3f});
  if (is(bus, "cia402")) return frame_of(0x203, {0x0f, 0, 1, 0});
  return frame_of(0x8203 | CAN_EFF_FLAG, {0x01, 0x00, 0x0a}, CANFD_FDF | CANFD_BRS);
}

sim::can::Frame bus_off() {
  return frame_of(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0});
}

class CanFaults : public testing::TestWithParam<Bus> {
 protected:
  /// `break_it`, then no force from `ticks` later on, a fault whose text has `words`; `mend_it`, and forces come back
  /// from nothing.
  void expect_fault(
      const std::function<void(CanRig&)>& break_it, int ticks, const std::string& words,
      const std::function<void(CanRig&)>& mend_it = [](CanRig&) {}) {
    const auto rig = pressing(GetParam());
    break_it(*rig);
    for (int i = 0; i < ticks; ++i) rig->tick();
    for (int i = 0; i < 150; ++i) {
      ASSERT_EQ(rig->motor_Nm(), 0) << i << " ticks too late; " << rig->fault_text();
      rig->tick();
    }
    ASSERT_EQ(rig->mode(), Mode::fault);
    const Fault code = rig->cycle().output().fault.code;
    if (code == Fault::sample_missing)
      EXPECT_EQ(words, "no sample");
    else
      EXPECT_NE(rig->fault_text().find(words), std::string::npos) << rig->fault_text();
    mend_it(*rig);
    expect_calm_recovery(*rig);
  }
  /// No force before the ramp, and that starts from nothing.
  static void expect_calm_recovery(CanRig& rig) {
    rig.input.enable = rig.input.clear_fault = true;
    double most_Nm = 0;
    int ticks = 0;
    for (; ticks < 3000 && rig.mode() != Mode::enabled; ++ticks) {
      most_Nm = std::max(most_Nm, std::abs(rig.motor_Nm()));
      if (rig.mode() == Mode::fault) rig.input.clear_fault = true;
      rig.tick();
    }
    ASSERT_EQ(rig.mode(), Mode::enabled) << rig.fault_text();
    EXPECT_EQ(most_Nm, 0);
    // One step of a ramp of 100, however deep the hand has come meanwhile; and what a CiA 402 drive resolves.
    const double felt_N = 300 * std::abs(rig.drives().body().position(0));
    EXPECT_LE(std::abs(rig.motor_Nm()), 1.05 * felt_N / 100 / (2 * std::numbers::pi * 20) + 1e-4)
        << "a kick";
    for (int i = 0; i < 1000; ++i) ASSERT_EQ(rig.tick().mode, Mode::enabled) << rig.fault_text();
  }
  /// Nothing but limits.
  void expect_tolerated(const std::function<void(CanRig&)>& disturb, int ticks = 300) {
    const auto rig = pressing(GetParam());
    const double before_Nm = rig->motor_Nm();
    for (int i = 0; i < ticks; ++i) {
      disturb(*rig);
      ASSERT_EQ(rig->tick().mode, Mode::enabled) << rig->fault_text();
    }
    for (int i = 0; i < 300; ++i) rig->tick();
    EXPECT_NEAR(rig->motor_Nm(), before_Nm, 0.02 * std::abs(before_Nm));
  }
};

std::string bus_name(const testing::TestParamInfo<Bus>& info) {
  return std::string(info.param.driver) + "_" + info.param.timing;
}
INSTANTIATE_TEST_SUITE_P(All, CanFaults, testing::ValuesIn(kBuses), bus_name);

// -- what a bus may do now and then

TEST_P(CanFaults, OneLostFrameIsHeld) {
  int i = 0;
  expect_tolerated([&](CanRig& rig) {
    if (++i % 20 == 0) rig.drives().bus("can0").lose_next(1);
  });
}

TEST_P(CanFaults, FramesThatComeTwiceAreOne) {
  expect_tolerated([](CanRig& rig) { rig.drives().bus("can0").options().duplicate = 1; });
}

TEST_P(CanFaults, FramesInAnotherOrderAreTolerated) {
  int i = 0;
  expect_tolerated([&](CanRig& rig) {
    if (++i % 50 == 0) rig.drives().bus("can0").reorder_next();
  });
}

TEST_P(CanFaults, JitterOfTheAdapterIsTolerated) {
  expect_tolerated([](CanRig& rig) { rig.drives().bus("can0").options().jitter_s = 50e-6; });
}

TEST_P(CanFaults, WhatMakesNoSenseIsNotTaken) {
  const Bus& bus = GetParam();
  expect_tolerated([&](CanRig& rig) {
    sim::can::EmulatedBus& wire = rig.drives().bus("can0");
    const std::int64_t now_ns = rig.now_ns();
    if (is(bus, "odrive")) {
      wire.inject(frame_of(3U << 5 | 0x09, {0, 0, 0xc0, 0x7f, 0, 0, 0, 0}), now_ns);  // NaN
      wire.inject(frame_of(3U << 5 | 0x09, {0, 0, 0, 0, 1}), now_ns);
      wire.inject(frame_of(3U << 5 | 0x01, {0xff}), now_ns);
    } else if (is(bus, "cia402")) {
      wire.inject(frame_of(0x183, {0x37, 0x12, 1, 2, 3}), now_ns);
      wire.inject(frame_of(0x083, {}), now_ns);
      wire.inject(frame_of(0x703, {}), now_ns);
    } else {
      const std::uint8_t fd = CANFD_FDF | CANFD_BRS;
      wire.inject(frame_of(0x300, {0x21, 0x00}, fd), now_ns);                    // ends too early
      wire.inject(frame_of(0x300, {0x2c, 0x7f, 0x01, 1, 2, 3, 4}, fd), now_ns);  // 127 values
      wire.inject(frame_of(0x300, {0xff, 0xff}, fd), now_ns);
    }
  });
}

// -- what ends in zero force

TEST_P(CanFaults, ADriveThatSaysNothingMore) {
  expect_fault([](CanRig& rig) { rig.drives().drive(0).mute(true); }, kStale + 2, "no sample",
               [](CanRig& rig) { rig.drives().drive(0).mute(false); });
}

TEST_P(CanFaults, ABusThatLosesEverything) {
  expect_fault([](CanRig& rig) { rig.drives().bus("can0").options().loss = 1; }, kWatchdog,
               "no sample", [](CanRig& rig) { rig.drives().bus("can0").options().loss = 0; });
}

/// Free-running samples of a slow adapter cannot be told from young ones: nothing asked for them.
TEST_P(CanFaults, AnswersThatAreLateAreNone) {
  if (std::string(GetParam().timing) == "free_running") return;
  expect_fault([](CanRig& rig) { rig.drives().bus("can0").options().delay_s = 1.2e-3; }, kStale + 5,
               "no sample", [](CanRig& rig) { rig.drives().bus("can0").options().delay_s = 0; });
}

TEST_P(CanFaults, AnotherMaster) {
  expect_fault(
      [&](CanRig& rig) {
        rig.drives().bus("can0").inject(foreign_command(GetParam()), rig.now_ns());
      },
      3, "another master on the bus commands");
}

TEST_P(CanFaults, BusOff) {
  expect_fault([](CanRig& rig) { rig.drives().bus("can0").inject(bus_off(), rig.now_ns()); }, 3,
               "can0: the controller went bus-off");
}

TEST_P(CanFaults, NobodyAcknowledges) {
  expect_fault(
      [](CanRig& rig) {
        rig.drives().bus("can0").inject(
            frame_of(CAN_ERR_FLAG | CAN_ERR_ACK, {0, 0, 0, 0, 0, 0, 0, 0}), rig.now_ns());
      },
      3, "can0: nobody acknowledges");
}

TEST_P(CanFaults, ADriveThatFindsAFault) {
  const Bus& bus = GetParam();
  const int code = is(bus, "odrive") ? 1 << 13 : is(bus, "moteus") ? 38 : 0x3210;
  const char* words = is(bus, "odrive")   ? "motor over-temperature"
                      : is(bus, "moteus") ? "over-temperature"
                                          : "over-voltage";
  const auto rig = pressing(bus);
  rig->drives().drive(0).fail(code, rig->now_ns());
  EXPECT_EQ(rig->motor_Nm(), 0) << "the drive is off by itself";
  // An ODrive tells with its next heartbeat.
  ASSERT_TRUE(
      rig->run_until([&] { return rig->mode() == Mode::fault; }, is(bus, "odrive") ? 105 : 3));
  EXPECT_NE(rig->fault_text().find(words), std::string::npos) << rig->fault_text();
  EXPECT_NE(rig->fault_text().find("arm.x (node 3 on can0)"), std::string::npos);
  expect_calm_recovery(*rig);
}

/// Where it counts from, and what it was told, is not known any more: nothing but a new start arms it.
TEST_P(CanFaults, ADriveThatRestarts) {
  const auto rig = pressing(GetParam());
  rig->drives().drive(0).reset(rig->now_ns());
  ASSERT_TRUE(rig->run_until([&] { return rig->mode() == Mode::fault; }, 120));
  rig->input.enable = true;
  int refusals = 0;
  for (int i = 0; i < 3000; ++i) {
    rig->input.clear_fault = rig->mode() == Mode::fault;
    rig->tick();
    ASSERT_EQ(rig->motor_Nm(), 0);
    ASSERT_NE(rig->mode(), Mode::enabled);
    refusals += rig->fault_text().find("restart hapticd") != std::string::npos ? 1 : 0;
  }
  EXPECT_GT(refusals, 0) << rig->fault_text();
}

/// The same without forces: what an e-stop that cuts the drives' power leaves behind.
TEST_P(CanFaults, ADriveThatWasWithoutPowerWhileNothingWasArmed) {
  const auto rig = pressing(GetParam());
  rig->input.enable = false;
  ASSERT_TRUE(rig->run_until([&] { return rig->mode() == Mode::idle; }, 300));
  rig->drives().drive(0).mute(true);
  for (int i = 0; i < 1200; ++i) rig->tick();
  rig->drives().drive(0).reset(rig->now_ns());
  rig->drives().drive(0).mute(false);
  EXPECT_FALSE(rig->recover());
  EXPECT_NE(rig->fault_text().find("restart hapticd"), std::string::npos) << rig->fault_text();
}

/// A moteus says for how long it has run: a short break is found, too, however long it has been watched.
TEST(CanRestart, AMoteusThatRestartedInAMomentIsNotArmed) {
  const Bus bus{"moteus", "reply_to_command"};
  CanRig rig(wall_on(bus));
  ASSERT_TRUE(rig.connect());
  for (int i = 0; i < 20'000; ++i) rig.tick();
  rig.drives().drive(0).reset(rig.now_ns());
  EXPECT_FALSE(rig.recover());
  EXPECT_NE(rig.fault_text().find("restart hapticd"), std::string::npos) << rig.fault_text();
}

/// Devices that are connected later take their time, and their buses fill meanwhile.
TEST_P(CanFaults, ALongWayFromConnectionToTheFirstTickLosesNoDrive) {
  CanRig rig(wall_on(GetParam()), usual_emulation());
  ASSERT_TRUE(rig.connect());
  rig.stand_still(3'000'000'000);
  EXPECT_TRUE(rig.enable()) << rig.fault_text();
}

TEST_P(CanFaults, ALoopThatStandsStillLeavesADriveThatWentOffByItself) {
  const auto rig = pressing(GetParam());
  rig->stand_still(30'000'000);
  EXPECT_EQ(rig->motor_Nm(), 0) << "the watchdog";
  rig->input.missed_ticks = 30;
  rig->tick();
  rig->input.missed_ticks = 0;
  ASSERT_TRUE(rig->run_until([&] { return rig->mode() == Mode::fault; }, 120));
  EXPECT_NE(rig->fault_text().find(is(GetParam(), "cia402") ? "heartbeat" : "watchdog"),
            std::string::npos)
      << rig->fault_text();
  EXPECT_EQ(rig->motor_Nm(), 0);
  expect_calm_recovery(*rig);
}

/// Questions go through and torques do not: samples stay fresh, and still the old torque must not stay.
TEST_P(CanFaults, ABusThatTakesNoTorque) {
  const auto rig = pressing(GetParam());
  rig->drop_commands(true);
  ASSERT_TRUE(rig->run_until([&] { return rig->mode() == Mode::fault; }, kStale + 2));
  EXPECT_NE(rig->fault_text().find("takes no torque"), std::string::npos) << rig->fault_text();
  rig->drop_commands(false);
  for (int i = 0; i < 3; ++i) rig->tick();
  EXPECT_EQ(rig->motor_Nm(), 0);
  expect_calm_recovery(*rig);
}

/// What lay in a queue while the drive was off is told to a drive that is off.
TEST_P(CanFaults, AnOldTorqueThatComesWhenForcesAreEnabledAgainMovesNothing) {
  const auto rig = pressing(GetParam());
  rig->drives().hold(true);  // frames pile up on their way
  for (int i = 0; i < 12; ++i) rig->tick();
  ASSERT_EQ(rig->mode(), Mode::fault);
  rig->drives().hold(false);
  rig->stand_still(30'000'000);  // all of it arrives, and then the drive's watchdog expires
  expect_calm_recovery(*rig);
}

/// A full queue: frames are dropped, not kept for later, and the fault comes from what is missing.
TEST_P(CanFaults, AQueueThatIsFull) {
  const auto rig = pressing(GetParam());
  rig->small_queue();
  rig->drives().hold(true);
  for (int i = 0; i < 10; ++i) rig->tick();
  EXPECT_GT(rig->device().traffic()->not_sent.load(), 0U);
  EXPECT_EQ(rig->mode(), Mode::fault);
  EXPECT_EQ(rig->cycle().output().fault.code, Fault::sample_missing);
  rig->drives().hold(false);
  for (int i = 0; i < 40; ++i) rig->tick();
  EXPECT_EQ(rig->motor_Nm(), 0);
  expect_calm_recovery(*rig);
}

TEST_P(CanFaults, AnInterfaceThatIsUnplugged) {
  const auto rig = pressing(GetParam());
  rig->drives().unplug("can0");
  rig->tick();
  rig->tick();
  EXPECT_EQ(rig->mode(), Mode::fault);
  EXPECT_NE(rig->fault_text().find("can0: the interface is gone"), std::string::npos)
      << rig->fault_text();
}

}  // namespace
}  // namespace hapticd::test
