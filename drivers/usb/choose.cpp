#include "drivers/usb/choose.h"

#include <algorithm>
#include <array>
#include <utility>

#include "drivers/hid/report_descriptor.h"

namespace hapticd::usb {
namespace {

std::string hex4(std::uint32_t number) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (int shift = 12; shift >= 0; shift -= 4) text += kDigits[number >> shift & 0xf];
  return text;
}

std::string usage_text(std::uint32_t usage) {
  return hex4(usage >> 16) + ":" + hex4(usage & 0xffff);
}

std::string joined(const std::vector<std::string>& parts) {
  constexpr std::size_t kMost = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(parts.size(), kMost); ++i)
    text += (i == 0 ? "" : ", ") + parts[i];
  return parts.size() > kMost ? text + " and " + std::to_string(parts.size() - kMost) + " more"
                              : text;
}

bool fits(const Selection& selection, const About& about) {
  return about.vendor == selection.vendor && about.product == selection.product &&
         (selection.serial.empty() || about.serial == selection.serial) &&
         (selection.path.empty() || about.path == selection.path);
}

std::string wanted(const Selection& selection) {
  return id_of(selection.vendor, selection.product) +
         (selection.serial.empty() ? "" : ", serial " + selection.serial) +
         (selection.path.empty() ? "" : ", port " + selection.path);
}

tl::unexpected<NotOpened> absent(const Selection& selection, std::vector<std::string> there) {
  std::string text = "no device " + wanted(selection) + " is plugged in; found: ";
  text += there.empty() ? "none" : joined(there);
  return tl::unexpected(
      NotOpened{.absent = true, .error = {std::move(text), ExitCode::unavailable}});
}

/// A device, or a part of one, that may be meant.
struct Candidate {
  About about{};
  std::string part{};  ///< "interface 0, usage ff00:0001"
};

std::string words(const Candidate& candidate) {
  return usb::words(candidate.about) + (candidate.part.empty() ? "" : " " + candidate.part);
}

/// The config keys that tell these apart.
std::string keys(const std::vector<Candidate>& several) {
  const auto differ = [&](auto member) {
    return std::ranges::any_of(several, [&](const Candidate& one) {
      return one.about.*member != several.front().about.*member;
    });
  };
  if (!differ(&About::path)) return "usb.interface or usb.usage";
  return differ(&About::serial) ? "usb.serial or usb.path" : "usb.path";
}

tl::unexpected<NotOpened> too_many(const Selection& selection,
                                   const std::vector<Candidate>& several) {
  std::vector<std::string> texts;
  for (const Candidate& candidate : several) texts.push_back(words(candidate));
  return refused(ExitCode::unavailable, "expected one device " + wanted(selection) + ", found " +
                                            std::to_string(several.size()) + ": " + joined(texts) +
                                            "; choose with " + keys(several));
}

/// Those plugged in that fit; else why not.
Opened<std::vector<PluggedDevice>> fitting(const Selection& selection, const Roots& roots) {
  std::vector<PluggedDevice> list;
  std::vector<std::string> there;
  for (PluggedDevice& device : usb_devices(roots)) {
    there.push_back(words(device.about));
    if (fits(selection, device.about)) list.push_back(std::move(device));
  }
  if (list.empty()) return absent(selection, std::move(there));
  return list;
}

/// Of all interfaces of `devices` the one that `is_meant`.
template <class IsMeant>
Opened<ChosenInterface> the_one(const Selection& selection,
                                const std::vector<PluggedDevice>& devices,
                                const std::string& expected, IsMeant is_meant) {
  std::vector<ChosenInterface> chosen;
  std::vector<Candidate> candidates;
  for (const PluggedDevice& device : devices) {
    for (const Interface& interface : device.interfaces) {
      if (selection.interface && interface.number != *selection.interface) continue;
      if (!is_meant(interface)) continue;
      chosen.push_back({device, interface});
      std::string part = "interface " + std::to_string(interface.number);
      if (!interface.report_descriptor.empty())
        part += ", usage " + usages_of(interface.report_descriptor);
      candidates.push_back({device.about, std::move(part)});
    }
  }
  if (chosen.empty())
    return refused(
        ExitCode::unavailable,
        words(devices.front().about) + " has no " + expected +
            (selection.interface ? " in interface " + std::to_string(*selection.interface) : "") +
            (devices.front().interfaces.empty() ? "; it is not configured" : ""));
  if (chosen.size() > 1) return too_many(selection, candidates);
  return chosen.front();
}

bool has_endpoint(const Interface& interface, std::uint8_t address, EndpointType type) {
  return std::ranges::any_of(interface.endpoints, [&](const Endpoint& endpoint) {
    return endpoint.address == address && endpoint.type == type;
  });
}

std::string expected_hid(const Selection& selection) {
  return "HID interface" +
         (selection.usage ? " with usage " + usage_text(*selection.usage) : std::string{});
}

}  // namespace

std::string id_of(std::uint16_t vendor, std::uint16_t product) {
  return hex4(vendor) + ":" + hex4(product);
}

std::string words(const About& about) {
  return (about.name.empty() ? "device" : about.name) + " (" + id_of(about.vendor, about.product) +
         (about.serial.empty() ? ", no serial" : ", serial " + about.serial) + ", port " +
         about.path + ")";
}

std::string usages_of(const std::vector<std::uint8_t>& report_descriptor) {
  const auto parsed = hid::parse_descriptor(report_descriptor);
  if (!parsed || parsed->applications.empty()) return "none that can be read";
  std::vector<std::string> texts;
  for (const hid::Usage usage : parsed->applications) texts.push_back(usage_text(usage));
  return joined(texts);
}

bool has_usage(const std::vector<std::uint8_t>& report_descriptor, const Selection& selection) {
  if (!selection.usage) return true;
  const auto parsed = hid::parse_descriptor(report_descriptor);
  return parsed &&
         std::ranges::find(parsed->applications, *selection.usage) != parsed->applications.end();
}

tl::unexpected<NotOpened> refused(ExitCode code, std::string text) {
  return tl::unexpected(NotOpened{.absent = false, .error = {std::move(text), code}});
}

Opened<ChosenInterface> choose_bulk(const Selection& selection, std::uint8_t bulk_in,
                                    std::uint8_t bulk_out, const Roots& roots) {
  const auto devices = fitting(selection, roots);
  if (!devices) return tl::unexpected(devices.error());
  return the_one(selection, *devices,
                 "bulk endpoints " + std::to_string(bulk_in & 0xf) + " in and " +
                     std::to_string(bulk_out & 0xf) + " out",
                 [&](const Interface& interface) {
                   return has_endpoint(interface, bulk_in, EndpointType::bulk) &&
                          has_endpoint(interface, bulk_out, EndpointType::bulk);
                 });
}

Opened<ChosenInterface> choose_hid_interface(const Selection& selection, const Roots& roots) {
  const auto devices = fitting(selection, roots);
  if (!devices) return tl::unexpected(devices.error());
  return the_one(selection, *devices, expected_hid(selection), [&](const Interface& interface) {
    const bool reads = std::ranges::any_of(interface.endpoints, [](const Endpoint& endpoint) {
      return endpoint.type == EndpointType::interrupt && is_in(endpoint);
    });
    return interface.interface_class == kHidClass && reads &&
           (interface.report_descriptor.empty() ||
            has_usage(interface.report_descriptor, selection));
  });
}

Opened<HidNode> choose_hid_node(const Selection& selection, const Roots& roots) {
  std::vector<HidNode> chosen, others;
  std::vector<Candidate> candidates;
  std::vector<std::string> there;
  for (HidNode& node : hid_nodes(roots)) {
    there.push_back(words(node.about));
    if (!fits(selection, node.about)) continue;
    std::string part =
        (node.interface ? "interface " + std::to_string(*node.interface) : node.node) + ", usage " +
        usages_of(node.report_descriptor);
    const bool meant = (!selection.interface || node.interface == selection.interface) &&
                       has_usage(node.report_descriptor, selection);
    if (meant) candidates.push_back({node.about, std::move(part)});
    (meant ? chosen : others).push_back(std::move(node));
  }
  if (chosen.size() > 1) return too_many(selection, candidates);
  if (!chosen.empty()) return chosen.front();
  if (!others.empty())
    return refused(
        ExitCode::unavailable,
        words(others.front().about) + " has no " + expected_hid(selection) +
            (selection.interface ? " as interface " + std::to_string(*selection.interface) : "") +
            "; " + others.front().node + " has usage " +
            usages_of(others.front().report_descriptor));
  for (const PluggedDevice& device : usb_devices(roots))
    if (fits(selection, device.about))
      return refused(ExitCode::unavailable,
                     words(device.about) +
                         " has no hidraw node: the kernel's usbhid and hidraw are missing, another "
                         "program has detached them, or it is no HID device");
  return absent(selection, std::move(there));
}

}  // namespace hapticd::usb
