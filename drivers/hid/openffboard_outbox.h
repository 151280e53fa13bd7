// Reports on their way through a port that keeps only the newest of what waits: a report that counts is never replaced, a
// magnitude only by a newer one of its axis.
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/usb/port.h"

namespace hapticd::hid::openffboard {

class Outbox {
 public:
  /// Nothing waits: what is sent now replaces nothing.
  bool is_free(const usb::Port& port) const noexcept { return !port.outgoing().waits; }
  /// Of what waits: the axis whose magnitude it is; nothing: it must not be replaced, or nothing waits.
  std::optional<std::size_t> waiting(const usb::Port& port) const noexcept {
    return is_free(port) ? std::nullopt : axis_;
  }
  /// Precondition: is_free(), or `axis` is the one that waits.
  usb::Status send(usb::Port& port, std::span<const std::uint8_t> report,
                   std::optional<std::size_t> axis = {}) {
    const usb::Status status = port.send(report);
    if (status == usb::Status::ok) axis_ = axis;
    return status;
  }

 private:
  std::optional<std::size_t> axis_{};
};

}  // namespace hapticd::hid::openffboard
