// Which devices on USB, and HID devices, a driver could have. Nothing is opened and nothing asked: it may run beside a loop.
#pragma once
#include <string>
#include <vector>

#include "drivers/usb/options.h"
#include "drivers/usb/sysfs.h"

namespace hapticd::usb {

struct FoundDevice {
  Kind kind = Kind::hid_report;
  About about{};
  std::string node{};
  std::optional<int> interface {};
  std::string usages{};   ///< HID, of the top collections: "ffab:0200"
  std::string refused{};  ///< why it cannot be used as it is; empty: nothing is known against it
};

/// By kind and path. Of HID, beside what is known by name, those with a vendor's usages.
std::vector<FoundDevice> scan(const Roots& roots);

/// As in a config.
std::string_view word_of(Kind kind) noexcept;

}  // namespace hapticd::usb
