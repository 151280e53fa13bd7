// A sysfs and a /dev of a test's own, in a temporary directory.
#pragma once
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "drivers/usb/sysfs.h"

namespace hapticd::test {

/// Usage `page`:0001, 8 bytes in and out, without ids.
inline std::string vendor_descriptor(std::uint8_t page_low = 0x00) {
  std::string text(
      "\x06\x00\xff\x09\x01\xa1\x01\x15\x00\x26\xff\x00\x75\x08\x95\x08\x09\x01\x81"
      "\x02\x09\x01\x91\x02\xc0",
      25);
  text[1] = static_cast<char>(page_low);
  return text;
}

struct TreeUsb {
  std::string path = "1-2";
  std::string vendor = "1234", product = "0006", serial = "S1";
  std::string address = "2";
  std::string speed = "12";
};
struct TreeInterface {
  int number = 0;
  std::string interface_class = "03", driver = "usbhid";
};
struct TreeEndpoint {
  std::string address = "81", attributes = "03", interval = "01", packet = "0040";
};

class DeviceTree {
 public:
  DeviceTree() {
    std::string name = (std::filesystem::temp_directory_path() / "hapticd_tree_XXXXXX").string();
    root_ = mkdtemp(name.data());
  }
  ~DeviceTree() { std::filesystem::remove_all(root_); }
  DeviceTree(const DeviceTree&) = delete;
  DeviceTree& operator=(const DeviceTree&) = delete;

  usb::Roots roots() const { return {.sys = root_ + "/sys", .dev = root_ + "/dev"}; }
  /// Below the root, with its directories.
  void write(const std::string& file, const std::string& text) const {
    const std::filesystem::path path = root_ + "/" + file;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
  }
  void link(const std::string& from, const std::string& to) const {
    const std::filesystem::path path = root_ + "/" + from;
    std::filesystem::create_directories(path.parent_path());
    std::filesystem::create_symlink(root_ + "/" + to, path);
  }
  void remove(const std::string& file) const { std::filesystem::remove_all(root_ + "/" + file); }
  std::string at(const std::string& file) const { return root_ + "/" + file; }

  static std::string directory(const TreeUsb& device) { return "sys/devices/usb1/" + device.path; }
  static std::string directory(const TreeUsb& device, int interface) {
    return directory(device) + "/" + device.path + ":1." + std::to_string(interface);
  }
  void add(const TreeUsb& device) const {
    const std::string in = directory(device);
    write(in + "/idVendor", device.vendor + "\n");
    write(in + "/idProduct", device.product + "\n");
    write(in + "/serial", device.serial + "\n");
    write(in + "/manufacturer", "Maker\n");
    write(in + "/product", "Device\n");
    write(in + "/busnum", "1\n");
    write(in + "/devnum", device.address + "\n");
    write(in + "/speed", device.speed + "\n");
    write(in + "/bDeviceClass", "00\n");
    link("sys/bus/usb/devices/" + device.path, in);
    write("dev/bus/usb/001/00" + device.address, "");
  }
  void add(const TreeUsb& device, const TreeInterface& interface,
           const std::vector<TreeEndpoint>& endpoints) const {
    const std::string in = directory(device, interface.number);
    write(in + "/bInterfaceNumber", "0" + std::to_string(interface.number) + "\n");
    write(in + "/bInterfaceClass", interface.interface_class + "\n");
    if (!interface.driver.empty()) link(in + "/driver", driver(interface.driver));
    for (const TreeEndpoint& endpoint : endpoints) {
      const std::string ep = in + "/ep_" + endpoint.address;
      write(ep + "/bEndpointAddress", endpoint.address + "\n");
      write(ep + "/bmAttributes", endpoint.attributes + "\n");
      write(ep + "/bInterval", endpoint.interval + "\n");
      write(ep + "/wMaxPacketSize", endpoint.packet + "\n");
    }
    link("sys/bus/usb/devices/" + device.path + ":1." + std::to_string(interface.number), in);
  }
  /// A HID device with its hidraw node; `parent`: the interface's directory, or that of uhid.
  void add_hid(const std::string& parent, const std::string& node, const std::string& descriptor,
               const std::string& id = "0003:00001234:00000006") const {
    const std::string in = parent + "/0003:1234:0006.0001";
    write(in + "/uevent", "DRIVER=hid-generic\nHID_ID=" + id +
                              "\nHID_NAME=Emulated\nHID_PHYS=\nHID_UNIQ=U1\nMODALIAS=x\n");
    write(in + "/report_descriptor", descriptor);
    write(in + "/hidraw/" + node + "/dev", "240:0\n");
    link(in + "/hidraw/" + node + "/device", in);
    link("sys/class/hidraw/" + node, in + "/hidraw/" + node);
    write("dev/" + node, "");
  }

 private:
  std::string driver(const std::string& name) const {
    std::filesystem::create_directories(root_ + "/sys/bus/usb/drivers/" + name);
    return "sys/bus/usb/drivers/" + name;
  }
  std::string root_;
};

inline constexpr const char* kUhid = "sys/devices/virtual/misc/uhid";

}  // namespace hapticd::test
