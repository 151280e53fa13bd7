// What cable and host controller promise.
#include <gtest/gtest.h>

#include "tests/unit/emulators/usb_numbering_device.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::usb;

TEST(Wire, InterruptEndpointIsServedOnceAnInterval) {
  NumberingDevice device;
  UsbHost host(device);
  for (int i = 0; i < 5; ++i) host.in(3);
  host.run_for(0.0201);
  ASSERT_EQ(host.all.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(host.all[i].at_ns, static_cast<std::int64_t>(i) * 4'000'000);
    EXPECT_EQ(host.all[i].bytes[0], i + 1);
  }
}

TEST(Wire, AnIntervalIsKeptWhileOthersAreServedInEachFrame) {
  NumberingDevice device;
  UsbHost host(device);
  for (int i = 0; i < 100; ++i) host.in(1);
  for (int i = 0; i < 3; ++i) host.in(3);
  host.run_for(0.0101);
  std::vector<std::int64_t> at_ns;
  for (const auto& done : host.all)
    if (done.id > 100) at_ns.push_back(done.at_ns);
  EXPECT_EQ(at_ns, (std::vector<std::int64_t>{0, 4'000'000, 8'000'000}));
}

TEST(Wire, AtHighSpeedAnIntervalIsAPowerOfTwoOfMicroframes) {
  NumberingDevice device(Speed::high);
  UsbHost host(device);
  for (int i = 0; i < 3; ++i) host.in(3);
  host.run_for(0.01);
  ASSERT_EQ(host.all.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(host.all[i].at_ns, static_cast<std::int64_t>(i) * 8 * 125'000);
}

TEST(Wire, WhatIsSubmittedLateWaitsForTheNextFrame) {
  NumberingDevice device;
  UsbHost host(device);
  host.run_to(3'200'000);
  host.out(1, {1});
  host.run_to(3'900'000);
  EXPECT_TRUE(device.taken.empty());
  host.run_to(4'000'000);
  ASSERT_EQ(device.taken.size(), 1u);
  EXPECT_EQ(device.taken[0].at_ns, 4'000'000);
  host.out(1, {2});  // the frame that starts now has begun
  host.run_to(4'999'999);
  EXPECT_EQ(device.taken.size(), 1u);
}

TEST(Wire, AFrameCarriesAllBulkPacketsThatAreThere) {
  NumberingDevice device;
  device.packets = 3;
  UsbHost host(device);
  for (int i = 0; i < 4; ++i) host.in(1);
  host.run_for(0.5e-3);
  EXPECT_EQ(host.all.size(), 3u);
  device.packets = 1;
  host.run_for(0.5e-3);
  EXPECT_EQ(host.all.size(), 4u);
  device.packets = -1;
  for (int i = 0; i < 40; ++i) host.in(1);
  host.run_for(1e-3);
  EXPECT_EQ(host.all.size(), 4u + 19u);  // as many as fit
}

TEST(Wire, ATransferEndsWithAPacketThatIsNotFull) {
  NumberingDevice device;
  device.packet_bytes = 64;
  device.packets = 2;
  UsbHost host(device);
  const auto id = host.in(1, 512);
  host.run_for(1e-3);
  EXPECT_EQ(host.done(id), nullptr);
  device.packet_bytes = 10;
  device.packets = 1;
  host.run_for(1e-3);
  ASSERT_NE(host.done(id), nullptr);
  EXPECT_EQ(host.done(id)->bytes.size(), 138u);
  device.packet_bytes = 64;
  device.packets = 1;
  const auto exact = host.in(1, 64);
  host.run_for(1e-3);
  ASSERT_NE(host.done(exact), nullptr);
  EXPECT_EQ(host.done(exact)->bytes.size(), 64u);
}

TEST(Wire, LongOutGoesPacketByPacket) {
  NumberingDevice device;
  UsbHost host(device);
  host.write(1, UsbBytes(130, 5));
  ASSERT_EQ(device.taken.size(), 3u);
  EXPECT_EQ(device.taken[2].bytes.size(), 2u);
}

TEST(Wire, ATransferWaitsUntilTheDeviceIsReady) {
  NumberingDevice device;
  device.packets = 0;
  device.deaf_until_ns = 7'500'000;
  UsbHost host(device);
  const auto in = host.in(3), out = host.out(1, {1, 2});
  host.run_to(7'000'000);
  EXPECT_TRUE(host.all.empty());
  device.packets = 1;
  host.run_to(8'000'000);
  ASSERT_NE(host.done(in), nullptr);
  ASSERT_NE(host.done(out), nullptr);
  EXPECT_EQ(host.done(in)->at_ns, 8'000'000);
  ASSERT_EQ(device.taken.size(), 1u);
}

TEST(Wire, AStalledEndpointStaysSoUntilTheHostClearsIt) {
  NumberingDevice device;
  UsbHost host(device);
  host.wire.stall(0x81);
  host.wire.stall(0x03);
  host.out(3, {1});
  host.out(3, {2});
  host.run_for(1e-3);
  ASSERT_EQ(host.all.size(), 2u);  // also where a frame has but one packet
  EXPECT_EQ(host.all[1].end, End::stalled);
  const auto first = host.in(1), second = host.in(1), other = host.in(3);
  host.run_for(5e-3);
  ASSERT_NE(host.done(first), nullptr);
  EXPECT_EQ(host.done(first)->end, End::stalled);
  EXPECT_EQ(host.done(second)->end, End::stalled);
  EXPECT_EQ(host.done(other)->end, End::ok);
  EXPECT_EQ(host.ask({0x82, 0, 0, 0x81, 2}).bytes, (UsbBytes{1, 0}));
  const auto third = host.in(1);
  host.run_for(2e-3);
  EXPECT_EQ(host.done(third)->end, End::stalled);
  EXPECT_TRUE(usb_acked(host.ask({0x02, 1, 0, 0x81, 0})));
  EXPECT_EQ(host.ask({0x82, 0, 0, 0x81, 2}).bytes, (UsbBytes{0, 0}));
  const auto fourth = host.in(1);
  host.run_for(2e-3);
  ASSERT_NE(host.done(fourth), nullptr);
  EXPECT_EQ(host.done(fourth)->end, End::ok);
}

TEST(Wire, WhatIsCancelledNeverCompletes) {
  NumberingDevice device;
  device.packets = 0;
  UsbHost host(device);
  const auto first = host.in(1), second = host.in(1);
  EXPECT_TRUE(host.wire.cancel(first));
  EXPECT_FALSE(host.wire.cancel(first));
  device.packets = -1;
  host.run_for(5e-3);
  EXPECT_EQ(host.done(first), nullptr);
  ASSERT_NE(host.done(second), nullptr);
  EXPECT_EQ(host.done(second)->bytes[0], 1);
  EXPECT_FALSE(host.wire.cancel(second));
}

TEST(Wire, UnpluggingEndsAllThatWaits) {
  NumberingDevice device;
  device.packets = 0;
  UsbHost host(device);
  const auto bulk = host.in(1), interrupt = host.in(3);
  host.run_for(1e-3);
  host.wire.unplug();
  const auto late = host.out(1, {1});
  host.run_for(1e-3);
  for (const auto id : {bulk, interrupt, late}) {
    ASSERT_NE(host.done(id), nullptr);
    EXPECT_EQ(host.done(id)->end, End::gone);
  }
  EXPECT_TRUE(device.taken.empty());
  EXPECT_TRUE(usb_stalled(host.ask({0x80, 6, 0x0100, 0, 18})));
  host.wire.plug(true, host.now_ns);
  EXPECT_EQ(device.lost, 1);
  host.write(1, {1});
  EXPECT_EQ(device.taken.size(), 1u);
}

TEST(Wire, WhileTheDeviceHangsNothingHappens) {
  NumberingDevice device;
  UsbHost host(device);
  host.run_for(0.5e-3);
  host.wire.hang(20'300'000);
  const auto in = host.in(1);
  EXPECT_EQ(host.ask({0x80, 6, 0x0100, 0, 18}).kind, Answer::Kind::nak);
  host.run_to(20'900'000);
  EXPECT_EQ(host.done(in), nullptr);
  EXPECT_TRUE(usb_acked(host.ask({0x80, 6, 0x0100, 0, 18})));
  host.run_to(21'000'000);
  ASSERT_NE(host.done(in), nullptr);
  EXPECT_EQ(host.done(in)->at_ns, 21'000'000);
}

TEST(Wire, StandardRequestsAreAnswered) {
  NumberingDevice device;
  UsbHost host(device);
  EXPECT_EQ(host.ask({0x80, 6, 0x0100, 0, 64}).bytes, device.device_descriptor());
  EXPECT_EQ(host.ask({0x80, 6, 0x0100, 0, 8}).bytes.size(), 8u);
  const UsbBytes head = host.ask({0x80, 6, 0x0200, 0, 9}).bytes;
  ASSERT_EQ(head.size(), 9u);
  EXPECT_EQ(host.ask({0x80, 6, 0x0200, 0, 255}).bytes.size(), std::size_t{head[2]});
  EXPECT_EQ(host.ask({0x80, 6, 0x0300, 0, 255}).bytes, (UsbBytes{4, 3, 9, 4}));
  EXPECT_EQ(host.ask({0x80, 6, 0x0302, 0x0409, 255}).bytes,
            (UsbBytes{12, 3, 'M', 0, 0xfc, 0, 'h', 0, 'l', 0, 'e', 0}));
  EXPECT_TRUE(usb_stalled(host.ask({0x80, 6, 0x0303, 0x0409, 255})));
  EXPECT_EQ(host.ask({0x81, 6, 0x2200, 0, 255}).bytes, (UsbBytes{1, 2, 3}));
  EXPECT_EQ(host.ask({0x81, 6, 0x2100, 0, 255}).bytes.size(), 9u);
  EXPECT_TRUE(usb_stalled(host.ask({0x81, 6, 0x2200, 1, 255})));
  EXPECT_TRUE(usb_stalled(host.ask({0x80, 6, 0x0600, 0, 10})));  // qualifier: full speed only
  EXPECT_TRUE(usb_acked(host.ask({0x00, 9, 1, 0, 0})));
  EXPECT_EQ(host.ask({0x80, 8, 0, 0, 1}).bytes, (UsbBytes{1}));
  EXPECT_TRUE(usb_stalled(host.ask({0x00, 9, 2, 0, 0})));
  EXPECT_TRUE(usb_acked(host.ask({0x01, 11, 0, 0, 0})));
  EXPECT_TRUE(usb_stalled(host.ask({0x01, 11, 1, 0, 0})));
  EXPECT_TRUE(usb_stalled(host.ask({0x01, 11, 0, 5, 0})));
  EXPECT_EQ(host.ask({0x80, 0, 0, 0, 2}).bytes, (UsbBytes{0, 0}));
  EXPECT_TRUE(usb_stalled(host.ask({0x00, 99, 0, 0, 0})));
  EXPECT_EQ(device.controls, 0);
}

TEST(Wire, OtherRequestsAreTheDevices) {
  NumberingDevice device;
  UsbHost host(device);
  EXPECT_EQ(host.ask({0xc0, 7, 0, 0, 2}).bytes, (UsbBytes{9, 8}));  // as much as was asked for
  EXPECT_TRUE(usb_stalled(host.ask({0x40, 8, 0, 0, 0})));
  EXPECT_EQ(device.controls, 2);
}

TEST(Wire, AnEndpointThatIsNotThereStalls) {
  NumberingDevice device;
  UsbHost host(device);
  const auto id = host.in(9);
  host.run_for(1e-3);
  ASSERT_NE(host.done(id), nullptr);
  EXPECT_EQ(host.done(id)->end, End::stalled);
}

}  // namespace
}  // namespace hapticd::test::emulator
