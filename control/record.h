// The record of one tick: a fixed header and arrays sized by the plan. The same bytes go through
// the ring, into the flight recorder and into simulation files (format: daemon/recording.h).
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "control/core/realtime.h"
#include "control/step.h"

namespace hapticd::control {

/// When each phase of a tick ended, relative to the start of its period. All zero in virtual time.
struct PhaseTimes {
  std::int32_t wake_ns = 0;     ///< lateness of the wake-up
  std::int32_t collect_ns = 0;  ///< request + collect took this long
  std::int32_t step_ns = 0;
  std::int32_t command_ns = 0;
};

struct RecordHeader {
  std::int64_t tick = 0;
  std::int64_t time_ns = 0;  ///< start of the period: CLOCK_MONOTONIC, or virtual time from zero
  std::int64_t missed_ticks = 0;
  double fault_found = 0;
  double fault_allowed = 0;
  double ramp = 0;
  PhaseTimes phases;
  std::uint32_t limits = 0;
  std::uint16_t fault_axis = kNoIndex;
  std::uint16_t fault_device = kNoIndex;
  Fault fault = Fault::none;
  Fault host_fault = Fault::none;  ///< as it was in the input, for replay
  Mode mode = Mode::idle;
  std::uint8_t flags = 0;  ///< of the input: 1 enable, 2 clear_fault, 4 unproven
  std::uint32_t sequence =
      0;  ///< counts records: a gap shows records lost before they reached the file
};
static_assert(sizeof(RecordHeader) == 80 && alignof(RecordHeader) == 8);

/// Layout of a record of this plan; plan.record is not read.
RecordLayout record_layout(const Plan& plan) noexcept;

/// Writes one record of plan.record.bytes into `slot` (8-byte aligned, at least that long).
void write_record(const Plan& plan, const State& state, const TickInput& input,
                  const TickOutput& output, std::int64_t time_ns, const PhaseTimes& phases,
                  std::uint32_t sequence, std::byte* slot) noexcept HAPTICD_NONBLOCKING;

}  // namespace hapticd::control
