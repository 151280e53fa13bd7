#include "drivers/usb/arrival_queue.h"

#include <algorithm>

namespace hapticd::usb {

ArrivalQueue::ArrivalQueue(std::size_t most_bytes, Superseding superseding)
    : superseding_(superseding), slots_(kMost + 1) {
  for (Slot& slot : slots_) slot.bytes.resize(most_bytes);
}

bool ArrivalQueue::supersedes(std::span<const std::uint8_t> bytes,
                              const Slot& older) const noexcept {
  if (!superseding_.newest_only || older.order == 0) return false;
  if (!superseding_.numbered) return true;
  return bytes.front() == older.bytes.front() &&
         bytes.front() == superseding_.only_of_id.value_or(bytes.front());
}

ArrivalQueue::Slot* ArrivalQueue::oldest() noexcept {
  Slot* found = nullptr;
  for (Slot& slot : slots_)
    if (slot.order != 0 && (found == nullptr || slot.order < found->order)) found = &slot;
  return found;
}

ArrivalQueue::Slot& ArrivalQueue::slot_for(std::span<const std::uint8_t> bytes) noexcept {
  for (Slot& slot : slots_) {
    if (!supersedes(bytes, slot)) continue;
    ++skipped_;
    return slot;
  }
  if (waiting_ == kMost) {
    ++skipped_;
    Slot& dropped = *oldest();
    dropped.order = 0;
    return dropped;
  }
  ++waiting_;
  return *std::ranges::find_if(
      slots_, [this](const Slot& slot) { return slot.order == 0 && &slot != lent_; });
}

void ArrivalQueue::push(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) noexcept {
  if (bytes.empty()) return;
  Slot& slot = slot_for(bytes);
  // A newer report takes the place of the older one: what came between is not handed out before it.
  if (slot.order == 0) slot.order = ++last_;
  slot.size = std::min(bytes.size(), slot.bytes.size());
  slot.stamp_ns = stamp_ns;
  std::copy_n(bytes.begin(), slot.size, slot.bytes.begin());
}

Arrival ArrivalQueue::take() noexcept {
  lent_ = oldest();
  if (lent_ == nullptr) return {};
  lent_->order = 0;
  --waiting_;
  return {.status = Status::ok,
          .bytes = {lent_->bytes.data(), lent_->size},
          .stamp_ns = lent_->stamp_ns};
}

}  // namespace hapticd::usb
