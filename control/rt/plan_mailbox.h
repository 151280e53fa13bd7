// Swaps what the servo thread runs on, without it ever waiting or freeing.
//
//   supervisor   offer(fresh) ... collect() gives the old one back, to be deleted
//   servo        at the start of a tick: fresh = take(); if there is one, release(current) and run
//                on fresh
//
// One swap at a time: a second offer is refused until the first was adopted and the old object
// collected. That is also why release() may overwrite the outbox: it is empty by then.
#pragma once
#include <atomic>

namespace hapticd::rt {

template <class T>
class PlanMailbox {
 public:
  /// Supervisor. `fresh` is not nullptr. False: a swap is still under way.
  [[nodiscard]] bool offer(T* fresh) noexcept {
    if (busy_) return false;
    busy_ = true;
    inbox_.store(fresh, std::memory_order_release);
    return true;
  }
  /// Supervisor. The object that the servo thread let go of, or nullptr as long as it has not.
  [[nodiscard]] T* collect() noexcept {
    T* old = outbox_.exchange(nullptr, std::memory_order_acquire);
    if (old != nullptr) busy_ = false;
    return old;
  }
  /// Supervisor, after the servo thread has ended: takes an offer back that nobody adopted.
  [[nodiscard]] T* withdraw() noexcept {
    T* fresh = inbox_.exchange(nullptr, std::memory_order_acquire);
    if (fresh != nullptr) busy_ = false;
    return fresh;
  }

  /// Servo. The object offered, or nullptr; the caller then calls release() with the one it ran on.
  [[nodiscard]] T* take() noexcept {
    if (inbox_.load(std::memory_order_relaxed) == nullptr) return nullptr;
    return inbox_.exchange(nullptr, std::memory_order_acquire);
  }
  /// Servo. `old` is not nullptr; the servo thread never touches it again.
  void release(T* old) noexcept { outbox_.store(old, std::memory_order_release); }

 private:
  std::atomic<T*> inbox_{nullptr};
  std::atomic<T*> outbox_{nullptr};
  bool busy_ = false;  // supervisor only
};

}  // namespace hapticd::rt
