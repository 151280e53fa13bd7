// The port on hidapi: what it asks of hidapi, and what it makes of the answers.
#include "drivers/hid/hidapi_port.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "drivers/usb/this_host.h"
#include "tests/unit/usb/device_tree.h"
#include "tests/unit/usb/fake_hidapi.h"

namespace hapticd::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using usb::Status;

/// Ids 1 (4 bytes in) and 2 (4 bytes in and out), of 5 with the id.
const std::string kTwoIds(
    "\x06\x00\xff\x09\x01\xa1\x01\x15\x00\x26\xff\x00\x75\x08\x95\x04\x85\x01\x09\x01\x81\x02\x85"
    "\x02\x09\x01\x81\x02\x09\x01\x91\x02\xc0",
    33);

class Hidapi : public testing::Test {
 protected:
  void SetUp() override { fake_hidapi() = {}; }
  void open(const std::string& descriptor) {
    tree_.add_hid(kUhid, "hidraw0", descriptor);
    auto found = host_->open_hid(selection_);
    refusal_ = found ? usb::NotOpened{} : found.error();
    if (found) port_ = std::move(found->port);
  }
  /// A guard against a hang only.
  std::int64_t later() { return host_->now_ns() + 20'000'000'000; }
  HidBytes received() {
    const usb::Arrival arrival = port_->receive(later());
    EXPECT_EQ(arrival.status, Status::ok);
    return {arrival.bytes.begin(), arrival.bytes.end()};
  }

  DeviceTree tree_;
  usb::Selection selection_{.vendor = 0x1234, .product = 0x0006};
  std::unique_ptr<usb::Host> host_ = usb::host_at(tree_.roots());
  std::unique_ptr<usb::HidPort> port_;
  usb::NotOpened refusal_;
};

TEST_F(Hidapi, OpensTheNodeThatSysfsNamesAndClosesIt) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  EXPECT_EQ(fake_hidapi().opened, tree_.at("dev/hidraw0"));
  const auto& descriptor = port_->report_descriptor();
  EXPECT_EQ(std::string(descriptor.begin(), descriptor.end()), vendor_descriptor());
  port_.reset();
  EXPECT_EQ(fake_hidapi().closed, 1);
}

TEST_F(Hidapi, OfReportsThatWaitTheNewestIsHandedOutAndTheOthersAreCounted) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  for (std::uint8_t i = 1; i <= 4; ++i) fake_hidapi().waiting.push_back({i, 0});
  EXPECT_EQ(received(), (HidBytes{4, 0}));
  EXPECT_EQ(port_->skipped(), 3U);
  EXPECT_EQ(port_->receive(host_->now_ns()).status, Status::nothing);
}

TEST_F(Hidapi, ReportsOfOtherIdsAreKept) {
  open(kTwoIds);
  ASSERT_TRUE(port_) << refusal_.error.text;
  fake_hidapi().waiting = {{2, 1}, {1, 1}, {1, 2}};
  EXPECT_EQ(received(), (HidBytes{2, 1}));
  EXPECT_EQ(received(), (HidBytes{1, 2}));
  EXPECT_EQ(port_->skipped(), 1U);
}

TEST_F(Hidapi, AReportThatIsTooLongIsSeenToBe) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  fake_hidapi().waiting = {HidBytes(100, 1)};
  EXPECT_GT(received().size(), hid::kMostReportBytes);
}

TEST_F(Hidapi, AFloodDoesNotHoldTheThread) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  fake_hidapi().waiting.assign(1000, {1, 2});
  EXPECT_EQ(received(), (HidBytes{1, 2}));
  EXPECT_GE(fake_hidapi().waiting.size(), 900U);
}

TEST_F(Hidapi, AReportThatComesWhileItWaitsIsHandedOutAtOnce) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  fake_hidapi().while_waiting = [] { fake_hidapi().waiting = {{5, 5}}; };
  EXPECT_EQ(received(), (HidBytes{5, 5}));
}

TEST_F(Hidapi, AWakeEndsAWaitThatHidapiCannotEnd) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  fake_hidapi().while_waiting = [this] { host_->wake(); };
  EXPECT_EQ(port_->receive(later()).status, Status::nothing);
  EXPECT_EQ(fake_hidapi().longest_wait_ms, 1);
}

/// A node that is a device: a terminal, whose other end is the HID device's.
TEST_F(Hidapi, WaitsForReportsAndWakesAtOnceWhereItKnowsHidapisDescriptor) {
  const int other_end = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_TRUE(other_end >= 0 && ::unlockpt(other_end) == 0);
  tree_.add_hid(kUhid, "hidraw0", vendor_descriptor());
  tree_.remove("dev/hidraw0");
  std::filesystem::create_symlink(::ptsname(other_end), tree_.at("dev/hidraw0"));
  auto found = host_->open_hid(selection_);
  ASSERT_TRUE(found) << found.error().error.text;
  port_ = std::move(found->port);
  termios raw{};
  ::cfmakeraw(&raw);
  ::tcsetattr(fake_hidapi().descriptor, TCSANOW, &raw);
  std::thread([this] { host_->wake(); }).join();
  EXPECT_EQ(port_->receive(later()).status, Status::nothing);
  std::thread device([&] { EXPECT_EQ(::write(other_end, "\x07\x08", 2), 2); });
  EXPECT_EQ(received(), (HidBytes{7, 8}));
  device.join();
  EXPECT_EQ(fake_hidapi().longest_wait_ms, 0) << "hidapi's own wait cannot be ended";
  port_.reset();
  ::close(other_end);
}

TEST_F(Hidapi, ASignalIsNoUnplugging) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  fake_hidapi().read_error = EINTR;
  fake_hidapi().while_waiting = [] {
    fake_hidapi().read_error = 0;
    fake_hidapi().waiting = {{6, 6}};
  };
  EXPECT_EQ(received(), (HidBytes{6, 6}));
}

TEST_F(Hidapi, AReadThatFailsIsAnUnpluggedDeviceForGood) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  fake_hidapi().waiting = {{1, 1}};
  fake_hidapi().read_error = EIO;
  EXPECT_EQ(received(), (HidBytes{1, 1})) << "what came before is handed out";
  EXPECT_EQ(port_->receive(later()).status, Status::gone);
  EXPECT_EQ(port_->send(HidBytes{1}), Status::gone);
  EXPECT_EQ(port_->flush(later()), Status::gone);
}

TEST_F(Hidapi, AReportWithoutIdGoesOutBehindAZero) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  EXPECT_EQ(port_->send(HidBytes{7, 8}), Status::ok);
  EXPECT_THAT(fake_hidapi().written, ElementsAre(HidBytes{0, 7, 8}));
  EXPECT_EQ(port_->outgoing().sent, 1U);
  EXPECT_EQ(port_->outgoing().since_ns, 0);
  EXPECT_GE(port_->outgoing().worst_took_ns, port_->outgoing().last_took_ns);
}

/// The thread sees it only afterwards, and does not know when it came.
TEST_F(Hidapi, WhatComesWhileAReportGoesOutIsAsOldAsItMayBe) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  EXPECT_EQ(port_->receive(host_->now_ns()).status, Status::nothing);
  std::int64_t came_ns = 0;
  fake_hidapi().while_writing = [&] {
    came_ns = host_->now_ns();
    fake_hidapi().waiting.push_back({9});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  EXPECT_EQ(port_->send(HidBytes{7, 8}), Status::ok);
  const usb::Arrival arrival = port_->receive(later());
  ASSERT_EQ(arrival.status, Status::ok);
  EXPECT_LE(arrival.stamp_ns, came_ns);
  fake_hidapi().while_writing = {};
  EXPECT_EQ(port_->receive(host_->now_ns()).status, Status::nothing);
  const std::int64_t later_ns = host_->now_ns();
  fake_hidapi().waiting.push_back({10});
  EXPECT_GE(port_->receive(later()).stamp_ns, later_ns) << "it looks again";
}

TEST_F(Hidapi, AReportWithIdGoesOutAsItIs) {
  open(kTwoIds);
  ASSERT_TRUE(port_) << refusal_.error.text;
  EXPECT_EQ(port_->send(HidBytes{2, 8}), Status::ok);
  EXPECT_THAT(fake_hidapi().written, ElementsAre(HidBytes{2, 8}));
}

TEST_F(Hidapi, AWriteThatFailsSaysHow) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  for (const auto& [error, status] :
       {std::pair{EPIPE, Status::stalled}, std::pair{ETIMEDOUT, Status::failed},
        std::pair{ENODEV, Status::gone}}) {
    fake_hidapi().write_error = error;
    EXPECT_EQ(port_->send(HidBytes{1}), status);
  }
  fake_hidapi().write_error = 0;
  EXPECT_EQ(port_->send(HidBytes{1}), Status::gone);
  EXPECT_EQ(port_->outgoing().sent, 0U);
}

TEST_F(Hidapi, FeaturesGoBothWaysWithTheirId) {
  open(vendor_descriptor());
  ASSERT_TRUE(port_) << refusal_.error.text;
  EXPECT_EQ(port_->set_feature(HidBytes{0, 4}), Status::ok);
  EXPECT_THAT(fake_hidapi().features, ElementsAre(HidBytes{0, 4}));
  HidBytes answer{0, 0, 0};
  EXPECT_EQ(port_->get_feature(answer), 0U);
  fake_hidapi().feature = {0, 3, 4};
  EXPECT_EQ(port_->get_feature(answer), 3U);
  EXPECT_EQ(answer, (HidBytes{0, 3, 4}));
}

TEST_F(Hidapi, ADescriptorThatIsNoneIsRefusedBeforeTheNodeIsOpened) {
  open("\xa1\x01\x75");
  EXPECT_FALSE(port_);
  EXPECT_FALSE(refusal_.absent);
  EXPECT_THAT(refusal_.error.text, HasSubstr("Emulated (1234:0006, serial U1"));
  EXPECT_EQ(fake_hidapi().opened, "");
}

TEST_F(Hidapi, ANodeThatDoesNotOpenIsRefusedInHidapisWords) {
  fake_hidapi().refusal = "Some reason";
  open(vendor_descriptor());
  EXPECT_FALSE(port_);
  EXPECT_FALSE(refusal_.absent);
  EXPECT_THAT(refusal_.error.text, HasSubstr("Some reason"));
}

TEST_F(Hidapi, ANodeThatIsNotThereIsRefused) {
  tree_.add_hid(kUhid, "hidraw0", vendor_descriptor());
  tree_.remove("dev/hidraw0");
  const auto found = host_->open_hid(selection_);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().error.text, HasSubstr("has no node"));
}

TEST(HidapiDescriptor, IsFoundWhereTheProcessHasOneAlone) {
  EXPECT_EQ(hid::descriptor_of("/dev/full"), -1);
  const int one = ::open("/dev/full", O_RDWR | O_CLOEXEC);
  EXPECT_EQ(hid::descriptor_of("/dev/full"), one);
  const int two = ::open("/dev/full", O_RDWR | O_CLOEXEC);
  EXPECT_EQ(hid::descriptor_of("/dev/full"), -1);
  ::close(two);
  ::close(one);
  const DeviceTree tree;
  tree.write("dev/hidraw0", "");
  EXPECT_EQ(hid::descriptor_of(tree.at("dev/hidraw0")), -1) << "no character device";
}

}  // namespace
}  // namespace hapticd::test
