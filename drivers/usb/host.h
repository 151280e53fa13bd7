// What a USB device needs of the machine: a clock, a way to wait, ports. Tests have their own, in virtual time. All but
// now_ns() and wake() for the device's own thread alone.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "control/core/result.h"
#include "drivers/usb/options.h"
#include "drivers/usb/port.h"

namespace hapticd::usb {

/// Why a device is not opened.
struct NotOpened {
  bool absent = false;  ///< none is plugged in that fits; else one is, and cannot be used as it is
  Error error{};
};
template <class T>
using Opened = tl::expected<T, NotOpened>;

/// A port and what the device says it is.
template <class P>
struct Found {
  std::unique_ptr<P> port{};
  std::string product{}, serial{};  ///< "" where it has none
  std::string path{};               ///< "1-2.3"; of a device without a bus, uhid: its node
  double interval_s = 1e-3;         ///< between two chances of the IN endpoint
};

class Host {
 public:
  virtual ~Host() = default;
  /// CLOCK_MONOTONIC, or what stands for it. Any thread.
  virtual std::int64_t now_ns() noexcept = 0;
  /// Until then, or until wake().
  virtual void wait(std::int64_t until_ns) = 0;
  /// Ends a wait or a receive of the device's thread, or the next one. Any thread; neither allocates nor waits.
  virtual void wake() noexcept = 0;

  /// The one device that fits: several are refused, with the serials to choose from. `bulk_in` and `bulk_out`: endpoint
  /// addresses of the interface.
  virtual Opened<Found<BulkPort>> open_bulk(const Selection& selection, std::uint8_t bulk_in,
                                            std::uint8_t bulk_out) = 0;
  virtual Opened<Found<HidPort>> open_hid(const Selection& selection) = 0;
};

/// This machine: one for each device, since it wakes one thread.
std::unique_ptr<Host> this_host();

}  // namespace hapticd::usb
