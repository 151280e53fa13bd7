// The port on hidapi with the real library. umockdev's node is a terminal, whose other end is the device's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/hidraw.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <thread>

#include "drivers/usb/this_host.h"
#include "tests/umockdev/devices.h"

namespace hapticd::test {
namespace {

using namespace usb;
using testing::HasSubstr;

class HidapiNode : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(umockdev_in_mock_environment()) << "to be run by umockdev-wrapper";
    g_signal_connect(handler_.get(), "handle-ioctl", G_CALLBACK(&HidapiNode::called), this);
  }
  void TearDown() override {
    port_.reset();
    umockdev_testbed_detach_ioctl(testbed_.get(), "/dev/hidraw0", nullptr);
  }
  void open(const Bytes& descriptor) {
    const std::string hid = "P: /devices/virtual/misc/uhid/0003:1234:0006.0001";
    for (const std::string& text :
         {hid +
              "\nE: SUBSYSTEM=hid\nE: DRIVER=hid-generic\nE: HID_ID=0003:00001234:00000006\n"
              "E: HID_NAME=Emulated\nE: HID_UNIQ=U1\nH: report_descriptor=" +
              as_hex(descriptor) + "\n",
          hid + "/hidraw/hidraw0\nN: hidraw0\nE: SUBSYSTEM=hidraw\nE: DEVNAME=/dev/hidraw0\n"
                "L: device=../../../0003:1234:0006.0001\n"})
      ASSERT_TRUE(umockdev_testbed_add_from_string(testbed_.get(), text.c_str(), nullptr)) << text;
    ASSERT_TRUE(
        umockdev_testbed_attach_ioctl(testbed_.get(), "/dev/hidraw0", handler_.get(), nullptr));
    auto found = host_->open_hid({.vendor = 0x1234, .product = 0x0006});
    ASSERT_TRUE(found) << found.error().error.text;
    EXPECT_EQ(found->path, "/dev/hidraw0");
    EXPECT_EQ(found->serial, "U1");
    port_ = std::move(found->port);
  }

  int device_end() { return umockdev_testbed_get_dev_fd(testbed_.get(), "/dev/hidraw0"); }

  std::unique_ptr<UMockdevTestbed, Unref> testbed_{umockdev_testbed_new()};
  std::unique_ptr<UMockdevIoctlBase, Unref> handler_{umockdev_ioctl_base_new()};
  std::mutex mutex_;
  Bytes written_{}, feature_{};
  std::unique_ptr<Host> host_ = this_host();
  std::unique_ptr<HidPort> port_;

 private:
  static gboolean called(UMockdevIoctlBase*, UMockdevIoctlClient* client, HidapiNode* self) {
    const std::lock_guard lock(self->mutex_);
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    void* argument = nullptr;  // of this process
    std::memcpy(&argument, umockdev_ioctl_client_get_arg(client)->data, sizeof(argument));
    auto* const bytes = static_cast<std::uint8_t*>(argument);
    const std::size_t size = _IOC_SIZE(request);
    if (request == HIDIOCGRDESCSIZE) {
      *static_cast<int*>(argument) = 25;
    } else if (request == HIDIOCSFEATURE(size)) {
      self->feature_.assign(bytes, bytes + size);
    } else if (request == HIDIOCGFEATURE(size)) {
      std::copy(self->feature_.begin(), self->feature_.end(), bytes);
    } else {
      umockdev_ioctl_client_complete(client, -1, ENOTTY);
      return TRUE;
    }
    const bool feature = request != HIDIOCGRDESCSIZE;
    umockdev_ioctl_client_complete(client, feature ? static_cast<glong>(self->feature_.size()) : 0,
                                   0);
    return TRUE;
  }
};

TEST_F(HidapiNode, OpensByItsNodeAndWritesReportsWithoutIdBehindAZero) {
  open(kPlainReports);
  ASSERT_TRUE(port_);
  EXPECT_EQ(port_->report_descriptor(), kPlainReports);
  EXPECT_EQ(port_->send(Bytes{1, 2, 3, 4, 5, 6, 7, 8}), Status::ok);
  Bytes written(16);
  const ssize_t size = ::read(device_end(), written.data(), written.size());
  written.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  EXPECT_EQ(written, (Bytes{0, 1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST_F(HidapiNode, HandsOutWhatTheNodeGives) {
  open(kPlainReports);
  ASSERT_TRUE(port_);
  const Bytes report{8, 7, 6, 5, 4, 3, 2, 1};
  ASSERT_EQ(::write(device_end(), report.data(), report.size()), 8);
  const Arrival arrival = port_->receive(host_->now_ns() + 20'000'000'000);
  EXPECT_EQ(arrival.status, Status::ok);
  EXPECT_EQ(Bytes(arrival.bytes.begin(), arrival.bytes.end()), report);
}

TEST_F(HidapiNode, AnotherThreadEndsItsWait) {
  open(kPlainReports);
  ASSERT_TRUE(port_);
  std::thread other([this] { host_->wake(); });
  const std::int64_t much_later_ns = host_->now_ns() + 20'000'000'000;
  EXPECT_EQ(port_->receive(much_later_ns).status, Status::nothing);
  EXPECT_LT(host_->now_ns(), much_later_ns) << "it was not the time that ended the wait";
  other.join();
}

TEST_F(HidapiNode, FeaturesKeepTheirId) {
  open(kNumberedReports);
  ASSERT_TRUE(port_);
  EXPECT_EQ(port_->set_feature(Bytes{3, 9, 8, 7, 6}), Status::ok);
  Bytes answer{3, 0, 0, 0, 0};
  EXPECT_EQ(port_->get_feature(answer), 5U);
  EXPECT_EQ(answer, (Bytes{3, 9, 8, 7, 6}));
}

}  // namespace
}  // namespace hapticd::test
