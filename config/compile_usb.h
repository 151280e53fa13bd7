// What the parts of compile_usb() share: one device on USB.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "config/compilation.h"

namespace hapticd::config {

struct UsbPlace {
  Compilation& compilation;
  const DevicePlace& device;
  const UsbDevice& keys;
  usb::Kind kind;

  /// `key`: "usb.id".
  void refuse(const std::string& key, std::string message) const {
    compilation.refuse(device.path + "." + key, std::move(message));
  }
  void refuse_axis(std::size_t axis, const std::string& key, std::string message) const {
    compilation.refuse(device.axes[axis].path + "." + key, std::move(message));
  }
  std::string driver() const;
};

usb::Transport usb_transport(const UsbPlace& place);
usb::Selection compile_selection(const UsbPlace& place);
/// Of device `index`, with those before it.
void check_selection(Compilation& compilation, std::size_t index);
/// "0403:cb48"
std::string hex_pair_text(std::uint32_t first, std::uint32_t second);

/// Refuses an axis that is to deliver more than `most` [N, N m], what `by` carries.
void check_effort(const UsbPlace& place, std::size_t axis, double most, const std::string& by);

usb::FalconOptions compile_falcon(const UsbPlace& place);
usb::OpenFfboardOptions compile_openffboard(const UsbPlace& place);
usb::ReportOptions compile_report(const UsbPlace& place);

/// From when an axis is measured until the force acts that rests on it. `waits_s`: of the loop, for other devices.
double least_latency_s(const usb::DeviceOptions& device, double waits_s);
/// How long the loop may wait for devices that are sampled in phase.
double waits_s(const Compiled& compiled);

}  // namespace hapticd::config
