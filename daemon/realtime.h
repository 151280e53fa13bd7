// What the servo thread needs of the machine, asked for right by right. A right that is missing is
// reported with its name and how to grant it; whether that is fatal is the caller's policy
// (--require-realtime).
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hapticd::daemon {

struct MissingRight {
  std::string right;   ///< "SCHED_FIFO priority 80"
  std::string reason;  ///< what the kernel said
  std::string grant;   ///< how to get it
};

/// What was got.
struct RealtimeReport {
  std::string scheduling =
      "SCHED_OTHER";  ///< class and priority that the servo thread really runs at
  bool memory_locked = false;
  bool dma_latency_held = false;
  std::optional<int> cpu;
  std::vector<MissingRight> missing;
};

/// Whole-process set-up, before the servo thread starts: locks present and future memory, keeps the
/// heap from giving memory back, holds /dev/cpu_dma_latency at 0 for as long as the object lives.
class ProcessRealtime {
 public:
  explicit ProcessRealtime(RealtimeReport& report);
  ~ProcessRealtime();
  ProcessRealtime(const ProcessRealtime&) = delete;
  ProcessRealtime& operator=(const ProcessRealtime&) = delete;

 private:
  int dma_latency_fd_ = -1;
};

/// In the servo thread itself, before its first tick: SCHED_FIFO, CPU pinning, stack prefault.
/// Flush-to-zero is set by Cycle::run for every caller alike.
void enter_realtime(int priority, std::optional<int> cpu, RealtimeReport& report);

/// "6.1.0-rt PREEMPT_RT" or the like, for reports.
std::string kernel_description();
bool kernel_is_preempt_rt();

}  // namespace hapticd::daemon
