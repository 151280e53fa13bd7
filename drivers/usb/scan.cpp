#include "drivers/usb/scan.h"

#include <algorithm>
#include <tuple>

#include "drivers/hid/openffboard_codec.h"
#include "drivers/hid/report_descriptor.h"
#include "drivers/usb/choose.h"
#include "drivers/usb/falcon_codec.h"
#include "drivers/usb/node_access.h"

namespace hapticd::usb {
namespace {

bool is(const About& about, std::uint16_t vendor, std::uint16_t product) {
  return about.vendor == vendor && about.product == product;
}
bool is_falcon(const About& about) {
  return is(about, falcon::kVendor, falcon::kProduct);
}
bool is_openffboard(const About& about) {
  return is(about, hid::openffboard::kVendor, hid::openffboard::kProduct);
}

/// Why its node cannot be used, or who has it.
std::string problem_of(const std::string& node, const std::vector<Interface>& interfaces) {
  const auto claimed = [](const Interface& interface) { return interface.driver == "usbfs"; };
  if (std::ranges::any_of(interfaces, claimed))
    return "a program has it already (`fuser -v " + node + "`)";
  const auto problem = access_problem(node);
  return problem ? problem->text : std::string{};
}

FoundDevice falcon_of(const PluggedDevice& device) {
  FoundDevice found{.kind = Kind::falcon, .about = device.about, .node = device.node};
  found.refused = device.interfaces.empty() ? "it is not configured: plug it in again"
                                            : problem_of(device.node, device.interfaces);
  return found;
}

/// A HID interface that no kernel driver has: no hidraw node tells of it.
FoundDevice without_node(const PluggedDevice& device, const Interface& interface) {
  FoundDevice found{.kind = is_openffboard(device.about) ? Kind::openffboard : Kind::hid_report,
                    .about = device.about,
                    .node = device.node,
                    .interface = interface.number};
  found.refused = problem_of(device.node, {interface});
  if (found.refused.empty())
    found.refused =
        "the kernel's usbhid does not drive it, so that there is no hidraw node: only "
        "usb.transport: libusb can use it";
  return found;
}

bool has_vendor_usage(const hid::ReportDescriptor& descriptor) {
  return std::ranges::any_of(descriptor.applications,
                             [](hid::Usage usage) { return usage >> 16 >= 0xff00; });
}

/// Nothing: no driver has use for it.
std::optional<FoundDevice> hid_of(const HidNode& node) {
  const bool board = is_openffboard(node.about);
  const auto descriptor = hid::parse_descriptor(node.report_descriptor);
  if (!board && (!descriptor || !has_vendor_usage(*descriptor))) return {};
  FoundDevice found{.kind = board ? Kind::openffboard : Kind::hid_report,
                    .about = node.about,
                    .node = node.node,
                    .interface = node.interface,
                    .usages = usages_of(node.report_descriptor)};
  found.refused = descriptor ? problem_of(node.node, {}) : descriptor.error().text;
  return found;
}

}  // namespace

std::vector<FoundDevice> scan(const Roots& roots) {
  std::vector<FoundDevice> found;
  for (const PluggedDevice& device : usb_devices(roots)) {
    if (is_falcon(device.about)) found.push_back(falcon_of(device));
    for (const Interface& interface : device.interfaces)
      if (interface.interface_class == kHidClass && interface.driver != "usbhid")
        found.push_back(without_node(device, interface));
  }
  for (const HidNode& node : hid_nodes(roots))
    if (auto device = hid_of(node)) found.push_back(*std::move(device));
  std::ranges::stable_sort(found, {}, [](const FoundDevice& device) {
    return std::tie(device.kind, device.about.path);
  });
  return found;
}

std::string_view word_of(Kind kind) noexcept {
  switch (kind) {
    case Kind::falcon:
      return "falcon";
    case Kind::hid_report:
      return "hid_report";
    case Kind::openffboard:
      return "openffboard";
  }
  return {};
}

}  // namespace hapticd::usb
