// What the records say of the loop now: the last one, and how often each limit has bitten since the
// start. The telemetry thread writes it, the supervisor reads it; the loop knows nothing of it.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "control/record.h"
#include "daemon/histogram.h"

namespace hapticd::daemon {

/// Of the samples of one axis since the start, when they were collected [s].
struct SampleAges {
  std::uint64_t samples = 0;  ///< with a value
  double p50_s = 0, p999_s = 0, max_s = 0;
};

struct LiveView {
  bool known = false;                    ///< a record has come; else only limit_ticks is to be read
  std::vector<bool> homed{};             ///< per axis
  std::vector<double> work_J{};          ///< per device: done by its motors since the start
  std::vector<double> fade{};            ///< per device, 0 to 1
  std::vector<std::uint32_t> digital{};  ///< per device: Aux::digital
  std::vector<SampleAges> ages{};        ///< per axis
  std::array<std::uint64_t, 32> limit_ticks{};  ///< by bit of LimitFlags
};

class Live {
 public:
  /// Records from now on have this layout. What was counted is kept.
  void begin(const control::RecordLayout& layout);
  /// Telemetry thread.
  void add(const std::byte* record);
  LiveView view() const;

 private:
  mutable std::mutex mutex_;  // between supervisor and telemetry thread only
  control::RecordLayout layout_;
  std::vector<std::byte> record_;
  bool known_ = false;
  std::array<std::uint64_t, 32> limit_ticks_{};
  std::deque<Histogram> ages_;  // per axis; a deque, as histograms cannot move
};

}  // namespace hapticd::daemon
