// What of a machine decides whether a loop of some 1000 Hz keeps its time, read from /proc, /sys and
// the process' own limits.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hapticd::daemon {

enum class Severity : std::uint8_t {
  good,
  note,     ///< harmless, or not to be known here
  warning,  ///< late ticks are to be expected
  bad,      ///< the loop cannot run as configured
};
inline constexpr const char* kSeverityNames[] = {"good", "note", "warning", "bad"};

struct Finding {
  std::string topic;  ///< "kernel"
  Severity severity = Severity::good;
  std::string found;
  std::string fix{};  ///< empty: nothing to do
};

/// Rights of a process: of this one, or made up by tests.
struct Rights {
  bool root = false;
  std::uint64_t rtprio = 0, memlock = UINT64_MAX, rttime_us = UINT64_MAX;  ///< hard limits
  bool dma_latency = false;  ///< /dev/cpu_dma_latency can be held
};
Rights rights_of_this_process();

/// Files of the kernel below `root`.
class KernelFiles {
 public:
  explicit KernelFiles(std::filesystem::path root = "/") : root_(std::move(root)) {}
  /// First line; nothing where there is no such file or it cannot be read.
  std::optional<std::string> line(const std::string& path) const;
  std::optional<double> number(const std::string& path) const;
  /// Names in a directory that begin with `prefix`, sorted.
  std::vector<std::string> names(const std::string& directory,
                                 const std::string& prefix = "") const;

 private:
  std::filesystem::path root_;
};

/// Kernel, rights and limits, RT group scheduling, throttling, clock governor, sleep states,
/// interrupt threads against the loop's priority, USB autosuspend, CAN queues.
std::vector<Finding> examine(const KernelFiles& machine, const Rights& rights, int priority);

}  // namespace hapticd::daemon
