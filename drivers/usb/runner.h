// The device's own thread. Tests have their own, in virtual time.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>

namespace hapticd::usb {

class Runner {
 public:
  virtual ~Runner() = default;
  virtual void start(std::function<void()> body) = 0;
  /// Until the body has returned. Harmless when repeated.
  virtual void join() = 0;
  /// For who waits for the thread to come to something.
  virtual void pause(std::int64_t duration_ns) = 0;
};

/// A thread with SCHED_FIFO at `priority`, where that is allowed; it takes no signals.
std::unique_ptr<Runner> thread_runner(int priority);

}  // namespace hapticd::usb
