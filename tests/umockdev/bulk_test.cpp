// The port on libusb for bulk endpoints, with the real libusb: what is under way, how it ends, who gets what.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>

#include "drivers/usb/this_host.h"
#include "tests/support/held_resources.h"
#include "tests/umockdev/devices.h"

namespace hapticd::test {
namespace {

using namespace usb;
using testing::ElementsAre;
using testing::HasSubstr;

const Selection kFalcon{.vendor = 0x0403, .product = 0xcb48};

class Bulk : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(umockdev_in_mock_environment()) << "to be run by umockdev-wrapper";
    usbfs_.plug(falcon_texts());
  }
  void open(const Selection& selection = kFalcon) {
    auto found = host_->open_bulk(selection, 0x81, 0x02);
    ASSERT_TRUE(found) << found.error().error.text;
    port_ = std::move(found->port);
  }
  /// A guard against a hang only.
  std::int64_t later() { return host_->now_ns() + 20'000'000'000; }
  std::int64_t now() { return host_->now_ns(); }
  Bytes received() {
    const Arrival arrival = port_->receive(later());
    EXPECT_EQ(arrival.status, Status::ok);
    return {arrival.bytes.begin(), arrival.bytes.end()};
  }
  std::size_t logged(const std::string& text) {
    const auto log = usbfs_.log();
    return static_cast<std::size_t>(std::ranges::count(log, text));
  }

  FakeUsbfs usbfs_;
  std::unique_ptr<Host> host_ = this_host();
  std::unique_ptr<BulkPort> port_;
};

TEST_F(Bulk, OpensWithoutLookingForOthersAndSaysWhatItFound) {
  auto found = host_->open_bulk(kFalcon, 0x81, 0x02);
  ASSERT_TRUE(found) << found.error().error.text;
  EXPECT_EQ(found->product, "Maker Device");
  EXPECT_EQ(found->serial, "S1");
  EXPECT_EQ(found->path, "1-2");
  EXPECT_EQ(found->interval_s, 1e-3);
  EXPECT_THAT(usbfs_.log(), ElementsAre("claim 0"));
}

TEST_F(Bulk, AsManyReadsAreUnderWayAsWantedAndAfterEachArrivalAgain) {
  Selection selection = kFalcon;
  selection.reads = 4;
  open(selection);
  EXPECT_EQ(usbfs_.reads_under_way(), 4U);
  for (std::uint8_t i = 1; i <= 9; ++i) usbfs_.say({0x31, 0x60, i});
  for (std::uint8_t i = 1; i <= 9; ++i) EXPECT_EQ(received(), (Bytes{0x31, 0x60, i}));
  EXPECT_EQ(port_->receive(now()).status, Status::nothing);
  EXPECT_EQ(usbfs_.reads_under_way(), 4U);
  EXPECT_EQ(port_->skipped(), 0U);
}

TEST_F(Bulk, AStampIsNotBeforeTheArrivalNorAfterItsReceipt) {
  open();
  const std::int64_t before_ns = now();
  usbfs_.say({0x31, 0x60});
  const Arrival arrival = port_->receive(later());
  EXPECT_GE(arrival.stamp_ns, before_ns);
  EXPECT_LE(arrival.stamp_ns, now());
}

TEST_F(Bulk, AFullPacketIsHandedOutThoughNoShortOneFollows) {
  open();
  const Bytes packet(64, 0x41);
  usbfs_.say(packet);
  EXPECT_EQ(received(), packet);
}

TEST_F(Bulk, WhileOneIsOnItsWayTheNewestWaitsAndTheOthersAreReplaced) {
  open();
  usbfs_.hold_out(true);
  for (std::uint8_t i = 1; i <= 4; ++i) EXPECT_EQ(port_->send(Bytes{i}), Status::ok);
  EXPECT_EQ(port_->outgoing().replaced, 2U);
  EXPECT_NE(port_->outgoing().since_ns, 0);
  EXPECT_EQ(port_->flush(now()), Status::nothing);
  usbfs_.hold_out(false);
  usbfs_.end_out();
  EXPECT_EQ(port_->flush(later()), Status::ok);
  EXPECT_THAT(usbfs_.sent(), ElementsAre(Bytes{1}, Bytes{4}));
  EXPECT_EQ(port_->outgoing().sent, 2U);
  EXPECT_EQ(port_->outgoing().since_ns, 0);
  EXPECT_GE(port_->outgoing().worst_took_ns, port_->outgoing().last_took_ns);
}

TEST_F(Bulk, WhatIsTooLongOrEmptyIsNotTaken) {
  open();
  EXPECT_EQ(port_->send(Bytes(513)), Status::failed);
  EXPECT_EQ(port_->send({}), Status::failed);
  EXPECT_TRUE(usbfs_.sent().empty());
}

TEST_F(Bulk, ARequestCarriesItsValueAndNoData) {
  open();
  EXPECT_EQ(port_->request(0x40, 3, 0x4138), Status::ok);
  ASSERT_EQ(usbfs_.requests().size(), 1U);
  const ControlRequest request = usbfs_.requests().front();
  EXPECT_EQ(request.type, 0x40);
  EXPECT_EQ(request.request, 3);
  EXPECT_EQ(request.value, 0x4138);
  EXPECT_EQ(request.index, 0);
  EXPECT_TRUE(request.data.empty());
}

TEST_F(Bulk, ARequestThatIsRefusedIsAStall) {
  open();
  usbfs_.control = [](const ControlRequest&) { return std::optional<Bytes>{}; };
  EXPECT_EQ(port_->request(0x40, 9, 1), Status::stalled);
}

TEST_F(Bulk, WhatArrivesDuringARequestIsKept) {
  open();
  usbfs_.say({1});
  usbfs_.say({2});
  EXPECT_EQ(port_->request(0x40, 9, 1), Status::ok);
  EXPECT_EQ(received(), Bytes{1});
  EXPECT_EQ(received(), Bytes{2});
}

TEST_F(Bulk, AWakeEndsTheWaitThatIsOrTheNextOne) {
  open();
  const std::int64_t much_later_ns = later();
  host_->wake();
  host_->wake();
  EXPECT_EQ(port_->receive(much_later_ns).status, Status::nothing);
  host_->wake();
  usbfs_.say({7});
  EXPECT_EQ(received(), Bytes{7});
  EXPECT_EQ(port_->receive(much_later_ns).status, Status::nothing);
  EXPECT_LT(host_->now_ns(), much_later_ns) << "it was not the time that ended a wait";
}

TEST_F(Bulk, AStallIsToldOnceAndReadingGoesOnAfterTheHaltIsCleared) {
  open();
  usbfs_.say({1});
  usbfs_.say({}, -EPIPE);
  EXPECT_EQ(received(), Bytes{1});
  EXPECT_EQ(port_->receive(later()).status, Status::stalled);
  EXPECT_EQ(logged("clear halt 81"), 1U);
  EXPECT_EQ(usbfs_.reads_under_way(), 2U);
  usbfs_.say({2});
  EXPECT_EQ(received(), Bytes{2});
}

TEST_F(Bulk, AFailedReadIsToldOnceAndReadingGoesOn) {
  open();
  usbfs_.say({}, -EPROTO);
  EXPECT_EQ(port_->receive(later()).status, Status::failed);
  EXPECT_EQ(logged("clear halt 81"), 0U);
  usbfs_.say({2});
  EXPECT_EQ(received(), Bytes{2});
}

TEST_F(Bulk, AHaltedWriteIsToldWithTheNextOneWhichGoesOut) {
  open();
  usbfs_.hold_out(true);
  EXPECT_EQ(port_->send(Bytes{1}), Status::ok);
  EXPECT_EQ(port_->send(Bytes{2}), Status::ok);
  usbfs_.end_out(-EPIPE);
  usbfs_.hold_out(false);
  EXPECT_EQ(port_->send(Bytes{3}), Status::stalled);
  EXPECT_EQ(logged("clear halt 2"), 1U);
  EXPECT_EQ(port_->flush(later()), Status::ok);
  EXPECT_THAT(usbfs_.sent(), ElementsAre(Bytes{1}, Bytes{3}));
  EXPECT_EQ(port_->outgoing().sent, 1U);
}

TEST_F(Bulk, AFailedWriteIsToldByFlush) {
  open();
  usbfs_.hold_out(true);
  EXPECT_EQ(port_->send(Bytes{1}), Status::ok);
  usbfs_.end_out(-EPROTO);
  EXPECT_EQ(port_->flush(later()), Status::failed);
  EXPECT_EQ(port_->flush(later()), Status::ok);
}

/// The kernel ends transfers of a device that goes with one of these.
class UnpluggedBulk : public Bulk, public testing::WithParamInterface<int> {};
INSTANTIATE_TEST_SUITE_P(Statuses, UnpluggedBulk, testing::Values(-ENODEV, -ESHUTDOWN, -ENOENT));

TEST_P(UnpluggedBulk, TellsSoOfEverythingWithTransfersUnderWayAndCloses) {
  open();
  usbfs_.hold_out(true);
  EXPECT_EQ(port_->send(Bytes{1}), Status::ok);
  EXPECT_EQ(port_->send(Bytes{2}), Status::ok);
  usbfs_.say({9});
  usbfs_.unplug(GetParam());
  EXPECT_EQ(received(), Bytes{9});
  EXPECT_EQ(port_->receive(later()).status, Status::gone);
  EXPECT_EQ(port_->receive(later()).status, Status::gone);
  EXPECT_EQ(port_->send(Bytes{3}), Status::gone);
  EXPECT_EQ(port_->request(0x40, 0, 1), Status::gone);
  EXPECT_NE(port_->flush(later()), Status::ok);
  EXPECT_EQ(port_->outgoing().sent, 0U);
  port_.reset();
  EXPECT_EQ(logged("attach 0"), 0U);
}

TEST_F(Bulk, ClosingEndsWhatIsUnderWayAndGivesTheInterfaceToTheKernelAgain) {
  open();
  usbfs_.hold_out(true);
  EXPECT_EQ(port_->send(Bytes{1}), Status::ok);
  EXPECT_EQ(port_->send(Bytes{2}), Status::ok);
  port_.reset();
  EXPECT_EQ(usbfs_.reads_under_way(), 0U);
  EXPECT_THAT(usbfs_.sent(), ElementsAre(Bytes{1})) << "what waited is not begun";
  EXPECT_THAT(usbfs_.log(),
              ElementsAre("claim 0", "discard", "discard", "discard", "release 0", "attach 0"));
}

/// The kernel's driver would wait for it, seconds for each question.
TEST_F(Bulk, ADeviceThatDoesNotAnswerIsNotGivenBack) {
  open();
  usbfs_.hang();
  port_.reset();
  EXPECT_EQ(logged("release 0"), 1U);
  EXPECT_EQ(logged("attach 0"), 0U);
}

TEST_F(Bulk, ClosingComesToAnEndWhereTransfersDoNot) {
  open();
  usbfs_.ignore_cancelling();
  port_.reset();
  EXPECT_EQ(logged("release 0"), 1U);
}

TEST_F(Bulk, OpensAgainAfterItWasClosed) {
  open();
  port_.reset();
  open();
  usbfs_.say({5});
  EXPECT_EQ(received(), Bytes{5});
  EXPECT_EQ(logged("claim 0"), 2U);
}

TEST_F(Bulk, OpenedAThousandTimesItLeavesNoDescriptorAndNoMemory) {
  constexpr std::size_t kTimes = 1000, kBytesEach = 16;
  const auto open_and_close = [&] {
    open();
    port_.reset();
    usbfs_.forget();
  };
  for (int i = 0; i < 20; ++i) open_and_close();
  host_->wait(now() + 100'000'000);  // umockdev closes its own end of a node a little later
  const Held before = held();
  for (std::size_t i = 0; i < kTimes; ++i) open_and_close();
  for (int i = 0; i < 200 && held().descriptors > before.descriptors; ++i)
    host_->wait(now() + 10'000'000);
  const Held after = held();
  EXPECT_EQ(after.descriptors, before.descriptors);
  EXPECT_LE(after.heap_bytes, before.heap_bytes + kBytesEach * kTimes);
}

TEST_F(Bulk, AnInterfaceThatAnotherProgramHasIsRefusedWithWords) {
  usbfs_.claimed_by_another();
  const auto found = host_->open_bulk(kFalcon, 0x81, 0x02);
  ASSERT_FALSE(found);
  EXPECT_FALSE(found.error().absent);
  EXPECT_THAT(found.error().error.text, HasSubstr("in use by another program"));
}

TEST_F(Bulk, ADeviceThatIsUnpluggedBeforeItIsClaimedIsAbsent) {
  usbfs_.unplug(-ENODEV);
  const auto found = host_->open_bulk(kFalcon, 0x81, 0x02);
  ASSERT_FALSE(found);
  EXPECT_TRUE(found.error().absent);
}

TEST_F(Bulk, OnlyTheKernelsNodeIsOpenedThatFitsTheSelection) {
  Selection other = kFalcon;
  other.product = 0x6001;
  const auto found = host_->open_bulk(other, 0x81, 0x02);
  ASSERT_FALSE(found);
  EXPECT_TRUE(found.error().absent);
  EXPECT_THAT(found.error().error.text,
              HasSubstr("no device 0403:6001 is plugged in; found: Maker Device (0403:cb48, "
                        "serial S1, port 1-2)"));
  EXPECT_TRUE(usbfs_.log().empty());
}

}  // namespace
}  // namespace hapticd::test
