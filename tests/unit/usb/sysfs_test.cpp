#include "drivers/usb/sysfs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/hid/report_descriptor.h"
#include "drivers/usb/sysfs_file.h"
#include "tests/unit/usb/device_tree.h"

namespace hapticd::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

TEST(Sysfs, ADeviceIsReadWithItsInterfacesAndEndpoints) {
  const DeviceTree tree;
  const TreeUsb device{.path = "1-2.3", .address = "7"};
  tree.add(device);
  tree.add(device, {.number = 0, .interface_class = "02", .driver = "cdc_acm"}, {});
  tree.add(device, {.number = 2}, {{.address = "83", .interval = "04"}, {.address = "02"}});
  const auto found = usb::usb_devices(tree.roots());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].about.vendor, 0x1234);
  EXPECT_EQ(found[0].about.product, 0x0006);
  EXPECT_EQ(found[0].about.name, "Maker Device");
  EXPECT_EQ(found[0].about.serial, "S1");
  EXPECT_EQ(found[0].about.path, "1-2.3");
  EXPECT_EQ(found[0].node, tree.at("dev/bus/usb/001/007"));
  ASSERT_THAT(found[0].interfaces, SizeIs(2));
  EXPECT_EQ(found[0].interfaces[0].driver, "cdc_acm");
  const usb::Interface& hid = found[0].interfaces[1];
  EXPECT_EQ(hid.number, 2);
  EXPECT_EQ(hid.interface_class, usb::kHidClass);
  ASSERT_THAT(hid.endpoints, SizeIs(2));
  EXPECT_EQ(hid.endpoints[0].address, 0x02);
  EXPECT_FALSE(is_in(hid.endpoints[0]));
  EXPECT_EQ(hid.endpoints[1].address, 0x83);
  EXPECT_EQ(hid.endpoints[1].type, usb::EndpointType::interrupt);
  EXPECT_EQ(hid.endpoints[1].packet_bytes, 64U);
  EXPECT_EQ(hid.endpoints[1].interval_s, 4e-3) << "full speed: frames";
}

TEST(Sysfs, AtHighSpeedAnIntervalIsAPowerOfMicroframes) {
  const DeviceTree tree;
  const TreeUsb device{.speed = "480"};
  tree.add(device);
  tree.add(device, {}, {{.interval = "04"}, {.address = "02", .attributes = "02"}});
  const auto found = usb::usb_devices(tree.roots());
  ASSERT_THAT(found, SizeIs(1));
  ASSERT_THAT(found[0].interfaces[0].endpoints, SizeIs(2));
  EXPECT_EQ(found[0].interfaces[0].endpoints[0].interval_s, 125e-6) << "bulk: any microframe";
  EXPECT_EQ(found[0].interfaces[0].endpoints[1].interval_s, 8 * 125e-6);
}

TEST(Sysfs, HubsAreNoDevices) {
  const DeviceTree tree;
  const TreeUsb hub{.path = "1-1"};
  tree.add(hub);
  tree.write(DeviceTree::directory(hub) + "/bDeviceClass", "09\n");
  EXPECT_THAT(usb::usb_devices(tree.roots()), IsEmpty());
}

TEST(Sysfs, AHidNodeOnUsbTakesWhatTheDeviceSaysAndItsPlace) {
  const DeviceTree tree;
  const TreeUsb device{.path = "1-2.3"};
  tree.add(device);
  tree.add(device, {.number = 2}, {{.address = "83", .interval = "02"}});
  tree.add_hid(DeviceTree::directory(device, 2), "hidraw4", vendor_descriptor());
  const auto found = usb::hid_nodes(tree.roots());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].about.name, "Maker Device");
  EXPECT_EQ(found[0].about.serial, "S1");
  EXPECT_EQ(found[0].about.path, "1-2.3");
  EXPECT_EQ(found[0].interface, 2);
  EXPECT_EQ(found[0].interval_s, 2e-3);
  EXPECT_EQ(found[0].node, tree.at("dev/hidraw4"));
  EXPECT_EQ(found[0].driver, "hid-generic");
  EXPECT_EQ(std::string(found[0].report_descriptor.begin(), found[0].report_descriptor.end()),
            vendor_descriptor());
  EXPECT_EQ(usb::usb_devices(tree.roots())[0].interfaces[0].report_descriptor,
            found[0].report_descriptor);
}

TEST(Sysfs, AHidNodeThatAProgramEmulatesIsKnownByItsNode) {
  const DeviceTree tree;
  tree.add_hid(kUhid, "hidraw0", vendor_descriptor());
  const auto found = usb::hid_nodes(tree.roots());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].about.name, "Emulated");
  EXPECT_EQ(found[0].about.serial, "U1");
  EXPECT_EQ(found[0].about.vendor, 0x1234);
  EXPECT_EQ(found[0].about.path, tree.at("dev/hidraw0"));
  EXPECT_FALSE(found[0].interface.has_value());
}

TEST(Sysfs, AMachineWithoutUsbHasNoDevices) {
  const DeviceTree tree;
  EXPECT_THAT(usb::usb_devices(tree.roots()), IsEmpty());
  EXPECT_THAT(usb::hid_nodes(tree.roots()), IsEmpty());
  EXPECT_FALSE(usb::hid_node(tree.roots(), "hidraw0"));
}

TEST(Sysfs, LinksThatLeadNowhereAreNoDevices) {
  const DeviceTree tree;
  tree.link("sys/bus/usb/devices/1-9", "sys/devices/usb1/1-9");
  tree.link("sys/bus/usb/devices/1-8", "sys/bus/usb/devices/1-8");
  tree.link("sys/class/hidraw/hidraw9", "sys/devices/nowhere");
  const TreeUsb device;
  tree.add(device);
  tree.add(device, {.driver = ""}, {});
  tree.link(DeviceTree::directory(device, 0) + "/driver", "sys/bus/usb/drivers/unloaded");
  EXPECT_THAT(usb::hid_nodes(tree.roots()), IsEmpty());
  ASSERT_THAT(usb::usb_devices(tree.roots()), SizeIs(1));
  EXPECT_EQ(usb::usb_devices(tree.roots())[0].interfaces[0].driver, "");
}

class WithoutOneFile : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Files, WithoutOneFile,
                         testing::Values("idVendor", "idProduct", "busnum", "devnum"));

TEST_P(WithoutOneFile, ADeviceThatIsGoingIsNone) {
  const DeviceTree tree;
  tree.add(TreeUsb{});
  ASSERT_THAT(usb::usb_devices(tree.roots()), SizeIs(1));
  tree.remove(DeviceTree::directory(TreeUsb{}) + "/" + GetParam());
  EXPECT_THAT(usb::usb_devices(tree.roots()), IsEmpty());
}

TEST_P(WithoutOneFile, NumbersThatAreNoneMakeNoDevice) {
  const std::string file = DeviceTree::directory(TreeUsb{}) + "/" + GetParam();
  for (const std::string number :
       {"", "\n", "zzzz", "12 34", "-1", "0x12", "10000", "99999999999999999999", "1\x01"}) {
    const DeviceTree tree;
    tree.add(TreeUsb{});
    tree.write(file, number);
    EXPECT_THAT(usb::usb_devices(tree.roots()), IsEmpty()) << '"' << number << '"';
  }
}

TEST(Sysfs, WhatADeviceCallsItselfIsPrintableAndBounded) {
  const DeviceTree tree;
  tree.add(TreeUsb{});
  const std::string in = DeviceTree::directory(TreeUsb{});
  tree.write(in + "/manufacturer", "\x1b[31m\xff\xfe\x7f\nsecond line\n");
  tree.write(in + "/product", std::string(1'000'000, 'x'));
  tree.write(in + "/serial", "  S 7  \n");
  const auto found = usb::usb_devices(tree.roots());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].about.name.substr(0, 10), "?[31m??? x");
  EXPECT_LE(found[0].about.name.size(), 4200U);
  EXPECT_EQ(found[0].about.serial, "S 7");
}

TEST(Sysfs, AReportDescriptorThatIsTooLongIsNotCutIntoALegalOne) {
  const DeviceTree tree;
  std::string descriptor = vendor_descriptor();
  while (descriptor.size() <= hid::kMostDescriptorBytes) descriptor += vendor_descriptor();
  tree.add_hid(kUhid, "hidraw0", descriptor);
  const auto found = usb::hid_nodes(tree.roots());
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_FALSE(hid::parse_descriptor(found[0].report_descriptor));
}

class BadHidId : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Ids, BadHidId,
                         testing::Values("", "0003:1234:0006", "0003:0000123400000006xx",
                                         "0003:00001234:0000zzzz", "0003:00011234:00000006"));

TEST_P(BadHidId, MakesNoNode) {
  const DeviceTree tree;
  tree.add_hid(kUhid, "hidraw0", vendor_descriptor(), GetParam());
  EXPECT_THAT(usb::hid_nodes(tree.roots()), IsEmpty());
}

TEST(Sysfs, DirectoriesInPlaceOfFilesAreNoText) {
  const DeviceTree tree;
  tree.add(TreeUsb{});
  const std::string serial = DeviceTree::directory(TreeUsb{}) + "/serial";
  tree.remove(serial);
  tree.write(serial + "/inside", "x");
  ASSERT_THAT(usb::usb_devices(tree.roots()), SizeIs(1));
  EXPECT_EQ(usb::usb_devices(tree.roots())[0].about.serial, "");
}

TEST(SysfsFile, PathsComeApart) {
  EXPECT_EQ(usb::sysfs::name_of("/a/b"), "b");
  EXPECT_EQ(usb::sysfs::parent_of("/a/b"), "/a");
  EXPECT_EQ(usb::sysfs::name_of(""), "");
  EXPECT_EQ(usb::sysfs::parent_of("a"), "");
}

TEST(SysfsFile, LinesKeepTheirOrder) {
  const DeviceTree tree;
  tree.write("sys/uevent", "A=1\n\nB=2");
  EXPECT_THAT(usb::sysfs::lines_of(tree.at("sys/uevent")), ElementsAre("A=1", "", "B=2"));
}

}  // namespace
}  // namespace hapticd::test
