// The port on libusb for HID: what is on the wire for reports, features and set-up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "drivers/usb/this_host.h"
#include "tests/umockdev/devices.h"

namespace hapticd::test {
namespace {

using namespace usb;
using testing::ElementsAre;
using testing::HasSubstr;

class LibusbHid : public testing::Test {
 protected:
  void open(const Bytes& descriptor, bool with_out = true) {
    ASSERT_TRUE(umockdev_in_mock_environment()) << "to be run by umockdev-wrapper";
    usbfs_.plug(hid_texts(with_out));
    usbfs_.control = [descriptor](const ControlRequest& request) -> std::optional<Bytes> {
      if (request.type == 0x81 && request.request == 6 && request.value == 0x2200)
        return descriptor;
      if (request.type == 0xa1 && request.request == 1)
        return (request.value & 0xff) != 0 ? Bytes{3, 10, 11, 12, 13} : Bytes{10, 11, 12, 13};
      if (request.request == 0x0a) return {};  // SET_IDLE is optional
      return Bytes{};
    };
    auto found = host_->open_hid(selection_);
    refusal_ = found ? "" : found.error().error.text;
    if (found) port_ = std::move(found->port);
  }
  std::int64_t later() { return host_->now_ns() + 20'000'000'000; }
  Bytes received() {
    const Arrival arrival = port_->receive(later());
    EXPECT_EQ(arrival.status, Status::ok);
    return {arrival.bytes.begin(), arrival.bytes.end()};
  }

  Selection selection_{.vendor = 0x1234, .product = 0x0006, .transport = Transport::libusb};
  FakeUsbfs usbfs_;
  std::unique_ptr<Host> host_ = this_host();
  std::unique_ptr<HidPort> port_;
  std::string refusal_;
};

TEST_F(LibusbHid, ReadsTheDescriptorAndWantsSilenceWhileNothingChanges) {
  open(kPlainReports);
  ASSERT_TRUE(port_) << refusal_;
  EXPECT_EQ(port_->report_descriptor(), kPlainReports);
  const auto requests = usbfs_.requests();
  ASSERT_EQ(requests.size(), 2U);
  EXPECT_EQ(requests[1].type, 0x21);
  EXPECT_EQ(requests[1].request, 0x0a);
  EXPECT_EQ(requests[1].value, 0);
}

TEST_F(LibusbHid, ReportsWithoutIdsHaveNoneOnTheWireEitherWay) {
  open(kPlainReports);
  ASSERT_TRUE(port_) << refusal_;
  const Bytes report{1, 2, 3, 4, 5, 6, 7, 8};
  usbfs_.say(report);
  EXPECT_EQ(received(), report);
  EXPECT_EQ(port_->send(report), Status::ok);
  EXPECT_EQ(port_->flush(later()), Status::ok);
  EXPECT_THAT(usbfs_.sent(), ElementsAre(report));
}

TEST_F(LibusbHid, OfReportsThatWaitTheNewestIsHandedOut) {
  selection_.reads = 3;
  open(kPlainReports);
  ASSERT_TRUE(port_) << refusal_;
  for (std::uint8_t i = 1; i <= 3; ++i) usbfs_.say({i, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(received(), (Bytes{3, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(port_->skipped(), 2U);
}

TEST_F(LibusbHid, WithoutAnOutEndpointReportsGoAsSetReportWithIdAndKind) {
  open(kNumberedReports, false);
  ASSERT_TRUE(port_) << refusal_;
  const Bytes report{3, 1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(port_->send(report), Status::ok);
  EXPECT_EQ(port_->flush(later()), Status::ok);
  const ControlRequest request = usbfs_.requests().back();
  EXPECT_EQ(request.type, 0x21);
  EXPECT_EQ(request.request, 0x09);
  EXPECT_EQ(request.value, 0x0203);
  EXPECT_EQ(request.data, report);
  EXPECT_TRUE(usbfs_.sent().empty());
  EXPECT_EQ(port_->outgoing().sent, 1U);
}

TEST_F(LibusbHid, AFeatureWithoutIdTravelsWithoutItsZero) {
  open(kPlainReports);
  ASSERT_TRUE(port_) << refusal_;
  EXPECT_EQ(port_->set_feature(Bytes{0, 5, 6, 7, 8}), Status::ok);
  EXPECT_EQ(usbfs_.requests().back().value, 0x0300);
  EXPECT_EQ(usbfs_.requests().back().data, (Bytes{5, 6, 7, 8}));
  Bytes answer(5);
  EXPECT_EQ(port_->get_feature(answer), 5U);
  EXPECT_EQ(answer, (Bytes{0, 10, 11, 12, 13}));
  EXPECT_EQ(usbfs_.requests().back().wanted, 4U);
}

TEST_F(LibusbHid, AFeatureWithIdTravelsWithIt) {
  open(kNumberedReports);
  ASSERT_TRUE(port_) << refusal_;
  EXPECT_EQ(port_->set_feature(Bytes{3, 5, 6, 7, 8}), Status::ok);
  EXPECT_EQ(usbfs_.requests().back().value, 0x0303);
  EXPECT_EQ(usbfs_.requests().back().data, (Bytes{3, 5, 6, 7, 8}));
  Bytes answer{3, 0, 0, 0, 0};
  EXPECT_EQ(port_->get_feature(answer), 5U);
  EXPECT_EQ(answer, (Bytes{3, 10, 11, 12, 13}));
}

TEST_F(LibusbHid, FeaturesOfADeviceThatHasGoneAreNone) {
  open(kNumberedReports);
  ASSERT_TRUE(port_) << refusal_;
  usbfs_.unplug(-ENODEV);
  Bytes answer{3, 0, 0, 0, 0};
  EXPECT_EQ(port_->get_feature(answer), 0U);
  EXPECT_EQ(port_->set_feature(answer), Status::gone);
  EXPECT_EQ(port_->receive(later()).status, Status::gone);
}

TEST_F(LibusbHid, ADescriptorThatIsNoneIsRefusedAndTheDeviceGivenBack) {
  open({0xa1, 0x01, 0x75});
  EXPECT_FALSE(port_);
  EXPECT_THAT(refusal_, HasSubstr("Maker Device (1234:0006, serial S1, port 1-2): "));
  EXPECT_EQ(usbfs_.log().back(), "attach 0");
}

TEST_F(LibusbHid, AnotherUsageThanTheConfigsIsRefused) {
  selection_.usage = 0xffab0200;
  open(kPlainReports);
  EXPECT_FALSE(port_);
  EXPECT_THAT(refusal_, HasSubstr("has usage ff00:0001"));
  EXPECT_EQ(usbfs_.log().back(), "attach 0");
}

}  // namespace
}  // namespace hapticd::test
