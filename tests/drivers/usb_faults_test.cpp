// Everything that goes wrong with a device on USB: within how many ticks its motors are without force, which words name
// the cause, and that nothing old comes back when the operator enables again.
#include <gtest/gtest.h>

#include <functional>

#include "tests/drivers/usb_configs.h"

namespace hapticd::test {
namespace {

using control::Mode;

/// guard.max_stale_ticks, what a sample may be old in ticks, and one.
constexpr int kStaleTicks = 3 + 4 + 1;

#ifdef HAPTICD_SANITIZED
constexpr std::int64_t kEvery_ms = 211;
#else
constexpr std::int64_t kEvery_ms = 17;
#endif

class UsbFaults : public testing::TestWithParam<UsbCase> {
 protected:
  std::unique_ptr<UsbRig> pressing() {
    auto rig = usb_rig(GetParam().text(), GetParam().electronics());
    const auto info = rig->connect();
    if (!info) throw std::runtime_error(info.error().text);
    enable(*rig);
    rig->ticks(1000);
    if (!rig->enabled() || rig->torque() == 0) throw std::runtime_error("no force");
    return rig;
  }
  static void enable(UsbRig& rig) {
    rig.input.enable = rig.input.clear_fault = true;
    if (!rig.until([&] { return rig.enabled(); }))
      throw std::runtime_error("not enabled: " + rig.fault_text() + rig.status_text());
  }
  /// After `ticks` in fault, and from then on without force.
  static void expect_no_force(UsbRig& rig, int ticks, int for_ticks = 300) {
    rig.ticks(ticks);
    ASSERT_TRUE(rig.faulted());
    rig.input.enable = false;
    for (int i = 0; i < for_ticks; ++i) {
      ASSERT_EQ(rig.torque(), 0) << i << " ticks too late; " << rig.fault_text();
      rig.tick();
      ASSERT_TRUE(rig.faulted()) << "it left its fault by itself";
    }
  }
  /// No force before the ramp; then the wall is felt as before.
  static void expect_recovery(UsbRig& rig) {
    rig.input.enable = rig.input.clear_fault = true;
    double most = 0;
    for (int i = 0; i < 3000 && !rig.enabled(); ++i) {
      most = std::max(most, rig.torque());
      if (rig.faulted()) rig.input.clear_fault = true;
      rig.tick();
    }
    ASSERT_TRUE(rig.enabled()) << rig.fault_text() << rig.status_text();
    EXPECT_EQ(most, 0);
    EXPECT_EQ(rig.torque(), 0) << "a kick";
    rig.ticks(1500);  // what was pressed in deeply meanwhile bounces first
    ASSERT_TRUE(rig.enabled()) << rig.fault_text();
    EXPECT_GT(rig.torque(), 0);
  }
};
INSTANTIATE_TEST_SUITE_P(All, UsbFaults, testing::ValuesIn(kUsbCases), usb_case_name);

TEST_P(UsbFaults, UnpluggedUnderForceIsAFaultInTheNextTick) {
  const auto rig = pressing();
  rig->wire().unplug();
  rig->tick();
  rig->tick();  // the first may have begun before
  EXPECT_TRUE(rig->faulted());
  EXPECT_NE(rig->fault_text().find("unplugged"), std::string::npos) << rig->fault_text();
  for (const double effort : rig->cycle().output().effort) EXPECT_EQ(effort, 0);
}

TEST_P(UsbFaults, ReplugIsFoundAndNothingMovesUntilAnOperatorSaysSo) {
  const auto rig = pressing();
  rig->wire().unplug();
  rig->ticks(5);
  ASSERT_TRUE(rig->faulted());
  rig->input.enable = false;
  rig->ticks(GetParam().hold_ticks);
  rig->wire().plug(true, rig->now_ns());
  for (int i = 0; i < 3000; ++i) {
    rig->tick();
    ASSERT_TRUE(rig->faulted());
    ASSERT_EQ(rig->torque(), 0) << i;
  }
  EXPECT_EQ(rig->status_text(), "") << "it is there again";
  expect_recovery(*rig);
}

TEST_P(UsbFaults, EnableWhileItIsAwayStaysAFault) {
  const auto rig = pressing();
  rig->wire().unplug();
  rig->ticks(5);
  for (int i = 0; i < 100; ++i) {
    rig->input.enable = rig->input.clear_fault = true;
    rig->tick();
    ASSERT_TRUE(rig->faulted());
  }
  rig->input.enable = false;
  rig->wire().plug(false, rig->now_ns());
  ASSERT_TRUE(rig->until([&] { return rig->status_text().empty(); })) << rig->status_text();
  rig->ticks(50);
  expect_recovery(*rig);
}

TEST_P(UsbFaults, BriefUnplugBetweenTwoTicksIsSeen) {
  const auto rig = pressing();
  rig->wire().unplug();
  rig->stand_still(500'000'000);
  rig->wire().plug(false, rig->now_ns());
  rig->stand_still(3'000'000'000);
  rig->tick();
  rig->tick();
  EXPECT_TRUE(rig->faulted()) << "it went and came back while the loop stood still";
  EXPECT_EQ(rig->torque(), 0);
}

TEST_P(UsbFaults, HangingDeviceIsAFault) {
  const auto rig = pressing();
  rig->wire().hang(rig->now_ns() + 2'000'000'000);
  const int silent = std::string(GetParam().name) == "openffboard" ? 160 : kStaleTicks;
  rig->ticks(silent);
  EXPECT_TRUE(rig->faulted());
  for (const double effort : rig->cycle().output().effort) EXPECT_EQ(effort, 0);
  rig->input.enable = false;
  rig->ticks(4000);
  EXPECT_EQ(rig->torque(), 0);
  expect_recovery(*rig);
}

TEST_P(UsbFaults, LoopThatHangsLeavesNoForce) {
  const auto rig = pressing();
  rig->stand_still(60'000'000);
  EXPECT_EQ(rig->torque(), 0) << "the device's own thread watches over the loop";
}

TEST_P(UsbFaults, StalledEndpointIsAFault) {
  const auto rig = pressing();
  rig->wire().stall(std::string(GetParam().name) == "openffboard" ? 0x83 : 0x81);
  expect_no_force(*rig, kStaleTicks + GetParam().hold_ticks);
}

TEST_P(UsbFaults, DeviceThatIsNotThereIsWaitedFor) {
  auto rig = usb_rig(GetParam().text(), GetParam().electronics());
  rig->wire().unplug();
  const auto info = rig->connect();
  ASSERT_TRUE(info) << info.error().text;
  EXPECT_NE(info->model.find("not plugged in"), std::string::npos) << info->model;
  rig->input.enable = true;
  rig->ticks(300);
  EXPECT_EQ(rig->mode(), Mode::idle) << rig->fault_text();
  EXPECT_NE(rig->status_text().find("not plugged in"), std::string::npos) << rig->status_text();
  rig->wire().plug(true, rig->now_ns());
  EXPECT_TRUE(rig->until([&] { return rig->enabled(); }, 5000))
      << rig->fault_text() << rig->status_text();
}

TEST_P(UsbFaults, UnpluggedAtAnyTimeOfTheSetUpNeitherHangsNorArms) {
  for (std::int64_t at_ms = 0; at_ms < 1000; at_ms += kEvery_ms) {
    auto rig = usb_rig(GetParam().text(), GetParam().electronics());
    rig->wire().unplug();
    ASSERT_TRUE(rig->connect());
    rig->input.enable = true;
    rig->wire().plug(true, rig->now_ns());
    rig->ticks(static_cast<int>(at_ms));
    rig->wire().unplug();
    rig->ticks(20);
    ASSERT_FALSE(rig->enabled()) << at_ms;
    rig->input.enable = false;
    rig->wire().plug(true, rig->now_ns());
    ASSERT_TRUE(rig->until([&] { return rig->status_text().empty(); }, 5000))
        << at_ms << " " << rig->status_text();
    rig->ticks(3);
    enable(*rig);
    rig->ticks(50);
    ASSERT_TRUE(rig->enabled()) << at_ms << rig->fault_text();
  }
}

}  // namespace
}  // namespace hapticd::test
