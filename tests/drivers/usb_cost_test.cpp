// What a device on USB may cost: its calls in a tick take nothing from the heap, and coming and going leaves nothing behind.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/drivers/usb_configs.h"
#include "tests/support/heap_guard.h"
#include "tests/support/held_resources.h"

namespace hapticd::test {
namespace {

class UsbCost : public testing::TestWithParam<UsbCase> {
 protected:
  void SetUp() override {
    rig_ = usb_rig(GetParam().text(), GetParam().electronics());
    const auto info = rig_->connect();
    ASSERT_TRUE(info) << info.error().text;
    rig_->input.enable = true;
    ASSERT_TRUE(rig_->until([&] { return rig_->enabled(); })) << rig_->fault_text();
  }
  /// Heap calls of what the servo thread calls, once more in the time of a tick.
  long heap_calls() {
    const std::size_t axes = rig_->compiled().usb[0]->axes.size();
    const auto effort = std::span(rig_->cycle().output().effort).first(axes);
    std::array<AxisSample, kMaxAxesPerDevice> samples{};
    std::array<double, kMaxAxesPerDevice> delivered{};
    Aux aux;
    usb::UsbDevice& device = rig_->device();
    const HeapGuard guard;
    device.request({});
    (void)device.collect(std::span(samples).first(axes), aux);
    device.set_armed(!aux.faulted);
    device.command(effort, std::span(delivered).first(axes));
    if (aux.faulted) device.stop();
    return guard.calls();
  }
  std::unique_ptr<UsbRig> rig_;
};
INSTANTIATE_TEST_SUITE_P(All, UsbCost, testing::ValuesIn(kUsbCases), usb_case_name);

TEST_P(UsbCost, NoHeapCallInATickWhateverHappensToTheDevice) {
  if (!HeapGuard::available()) GTEST_SKIP() << "heap calls cannot be counted under this sanitizer";
  long calls = 0;
  const auto ticks = [&](int count) {
    for (int i = 0; i < count; ++i) {
      rig_->tick();
      calls += heap_calls();
    }
  };
  ticks(200);
  EXPECT_TRUE(rig_->enabled()) << rig_->fault_text();
  rig_->wire().unplug();
  ticks(50);
  EXPECT_TRUE(rig_->faulted());
  rig_->wire().plug(true, rig_->now_ns());
  for (int i = 0; i < 50 && !rig_->status_text().empty(); ++i) ticks(100);
  EXPECT_EQ(rig_->status_text(), "") << "it is there again";
  ticks(50);
  EXPECT_EQ(calls, 0);
}

/// A hundred times, a thousand with HAPTICD_LONG; a few under a sanitizer.
int reconnections() {
#ifdef HAPTICD_SANITIZED
  constexpr int kUsual = 10;
#else
  constexpr int kUsual = 100;
#endif
  return std::getenv("HAPTICD_LONG") != nullptr ? 1000 : kUsual;
}

TEST_P(UsbCost, ComingAndGoingLeavesNothingBehind) {
  const auto come_and_go = [&] {
    rig_->wire().unplug();
    ASSERT_TRUE(rig_->until([&] { return !rig_->status_text().empty(); }, 10));
    rig_->input.enable = false;
    rig_->ticks(GetParam().hold_ticks);
    rig_->wire().plug(true, rig_->now_ns());
    ASSERT_TRUE(rig_->until([&] { return rig_->status_text().empty(); }, 5000))
        << rig_->status_text();
    ASSERT_TRUE(rig_->until([&] { return rig_->sample().freshness >= Freshness::fresh; }));
    rig_->input.enable = rig_->input.clear_fault = true;
    ASSERT_TRUE(rig_->until([&] { return rig_->enabled(); })) << rig_->fault_text();
  };
  for (int i = 0; i < 3 && !HasFatalFailure(); ++i) come_and_go();
  const Held before = held();
  const int times = reconnections();
  for (int i = 0; i < times && !HasFatalFailure(); ++i) come_and_go();
  const Held after = held();
  EXPECT_EQ(after.descriptors, before.descriptors);
  constexpr std::size_t kBytesEach = 16;
  EXPECT_LE(after.heap_bytes, before.heap_bytes + kBytesEach * static_cast<std::size_t>(times));
  EXPECT_EQ(rig_->device().traffic()->connections.load(), static_cast<unsigned>(times) + 4);
}

}  // namespace
}  // namespace hapticd::test
