// What came from a device and was not handed out yet. Never grows: memory is that of the start.
//
// A report that says where the device is makes those before it worthless: were each handed out, a thread that fell behind
// once would follow at that distance for ever. So of reports with the same id only the newest waits, but for those that do
// not say where it is, each of which counts.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/usb/port.h"

namespace hapticd::usb {

/// What may take the place of what.
struct Superseding {
  bool newest_only = false;                  ///< false: all count
  bool numbered = false;                     ///< byte 0 is an id; else all are of one kind
  std::optional<std::uint8_t> only_of_id{};  ///< of other ids each counts
};

class ArrivalQueue {
 public:
  /// As many as Linux' hidraw keeps.
  static constexpr std::size_t kMost = 64;

  ArrivalQueue(std::size_t most_bytes, Superseding superseding);

  /// Bytes beyond `most_bytes` are cut off. Where the queue is full the oldest goes.
  void push(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) noexcept;
  /// The oldest; its bytes stand until the next take(). Status::nothing: none waits.
  Arrival take() noexcept;
  bool empty() const noexcept { return waiting_ == 0; }
  std::uint64_t skipped() const noexcept { return skipped_; }

 private:
  struct Slot {
    std::uint64_t order = 0;  ///< 0: free
    std::size_t size = 0;
    std::int64_t stamp_ns = 0;
    std::vector<std::uint8_t> bytes{};
  };
  bool supersedes(std::span<const std::uint8_t> bytes, const Slot& older) const noexcept;
  Slot& slot_for(std::span<const std::uint8_t> bytes) noexcept;
  Slot* oldest() noexcept;

  const Superseding superseding_;
  std::vector<Slot> slots_;  ///< one more than may wait: that which is handed out
  std::size_t waiting_ = 0;
  Slot* lent_ = nullptr;
  std::uint64_t last_ = 0, skipped_ = 0;
};

}  // namespace hapticd::usb
