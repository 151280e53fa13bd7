// How well a run did: counted by the servo thread, gathered by the supervisor, told at the end, on
// SIGUSR1 and by `hapticctl status`.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "control/build/program.h"
#include "daemon/live.h"
#include "daemon/protocol.h"
#include "daemon/realtime.h"
#include "daemon/servo_shared.h"

namespace hapticd::daemon {

/// Of one phase of all ticks [us]; wake: lateness, the others: duration.
struct PhaseTimesSummary {
  double p50_us = 0, p99_us = 0, p999_us = 0, max_us = 0;
};

/// What the kernel counted for the servo thread.
struct ThreadUse {
  std::uint64_t minor_faults = 0, major_faults = 0;
  std::uint64_t voluntary_switches = 0, involuntary_switches = 0;
};

struct FaultCount {
  Fault code = Fault::none;
  std::uint64_t count = 0;
  std::string last;      ///< described
  double last_at_s = 0;  ///< after the start of the loop
};

struct LimitCount {
  std::string_view name;
  std::uint64_t ticks = 0;  ///< since the start
};

/// As drivers::Traffic.
struct TrafficSummary {
  std::uint64_t late = 0, not_sent = 0, lost = 0, foreign = 0, malformed = 0;
  // of a device that comes and goes
  std::uint64_t connections = 0;
  double round_trip_s = 0, worst_send_s = 0;
  bool comes_and_goes = false;
};

struct DeviceSummary {
  std::string name;
  double work_J = 0;                              ///< done by its motors since the start
  double fade = 1;                                ///< what is let through: 1 all, 0 nothing
  std::vector<std::string> homed{}, not_homed{};  ///< its axes
  std::optional<TrafficSummary> traffic{};        ///< none: it has no bus
};

struct Summary {
  double duration_s = 0;
  double rate_Hz = 0;
  std::uint64_t ticks = 0, late_wakes = 0, overruns = 0, gaps = 0, missed_ticks = 0,
                samples_held = 0;
  std::array<std::uint64_t, kPhases> missed_by{};
  std::array<PhaseTimesSummary, kPhases> times{};
  double largest_force_N = 0;
  std::vector<FaultCount> faults;
  std::vector<LimitCount> limits;
  std::vector<DeviceSummary> devices;  ///< empty: no record has come yet
  std::uint64_t records_dropped = 0, records_lost = 0;
  std::optional<ThreadUse> thread;  ///< since the first tick; none: the kernel does not tell
  std::string kernel;
  bool preempt_rt = false;
  RealtimeReport realtime;
  std::optional<double> load_average;  ///< over one minute
  bool unproven = false;               ///< forces were enabled without a proof
};

/// Counters and histograms; the caller adds the rest.
void take_counters(const ServoCounters& counters, Summary& summary);

/// What the records tell: limits and devices.
void take_records(const build::ProgramSpec& spec, const LiveView& live, Summary& summary);

/// Of a thread of this process, by kernel id, since it was made.
std::optional<ThreadUse> read_thread_use(int thread_id);
/// The same from the texts of /proc/.../stat and /proc/.../status.
std::optional<ThreadUse> parse_thread_use(const std::string& stat, const std::string& status);
ThreadUse operator-(const ThreadUse& now, const ThreadUse& then) noexcept;

std::string to_table(const Summary& summary);
Json to_json(const Summary& summary);

}  // namespace hapticd::daemon
