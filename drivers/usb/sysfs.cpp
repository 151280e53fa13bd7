#include "drivers/usb/sysfs.h"

#include <algorithm>
#include <cmath>

#include "drivers/hid/report_descriptor.h"
#include "drivers/usb/sysfs_file.h"

namespace hapticd::usb {
namespace {

using namespace sysfs;

constexpr std::uint8_t kHubClass = 0x09;
constexpr std::uint32_t kMost8 = 0xff, kMost16 = 0xffff;

std::string driver_of(const std::string& directory) {
  return name_of(real_path(directory + "/driver"));
}

/// One byte more than may be, so that a longer one is refused and not cut.
std::vector<std::uint8_t> descriptor_in(const std::string& hid_directory) {
  return bytes_of(hid_directory + "/report_descriptor", hid::kMostDescriptorBytes + 1);
}

/// As the device wants it (USB 2.0, table 9-13); hosts round down to a power of two.
double interval_of(std::uint32_t speed_Mbit_s, EndpointType type, std::uint32_t b_interval) {
  const double frame_s = speed_Mbit_s >= 480 ? 125e-6 : 1e-3;
  if (type != EndpointType::interrupt || b_interval == 0) return frame_s;
  if (speed_Mbit_s < 480) return frame_s * b_interval;
  return std::ldexp(frame_s, static_cast<int>(std::min(b_interval, 16U)) - 1);
}

std::optional<Endpoint> endpoint_in(const std::string& directory, std::uint32_t speed_Mbit_s) {
  const auto address = number_of(directory + "/bEndpointAddress", 16, kMost8);
  const auto attributes = number_of(directory + "/bmAttributes", 16, kMost8);
  const auto packet = number_of(directory + "/wMaxPacketSize", 16, kMost16);
  const auto interval = number_of(directory + "/bInterval", 16, kMost8);
  if (!address || !attributes || !packet || !interval) return {};
  const auto type = static_cast<EndpointType>(*attributes & 3);
  return Endpoint{.address = static_cast<std::uint8_t>(*address),
                  .type = type,
                  .packet_bytes = *packet & 0x7ff,
                  .interval_s = interval_of(speed_Mbit_s, type, *interval)};
}

/// The HID device that hangs below an interface: its directory is named for bus, vendor and product.
std::vector<std::uint8_t> descriptor_below(const std::string& directory) {
  for (const std::string& name : names_in(directory))
    if (name.starts_with("0003:")) return descriptor_in(directory + "/" + name);
  return {};
}

std::optional<Interface> interface_in(const std::string& directory, std::uint32_t speed_Mbit_s) {
  const auto number = number_of(directory + "/bInterfaceNumber", 16, kMost8);
  const auto interface_class = number_of(directory + "/bInterfaceClass", 16, kMost8);
  if (!number || !interface_class) return {};
  Interface interface {
    .number = static_cast<int>(*number),
    .interface_class = static_cast<std::uint8_t>(*interface_class), .driver = driver_of(directory)
  };
  for (const std::string& name : names_in(directory)) {
    if (!name.starts_with("ep_")) continue;
    if (const auto endpoint = endpoint_in(directory + "/" + name, speed_Mbit_s))
      interface.endpoints.push_back(*endpoint);
  }
  if (interface.interface_class == kHidClass)
    interface.report_descriptor = descriptor_below(directory);
  return interface;
}

std::optional<About> about_in(const std::string& directory, const std::string& path) {
  const auto vendor = number_of(directory + "/idVendor", 16, kMost16);
  const auto product = number_of(directory + "/idProduct", 16, kMost16);
  if (!vendor || !product) return {};
  const std::string maker = text_of(directory + "/manufacturer");
  const std::string what = text_of(directory + "/product");
  return About{.vendor = static_cast<std::uint16_t>(*vendor),
               .product = static_cast<std::uint16_t>(*product),
               .name = maker + (maker.empty() || what.empty() ? "" : " ") + what,
               .serial = text_of(directory + "/serial"),
               .path = path};
}

std::string three_digits(std::uint32_t number) {
  const std::string digits = std::to_string(number);
  return std::string(3 - std::min<std::size_t>(3, digits.size()), '0') + digits;
}

std::uint32_t speed_of(const std::string& directory) {
  return number_of(directory + "/speed", 10, 100'000)
      .value_or(12);  // 1.5 reads as 12: frames of 1 ms
}

std::optional<PluggedDevice> device_in(const Roots& roots, const std::string& directory,
                                       const std::string& path) {
  auto about = about_in(directory, path);
  const auto bus = number_of(directory + "/busnum", 10, 999);
  const auto address = number_of(directory + "/devnum", 10, 127);
  if (!about || !bus || !address) return {};
  if (number_of(directory + "/bDeviceClass", 16, kMost8) == kHubClass) return {};
  PluggedDevice device{
      .about = *std::move(about),
      .node = roots.dev + "/bus/usb/" + three_digits(*bus) + "/" + three_digits(*address)};
  const std::uint32_t speed_Mbit_s = speed_of(directory);
  for (const std::string& name : names_in(directory)) {
    if (!name.starts_with(path + ":")) continue;
    if (auto interface = interface_in(directory + "/" + name, speed_Mbit_s))
      device.interfaces.push_back(*std::move(interface));
  }
  return device;
}

/// HID_ID=0003:00001209:0000FFB0 and others.
void read_uevent(const std::string& hid_directory, HidNode& node) {
  for (const std::string& line : lines_of(hid_directory + "/uevent")) {
    const std::string value = line.substr(std::min(line.size(), line.find('=') + 1));
    if (line.starts_with("DRIVER=")) node.driver = value;
    if (line.starts_with("HID_NAME=")) node.about.name = value;
    if (line.starts_with("HID_UNIQ=")) node.about.serial = value;
    if (!line.starts_with("HID_ID=") || value.size() != 22) continue;
    const auto vendor = number_in(value.substr(5, 8), 16, kMost16);
    const auto product = number_in(value.substr(14, 8), 16, kMost16);
    if (!vendor || !product) continue;
    node.about.vendor = static_cast<std::uint16_t>(*vendor);
    node.about.product = static_cast<std::uint16_t>(*product);
  }
}

void read_usb_parent(const std::string& interface_directory, HidNode& node) {
  const std::string device_directory = parent_of(interface_directory);
  const auto interface = interface_in(interface_directory, speed_of(device_directory));
  const auto about = about_in(device_directory, name_of(device_directory));
  if (!interface || !about) return;
  node.about = *about;
  node.interface = interface->number;
  for (const Endpoint& endpoint : interface->endpoints)
    if (is_in(endpoint)) node.interval_s = endpoint.interval_s;
}

}  // namespace

std::vector<PluggedDevice> usb_devices(const Roots& roots) {
  std::vector<PluggedDevice> devices;
  const std::string all = roots.sys + "/bus/usb/devices";
  for (const std::string& name : names_in(all)) {
    if (name.find(':') != std::string::npos) continue;
    const std::string directory = real_path(all + "/" + name);
    if (directory.empty()) continue;
    if (auto device = device_in(roots, directory, name)) devices.push_back(*std::move(device));
  }
  return devices;
}

std::optional<HidNode> hid_node(const Roots& roots, const std::string& name) {
  const std::string directory = real_path(roots.sys + "/class/hidraw/" + name + "/device");
  if (directory.empty()) return {};
  HidNode node{.node = roots.dev + "/" + name};
  node.about.path = node.node;
  read_uevent(directory, node);
  read_usb_parent(parent_of(directory), node);
  node.report_descriptor = descriptor_in(directory);
  if (node.about.vendor == 0) return {};
  return node;
}

std::vector<HidNode> hid_nodes(const Roots& roots) {
  std::vector<HidNode> nodes;
  for (const std::string& name : names_in(roots.sys + "/class/hidraw"))
    if (auto node = hid_node(roots, name)) nodes.push_back(*std::move(node));
  return nodes;
}

}  // namespace hapticd::usb
