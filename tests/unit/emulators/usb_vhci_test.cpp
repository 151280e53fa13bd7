// Attaching to Linux' virtual host controller, over files that stand for its own.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "sim/usb/vhci.h"

namespace hapticd::test::emulator {
namespace {

constexpr const char* kStatus =
    "hub port sta spd dev      sockfd local_busid\n"
    "hs  0000 006 002 00010001 000005 1-1\n"
    "hs  0001 004 000 00000000 000000 0-0\n"
    "hs  0010 004 000 00000000 000000 0-0\n"
    "ss  0011 004 000 00000000 000000 0-0\n";

TEST(UsbVhci, OnlyPortsOfTheRightHubThatAreFreeCount) {
  EXPECT_EQ(sim::usb::free_ports(kStatus), (std::vector<int>{1, 10}));
  EXPECT_TRUE(sim::usb::free_ports("").empty());
  EXPECT_TRUE(sim::usb::free_ports("hs\nhs x 4\nhs 1 5\n\n").empty());
}

class UsbVhciFiles : public testing::Test {
 protected:
  UsbVhciFiles() : folder_(testing::TempDir() + "/vhci_" + std::to_string(getpid())) {
    std::filesystem::create_directories(folder_);
  }
  ~UsbVhciFiles() override { std::filesystem::remove_all(folder_); }
  void write(const char* name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name) << text;
  }
  std::string read(const char* name) const {
    std::ifstream file(folder_ + "/" + name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  std::string folder_;
};

TEST_F(UsbVhciFiles, AttachingTellsPortDescriptorDeviceAndSpeed) {
  write("status", kStatus);
  write("attach", "");
  const auto attached = sim::usb::Vhci(folder_).attach(sim::usb::Speed::high);
  ASSERT_TRUE(attached) << attached.error().text;
  EXPECT_EQ(attached->port, 1);
  std::istringstream said(read("attach"));
  int port = 0, fd = 0, speed = 0;
  std::uint32_t device = 0;
  said >> port >> fd >> device >> speed;
  EXPECT_EQ(port, 1);
  EXPECT_EQ(device, attached->device);
  EXPECT_EQ(speed, 3);
  EXPECT_GT(fd, 2);
  close(attached->fd);
}

TEST_F(UsbVhciFiles, WithoutTheDriverItSaysHowToLoadIt) {
  const auto attached = sim::usb::Vhci(folder_).attach(sim::usb::Speed::full);
  ASSERT_FALSE(attached);
  EXPECT_EQ(attached.error().code, ExitCode::unavailable);
  EXPECT_NE(attached.error().text.find("modprobe vhci-hcd"), std::string::npos);
}

TEST_F(UsbVhciFiles, WithoutAFreePortOneMayTryAgain) {
  write("status", "hs  0000 006 002 00010001 000005 1-1\n");
  write("attach", "");
  const auto attached = sim::usb::Vhci(folder_).attach(sim::usb::Speed::full);
  ASSERT_FALSE(attached);
  EXPECT_EQ(attached.error().code, ExitCode::try_again);
}

}  // namespace
}  // namespace hapticd::test::emulator
