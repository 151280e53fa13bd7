// Which device on USB a config means.
#include <charconv>

#include "config/compile_usb.h"
#include "config/describe.h"

namespace hapticd::config {
namespace {

/// "0403:cb48" as it was read.
std::uint32_t hex_pair(const std::string& text) {
  const auto number = [&](std::size_t from) {
    std::uint32_t value = 0;
    std::from_chars(text.data() + from, text.data() + from + 4, value, 16);
    return value;
  };
  return number(0) << 16 | number(5);
}

/// A key that does nothing with this driver or transport.
void refuse_foreign_keys(const UsbPlace& place) {
  const UsbDevice usual;
  const UsbDevice& keys = place.keys;
  const auto refuse_hid = [&](bool given, const char* key) {
    if (!given || place.kind != usb::Kind::falcon) return;
    place.refuse(std::string("usb.") + key,
                 "a key of HID devices, and a Falcon is none; remove it");
  };
  refuse_hid(keys.interface.has_value(), "interface");
  refuse_hid(keys.usage.has_value(), "usage");
  refuse_hid(keys.transport != usual.transport, "transport");
  if (keys.reads != usual.reads && usb_transport(place) == usb::Transport::hidapi)
    place.refuse("usb.reads",
                 "a key of transport: libusb, found with transport: hidapi; remove it");
}

std::uint32_t id_of(const UsbPlace& place) {
  if (place.keys.id) return hex_pair(*place.keys.id);
  switch (place.kind) {
    case usb::Kind::falcon:
      return 0x0403'cb48;
    case usb::Kind::openffboard:
      return 0x1209'ffb0;
    case usb::Kind::hid_report:
      break;
  }
  place.refuse("usb.id",
               "missing; expected here with driver: hid_report: id, vendor and product as "
               "lsusb prints them");
  return 0;
}

/// Does something tell these from each other that is said of both?
bool told_apart(const usb::Selection& a, const usb::Selection& b) {
  const auto differ = [](const std::string& x, const std::string& y) {
    return !x.empty() && !y.empty() && x != y;
  };
  return a.vendor != b.vendor || a.product != b.product || differ(a.serial, b.serial) ||
         differ(a.path, b.path);
}

}  // namespace

usb::Transport usb_transport(const UsbPlace& place) {
  if (place.kind == usb::Kind::falcon) return usb::Transport::libusb;
  return static_cast<usb::Transport>(place.keys.transport);
}

usb::Selection compile_selection(const UsbPlace& place) {
  const UsbDevice& keys = place.keys;
  refuse_foreign_keys(place);
  const std::uint32_t id = id_of(place);
  usb::Selection selection{.vendor = static_cast<std::uint16_t>(id >> 16),
                           .product = static_cast<std::uint16_t>(id & 0xffff),
                           .serial = keys.serial.value_or(""),
                           .path = keys.path.value_or(""),
                           .interface = keys.interface,
                           .usage = {},
                           .transport = usb_transport(place),
                           .reads = keys.reads};
  if (keys.usage) selection.usage = hex_pair(*keys.usage);
  return selection;
}

std::string hex_pair_text(std::uint32_t first, std::uint32_t second) {
  const auto digits = [](std::uint32_t value) {
    std::string text(4, '0');
    for (auto digit = text.rbegin(); digit != text.rend(); ++digit, value >>= 4)
      *digit = "0123456789abcdef"[value & 0xf];
    return text;
  };
  return digits(first) + ":" + digits(second);
}

void check_selection(Compilation& compilation, std::size_t index) {
  const usb::DeviceOptions& own = *compilation.usb[index];
  for (std::size_t i = 0; i < index; ++i) {
    const auto& other = compilation.usb[i];
    if (!other || told_apart(own.selection, other->selection)) continue;
    compilation.refuse(
        indexed("devices", index) + ".usb",
        "this may be the device of '" + other->name + "', too, " +
            hex_pair_text(own.selection.vendor, own.selection.product) +
            ": give both a serial, or both a path, that tells them apart; hapticctl devices lists "
            "them");
    return;
  }
}

}  // namespace hapticd::config
