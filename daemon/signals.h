// The signals of hapticd. All are blocked in every thread and read by the supervisor from a
// descriptor, but two that must work while it is busy: SIGXCPU, and a repeated SIGINT or SIGTERM
// while it waits for the servo thread to end.
#pragma once
#include <atomic>
#include <cstdint>
#include <optional>

#include "control/core/result.h"
#include "daemon/file_descriptor.h"

namespace hapticd::daemon {

class Signals {
 public:
  /// Blocks SIGINT, SIGTERM, SIGHUP, SIGUSR1 and SIGXCPU in the calling thread and those that it
  /// starts from now on, and ignores SIGPIPE. Before any thread is started.
  static Result<Signals> block();

  int wait_fd() const noexcept { return fd_.get(); }
  /// The next signal that came, or none.
  std::optional<int> next() const;

  /// From now on SIGXCPU, taken in the calling thread, stores Fault::cpu_time in `host_fault`: the
  /// servo thread used up its budget and might never let another thread do it. nullptr takes that
  /// back. The threads are running by now.
  static void cpu_time_fault_to(std::atomic<std::uint8_t>* host_fault);

  /// Shutdown waits for the ramp. A second SIGINT or SIGTERM then sets `estop` (no more ramp); a
  /// third ends the process there and then.
  static void hurry_by(std::atomic<bool>* estop);

 private:
  FileDescriptor fd_;
};

}  // namespace hapticd::daemon
