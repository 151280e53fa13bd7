#include "control/record.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include "control/recorded.h"

namespace hapticd::control {
namespace {

/// Loops with copies of constant size: at a few axes they cost less than a call of memcpy each.
void put_axes(std::byte* slot, const RecordLayout& at, const State& state,
              const TickInput& input) noexcept {
  for (std::size_t i = 0; i < input.axes.size(); ++i) {
    const AxisSample& sample = input.axes[i];
    std::memcpy(slot + at.raw.offset + 8 * i, &sample.raw, 8);
    std::memcpy(slot + at.age_ns.offset + 8 * i, &sample.age_ns, 8);
    std::memcpy(slot + at.delivered.offset + 8 * i, &input.delivered[i], 8);
    std::memcpy(slot + at.drive_faults.offset + 4 * i, &sample.drive_faults, 4);
    std::memcpy(slot + at.drive_limits.offset + 2 * i, &sample.drive_limits, 2);
    slot[at.freshness.offset + i] = static_cast<std::byte>(sample.freshness);
    slot[at.homed.offset + i] = static_cast<std::byte>(state.axes[i].homed);
  }
}

void put_aux(std::byte* slot, const RecordLayout& at, std::span<const Aux> aux) noexcept {
  for (std::size_t i = 0; i < aux.size(); ++i) {
    std::memcpy(slot + at.aux.offset + sizeof(Aux) * i, &aux[i], sizeof(Aux));
  }
}

std::uint8_t input_flags(const TickInput& input) noexcept {
  return static_cast<std::uint8_t>((input.enable ? 1u : 0u) | (input.clear_fault ? 2u : 0u) |
                                   (input.unproven ? 4u : 0u));
}

double smallest(std::span<const double> values) noexcept {
  double least = 1;
  for (const double value : values) least = std::min(least, value);
  return least;
}

}  // namespace

RecordLayout record_layout(const Plan& plan) noexcept {
  RecordLayout layout;
  std::size_t offset = sizeof(RecordHeader);
  const auto place = [&offset](RecordArray& array, std::size_t count, std::size_t bytes) {
    array = {static_cast<std::uint32_t>(offset), static_cast<std::uint32_t>(count)};
    offset += count * bytes;
  };
  const std::size_t axes = plan.axes.size(), devices = plan.devices.size();
  for (RecordArray* array : {&layout.raw, &layout.age_ns, &layout.delivered})
    place(*array, axes, 8);
  for (const RecordedField& field : kRecorded) {
    const std::size_t count = field.per == Per::axis     ? axes
                              : field.per == Per::device ? devices
                                                         : plan.coordinates;
    place(layout.*field.layout, field.named(plan) ? count : 0, 8);
  }
  place(layout.aux, devices, sizeof(Aux));
  place(layout.drive_faults, axes, 4);
  place(layout.drive_limits, axes, 2);
  place(layout.freshness, axes, 1);
  place(layout.homed, axes, 1);
  layout.bytes = static_cast<std::uint32_t>((offset + 7) / 8 * 8);
  return layout;
}

void write_record(const Plan& plan, const State& state, const TickInput& input,
                  const TickOutput& output, std::int64_t time_ns, const PhaseTimes& phases,
                  std::uint32_t sequence, std::byte* slot) noexcept HAPTICD_NONBLOCKING {
  std::construct_at(reinterpret_cast<RecordHeader*>(slot),
                    RecordHeader{.tick = input.tick,
                                 .time_ns = time_ns,
                                 .missed_ticks = input.missed_ticks,
                                 .fault_found = output.fault.found,
                                 .fault_allowed = output.fault.allowed,
                                 .ramp = smallest(state.ramp),
                                 .phases = phases,
                                 .limits = output.limits.bits(),
                                 .fault_axis = output.fault.axis,
                                 .fault_device = output.fault.device,
                                 .fault = output.fault.code,
                                 .host_fault = input.host_fault.code,
                                 .mode = output.mode,
                                 .flags = input_flags(input),
                                 .sequence = sequence});
  const RecordLayout& at = plan.record;
  std::memset(slot + at.bytes - 8, 0, 8);  // the padding behind the last array
  put_axes(slot, at, state, input);
  put_aux(slot, at, input.aux);
  std::memcpy(slot + at.q.offset, state.recorded.data(), state.recorded.size_bytes());
}

}  // namespace hapticd::control
