// All that the servo thread shares with the rest of the process. Nothing here ever makes either
// side wait.
#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "control/build/program.h"
#include "control/core/fault.h"
#include "control/rt/latest.h"
#include "control/rt/plan_mailbox.h"
#include "control/rt/spsc_ring.h"
#include "daemon/histogram.h"

namespace hapticd::daemon {

/// The phases of a tick, as late ticks are blamed on them.
enum class Phase : std::uint8_t { wake, collect, step, command };
inline constexpr std::size_t kPhases = 4;
inline constexpr std::array<const char*, kPhases> kPhaseNames = {"wake", "collect", "step",
                                                                 "command"};

/// Counted by the servo thread alone, read by anyone.
struct ServoCounters {
  std::atomic<std::uint64_t> ticks{0};       ///< executed
  std::atomic<std::uint64_t> late_wakes{0};  ///< woke later than a tenth of the period
  std::atomic<std::uint64_t> overruns{0};    ///< ticks that ended after their period
  std::atomic<std::uint64_t> gaps{0};        ///< times that at least one tick was missed
  std::atomic<std::uint64_t> missed_ticks{0};
  std::array<std::atomic<std::uint64_t>, kPhases>
      missed_by{};  ///< missed ticks by the phase that was late
  std::atomic<std::uint64_t> samples_held{0};
  std::atomic<double> largest_force_N{0};  ///< norm over the contacts, after the guard
  std::array<Histogram, kPhases> times;    ///< wake: lateness; the others: duration
};

/// Where the loop stands, as of its last tick.
struct ServoStatus {
  std::int64_t tick = 0;
  control::Mode mode = control::Mode::idle;
  bool armed = false;  ///< all devices
  bool enable_wanted = false;
  double ramp = 0;
  FaultReport fault;
};

struct ServoShared {
  ServoShared(std::span<std::byte> ring_storage, std::size_t slot_bytes)
      : records(ring_storage, slot_bytes) {}

  // others -> servo
  std::atomic<bool> run{true};  ///< false: ramp out, stop cycles, end of thread
  std::atomic<bool> enable{
      false};  ///< forces are wanted; the servo thread takes it back itself on a fault
  std::atomic<bool> unproven{false};  ///< they are wanted without a proof: for the record
  std::atomic<bool> estop{false};     ///< zero force within one tick; stands until it is taken back
  std::atomic<std::uint32_t> clears{0};  ///< counts up: an operator leaves the fault
  std::atomic<std::uint8_t> host_fault{
      0};  ///< a Fault raised from outside the loop (SIGXCPU); taken by the servo
  rt::PlanMailbox<build::Program> plans;

  // servo -> others
  rt::SpscRing records;  ///< slots hold a record of any plan for these devices
  /// Raised by the servo thread when it adopts a plan whose records look different, and then it
  /// writes none: the supervisor takes it back once the old ones are drained. Their sequence numbers
  /// show the gap.
  std::atomic<bool> records_held{false};
  rt::Latest<ServoStatus> status;
  ServoCounters counters;
  std::atomic<int> thread_id{0};  ///< kernel id, for /proc/self/task
  std::atomic<bool> ended{false};
};

}  // namespace hapticd::daemon
