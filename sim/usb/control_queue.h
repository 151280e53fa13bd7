// Control transfers of a host that wait for the device: one after the other, asked again while it says "not yet".
#pragma once
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "sim/usb/wire.h"

namespace hapticd::sim::usb {

class ControlQueue {
 public:
  /// `data`: of a request to the device. `id` is the caller's own.
  void add(std::uint64_t id, const Setup& setup, std::span<const std::uint8_t> data);
  /// False: it is not waiting.
  bool cancel(std::uint64_t id);
  /// Those that are done by now, in order.
  std::vector<Wire::Done> advance(Wire& wire, std::int64_t now_ns);
  std::int64_t next_ns() const;

 private:
  struct Waiting {
    std::uint64_t id = 0;
    Setup setup{};
    std::vector<std::uint8_t> data{};
  };
  std::deque<Waiting> waiting_;
  std::int64_t again_ns_ = 0;
};

}  // namespace hapticd::sim::usb
