// A wall felt through each USB device, in virtual time: driver, its thread, wire, electronics and mechanics.
#include <gtest/gtest.h>

#include "tests/drivers/usb_configs.h"

namespace hapticd::test {
namespace {

using control::Mode;

class UsbSeam : public testing::TestWithParam<UsbCase> {
 protected:
  std::unique_ptr<UsbRig> connected(const sim::usb::WireOptions& wire = {}) {
    auto rig = usb_rig(GetParam().text(), GetParam().electronics(), wire);
    const auto info = rig->connect();
    if (!info) throw std::runtime_error(info.error().text);
    return rig;
  }
  std::unique_ptr<UsbRig> pressing() {
    auto rig = connected();
    rig->input.enable = true;
    if (!rig->until([&] { return rig->enabled(); }))
      throw std::runtime_error("not enabled: " + rig->fault_text() + rig->status_text());
    rig->ticks(1000);
    return rig;
  }
};
INSTANTIATE_TEST_SUITE_P(All, UsbSeam, testing::ValuesIn(kUsbCases), usb_case_name);

TEST_P(UsbSeam, WallHoldsTheHand) {
  const auto rig = pressing();
  ASSERT_TRUE(rig->enabled()) << rig->fault_text();
  rig->ticks(2000);
  EXPECT_NEAR(daemon::largest_contact_force_N(rig->program()), GetParam().held_N,
              0.02 * GetParam().held_N)
      << "the motors make what they are told, where the encoders say";
  EXPECT_GT(rig->torque(), 0);
  EXPECT_LE(rig->sample().age_ns, std::llround(1e9 * rig->compiled().usb[0]->worst_sample_age_s));
}

TEST_P(UsbSeam, NoForceBeforeItIsEnabled) {
  const auto rig = connected();
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(rig->torque(), 0);
    rig->tick();
  }
  EXPECT_EQ(rig->mode(), Mode::idle) << rig->fault_text();
}

TEST_P(UsbSeam, DisableAndDisconnectLeaveNoForce) {
  const auto rig = pressing();
  rig->input.enable = false;
  ASSERT_TRUE(rig->until([&] { return rig->mode() == Mode::idle; }));
  rig->ticks(10);
  EXPECT_EQ(rig->torque(), 0);
  rig->input.enable = true;
  ASSERT_TRUE(rig->until([&] { return rig->enabled(); })) << rig->fault_text();
  rig->ticks(500);
  EXPECT_GT(rig->torque(), 0);
  rig->device().disconnect();
  rig->stand_still(5'000'000);  // the last packet is still on its way
  EXPECT_EQ(rig->torque(), 0);
}

}  // namespace
}  // namespace hapticd::test
