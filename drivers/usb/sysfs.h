// What is plugged in, as sysfs says. No node is opened: looking around disturbs no loop (each open and close of a hidraw node
// takes a lock that all of them share, and opening a USB node wakes the device).
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hapticd::usb {

/// Where the kernel shows devices; tests have trees of their own.
struct Roots {
  std::string sys = "/sys", dev = "/dev";
};

/// What a device says of itself: for people, and to be chosen by. Texts are printable ASCII.
struct About {
  std::uint16_t vendor = 0, product = 0;
  std::string name{};    ///< maker and product; "" where it has none
  std::string serial{};  ///< "" where it has none
  std::string path{};    ///< of the port: "1-2.3"; of a device without a bus: its node
};

enum class EndpointType : std::uint8_t { control, isochronous, bulk, interrupt };
struct Endpoint {
  std::uint8_t address = 0;  ///< with the direction: 0x81
  EndpointType type = EndpointType::bulk;
  std::size_t packet_bytes = 64;
  double interval_s = 1e-3;  ///< between two chances of it
};
constexpr bool is_in(const Endpoint& endpoint) noexcept {
  return (endpoint.address & 0x80) != 0;
}

inline constexpr std::uint8_t kHidClass = 0x03;
struct Interface {
  int number = 0;
  std::uint8_t interface_class = 0;
  std::string driver{};  ///< "usbhid"; "usbfs": a program has claimed it; "": nobody has
  std::vector<Endpoint> endpoints{};
  std::vector<std::uint8_t> report_descriptor{};  ///< of HID, if the kernel has read it
};

struct PluggedDevice {
  About about{};
  std::string node{};                   ///< "/dev/bus/usb/001/002"
  std::vector<Interface> interfaces{};  ///< of the configuration that is set; hubs are left out
};
/// By path.
std::vector<PluggedDevice> usb_devices(const Roots& roots);

struct HidNode {
  About about{};
  std::string node{};  ///< "/dev/hidraw0"
  std::string driver{};
  std::optional<int> interface {};  ///< nothing: not on USB
  double interval_s = 1e-3;         ///< of the interrupt IN endpoint
  std::vector<std::uint8_t> report_descriptor{};
};
/// By node: of USB, and those that a program emulates (uhid).
std::vector<HidNode> hid_nodes(const Roots& roots);
/// One of them, by its name "hidraw0"; nothing: it has gone.
std::optional<HidNode> hid_node(const Roots& roots, const std::string& name);

}  // namespace hapticd::usb
