// Which device is meant, in the words that somebody reads who has to choose.
#include "drivers/usb/choose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/usb/device_tree.h"

namespace hapticd::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const usb::Selection kWoodenHaptics{.vendor = 0x1234, .product = 0x0006};

void add_raw_hid(const DeviceTree& tree, const TreeUsb& device, int number, const std::string& node,
                 std::uint8_t page = 0) {
  tree.add(device, {.number = number}, {{.address = "8" + std::to_string(number + 1)}});
  tree.add_hid(DeviceTree::directory(device, number), node, vendor_descriptor(page));
}

TEST(ChooseHid, NoneSaysWhatIsPluggedIn) {
  const DeviceTree tree;
  tree.add_hid(kUhid, "hidraw0", vendor_descriptor(), "0003:00001209:0000FFB0");
  const auto chosen = usb::choose_hid_node(kWoodenHaptics, tree.roots());
  ASSERT_FALSE(chosen);
  EXPECT_TRUE(chosen.error().absent);
  EXPECT_EQ(chosen.error().error.code, ExitCode::unavailable);
  EXPECT_EQ(chosen.error().error.text,
            "no device 1234:0006 is plugged in; found: Emulated (1209:ffb0, serial U1, port " +
                tree.at("dev/hidraw0") + ")");
}

TEST(ChooseHid, AnotherSerialOrPortIsAbsentAndTheOneThatIsThereIsNamed) {
  const DeviceTree tree;
  tree.add(TreeUsb{});
  add_raw_hid(tree, TreeUsb{}, 0, "hidraw0");
  for (const bool by_serial : {true, false}) {
    usb::Selection wanted = kWoodenHaptics;
    (by_serial ? wanted.serial : wanted.path) = "other";
    for (const auto& error : {usb::choose_hid_node(wanted, tree.roots()).error(),
                              usb::choose_hid_interface(wanted, tree.roots()).error()}) {
      EXPECT_TRUE(error.absent);
      EXPECT_THAT(error.error.text,
                  AllOf(HasSubstr(by_serial ? "serial other" : "port other"),
                        HasSubstr("Maker Device (1234:0006, serial S1, port 1-2)")));
    }
  }
}

TEST(ChooseHid, TheSerialOrThePortMakesItOne) {
  const DeviceTree tree;
  const TreeUsb one, other{.path = "1-3", .serial = "S2", .address = "3"};
  for (const TreeUsb& device : {one, other}) {
    tree.add(device);
    add_raw_hid(tree, device, 0, "hidraw" + device.address);
  }
  usb::Selection wanted = kWoodenHaptics;
  const auto both = usb::choose_hid_node(wanted, tree.roots());
  ASSERT_FALSE(both);
  EXPECT_FALSE(both.error().absent);
  EXPECT_THAT(both.error().error.text,
              AllOf(HasSubstr("found 2"), HasSubstr("serial S1, port 1-2"),
                    HasSubstr("serial S2, port 1-3"), HasSubstr("usb.serial or usb.path")));
  wanted.serial = "S2";
  EXPECT_EQ(usb::choose_hid_node(wanted, tree.roots())->about.path, "1-3");
  EXPECT_EQ(usb::choose_hid_interface(wanted, tree.roots())->device.about.path, "1-3");
  wanted.serial.clear();
  wanted.path = "1-2";
  EXPECT_EQ(usb::choose_hid_node(wanted, tree.roots())->about.serial, "S1");
}

TEST(ChooseHid, ASerialThatAllHaveIsNotOfferedToChooseBy) {
  const DeviceTree tree;
  for (const TreeUsb& device : {TreeUsb{}, TreeUsb{.path = "1-3", .address = "3"}}) {
    tree.add(device);
    add_raw_hid(tree, device, 0, "hidraw" + device.address);
  }
  const auto both = usb::choose_hid_node(kWoodenHaptics, tree.roots());
  ASSERT_FALSE(both);
  EXPECT_THAT(both.error().error.text, AllOf(HasSubstr("usb.path"), Not(HasSubstr("usb.serial"))));
}

TEST(ChooseHid, OfTwoInterfacesUsageOrNumberChoose) {
  const DeviceTree tree;
  tree.add(TreeUsb{});
  add_raw_hid(tree, TreeUsb{}, 0, "hidraw0", 0xab);
  add_raw_hid(tree, TreeUsb{}, 1, "hidraw1", 0xc9);
  usb::Selection wanted = kWoodenHaptics;
  for (const auto& error : {usb::choose_hid_node(wanted, tree.roots()).error(),
                            usb::choose_hid_interface(wanted, tree.roots()).error()})
    EXPECT_THAT(error.error.text, AllOf(HasSubstr("interface 0, usage ffab:0001"),
                                        HasSubstr("interface 1, usage ffc9:0001"),
                                        HasSubstr("usb.interface or usb.usage")));
  wanted.usage = 0xffc90001;
  EXPECT_EQ(usb::choose_hid_node(wanted, tree.roots())->node, tree.at("dev/hidraw1"));
  EXPECT_EQ(usb::choose_hid_interface(wanted, tree.roots())->interface.number, 1);
  wanted.usage.reset();
  wanted.interface = 0;
  EXPECT_EQ(usb::choose_hid_node(wanted, tree.roots())->node, tree.at("dev/hidraw0"));
  EXPECT_EQ(usb::choose_hid_interface(wanted, tree.roots())->interface.number, 0);
}

TEST(ChooseHid, AUsageThatItHasNotIsRefusedWithThoseThatItHas) {
  const DeviceTree tree;
  tree.add(TreeUsb{});
  add_raw_hid(tree, TreeUsb{}, 0, "hidraw0");
  usb::Selection wanted = kWoodenHaptics;
  wanted.usage = 0xffab0200;
  const auto node = usb::choose_hid_node(wanted, tree.roots());
  ASSERT_FALSE(node);
  EXPECT_FALSE(node.error().absent);
  EXPECT_THAT(node.error().error.text,
              AllOf(HasSubstr("no HID interface with usage ffab:0200"), HasSubstr("ff00:0001")));
  EXPECT_FALSE(usb::choose_hid_interface(wanted, tree.roots()));
}

TEST(ChooseHid, ADeviceWithoutHidrawNodeIsPresentAndRefused) {
  const DeviceTree tree;
  tree.add(TreeUsb{});
  tree.add(TreeUsb{}, {.driver = "usbfs"}, {{}});
  const auto node = usb::choose_hid_node(kWoodenHaptics, tree.roots());
  ASSERT_FALSE(node);
  EXPECT_FALSE(node.error().absent);
  EXPECT_THAT(node.error().error.text, HasSubstr("has no hidraw node"));
  EXPECT_EQ(usb::choose_hid_interface(kWoodenHaptics, tree.roots())->interface.driver, "usbfs");
}

TEST(ChooseBulk, BothEndpointsHaveToBeThereAndBulk) {
  const usb::Selection falcon{.vendor = 0x0403, .product = 0xcb48};
  const TreeUsb device{.vendor = "0403", .product = "cb48"};
  const TreeEndpoint in{.address = "81", .attributes = "02"};
  for (const auto& [out, good] :
       {std::pair{TreeEndpoint{.address = "02", .attributes = "02"}, true},
        std::pair{TreeEndpoint{.address = "02", .attributes = "03"}, false},
        std::pair{TreeEndpoint{.address = "03", .attributes = "02"}, false}}) {
    const DeviceTree tree;
    tree.add(device);
    tree.add(device, {.interface_class = "ff", .driver = ""}, {in, out});
    const auto chosen = usb::choose_bulk(falcon, 0x81, 0x02, tree.roots());
    ASSERT_EQ(chosen.has_value(), good);
    if (good) continue;
    EXPECT_FALSE(chosen.error().absent);
    EXPECT_THAT(chosen.error().error.text, HasSubstr("has no bulk endpoints 1 in and 2 out"));
  }
}

TEST(ChooseBulk, ADeviceThatIsNotConfiguredIsRefused) {
  const DeviceTree tree;
  tree.add(TreeUsb{});
  const auto chosen = usb::choose_bulk(kWoodenHaptics, 0x81, 0x02, tree.roots());
  ASSERT_FALSE(chosen);
  EXPECT_THAT(chosen.error().error.text, HasSubstr("not configured"));
}

}  // namespace
}  // namespace hapticd::test
