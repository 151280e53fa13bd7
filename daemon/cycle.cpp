#include "daemon/cycle.h"

#include <poll.h>
#include <time.h>

#include <algorithm>
#include <cmath>

#include "control/core/capacity.h"
#include "control/core/flush_denormals.h"

namespace hapticd::daemon {
namespace {

std::int32_t between(std::int64_t from_ns, std::int64_t to_ns) noexcept {
  constexpr std::int64_t kLongest_ns = 2'147'483'647;
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(to_ns - from_ns, 0, kLongest_ns));
}

}  // namespace

Cycle::Cycle(std::vector<drivers::Device*> devices, const control::Plan& plan)
    : samples_(plan.axes.size()), aux_(plan.devices.size()) {
  for (auto& delivered : delivered_) delivered.assign(plan.axes.size(), 0.0);
  tick_.axes = samples_;
  tick_.aux = aux_;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    slots_.push_back({devices[i], plan.devices[i].first_axis, plan.devices[i].axes, false});
  }
}

void Cycle::run(build::Program& program, const CycleInput& input, Now now,
                rt::SpscRing* ring) noexcept HAPTICD_NONBLOCKING {
  const FlushDenormals flush_denormals;
  const std::int64_t woke_ns = now();
  request_all(input.time);
  collect_all(input.time, now);
  const std::int64_t collected_ns = now();

  fill_tick(program.state().mode, input);
  output_ = control::step(program.plan(), program.state(), tick_);
  const std::int64_t stepped_ns = now();

  command_all();
  if (output_.mode == control::Mode::fault ||
      (output_.mode == control::Mode::idle && !input.enable))
    set_armed(false);
  phases_ = {.wake_ns = between(input.time.start_ns, woke_ns),
             .collect_ns = between(woke_ns, collected_ns),
             .step_ns = between(collected_ns, stepped_ns),
             .command_ns = between(stepped_ns, now())};
  if (ring != nullptr) record(program, input.time.start_ns, *ring);
  ++sequence_;  // counts lost records too, so that a gap shows them
  last_ = 1 - last_;
}

void Cycle::request_all(const drivers::TickTime& time) noexcept {
  for (AxisSample& sample : samples_) sample.freshness = Freshness::missing;
  for (Slot& slot : slots_) {
    slot.complete = false;
    slot.device->request(time);
  }
}

void Cycle::collect_all(const drivers::TickTime& time, Now now) noexcept {
  while (collect_waiting()) {
    if (!wait_for_buses(time.deadline_ns - now())) return;
  }
}

/// One round over the devices that still owe samples. True: some still do.
bool Cycle::collect_waiting() noexcept {
  bool waiting = false;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (slot.complete) continue;
    const std::span<AxisSample> samples(&samples_[slot.first_axis], slot.axes);
    slot.complete = slot.device->collect(samples, aux_[i]) == drivers::Collected::complete;
    waiting = waiting || !slot.complete;
  }
  return waiting;
}

/// Sleeps until one of the buses has something, for all of them together. False: time is up, or
/// there is nothing to wait for.
bool Cycle::wait_for_buses(std::int64_t timeout_ns) noexcept {
  std::array<pollfd, kMaxDevices> fds;
  nfds_t count = 0;
  for (const Slot& slot : slots_) {
    const int fd = slot.complete ? -1 : slot.device->wait_fd();
    if (fd >= 0) fds[count++] = {.fd = fd, .events = POLLIN, .revents = 0};
  }
  if (count == 0 || timeout_ns <= 0) return false;
  const timespec timeout{.tv_sec = static_cast<time_t>(timeout_ns / 1'000'000'000),
                         .tv_nsec = static_cast<long>(timeout_ns % 1'000'000'000)};
  return ppoll(fds.data(), count, &timeout, nullptr) > 0;
}

/// Adds what the devices said of themselves. Forces are enabled only once all power stages are on.
void Cycle::fill_tick(control::Mode mode, const CycleInput& input) noexcept {
  tick_.tick = input.time.tick;
  tick_.missed_ticks = input.missed_ticks;
  tick_.host_fault = input.host_fault;
  tick_.clear_fault = input.clear_fault;
  tick_.unproven = input.unproven;
  tick_.delivered = delivered_[last_];
  armed_ = true;
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    armed_ = armed_ && aux_[i].armed;
    if (tick_.host_fault.code != Fault::none) continue;
    const bool forces = mode == control::Mode::enabled || mode == control::Mode::homing;
    const bool dropped_out = forces && !aux_[i].armed;
    if (!aux_[i].faulted && !dropped_out) continue;
    tick_.host_fault = {.code = aux_[i].faulted ? Fault::device : Fault::disarmed,
                        .device = static_cast<std::uint16_t>(i)};
  }
  if (input.enable && mode != control::Mode::fault) set_armed(true);
  tick_.enable = input.enable && armed_;
}

void Cycle::command_all() noexcept {
  const bool fault = output_.mode == control::Mode::fault;
  for (const Slot& slot : slots_) {
    const std::span<double> delivered(&delivered_[1 - last_][slot.first_axis], slot.axes);
    if (fault) {
      slot.device->stop();
      std::fill(delivered.begin(), delivered.end(), 0.0);
    } else {
      slot.device->command(output_.effort.subspan(slot.first_axis, slot.axes), delivered);
    }
  }
}

void Cycle::set_armed(bool armed) noexcept {
  if (armed == arm_wanted_) return;
  arm_wanted_ = armed;
  for (const Slot& slot : slots_) slot.device->set_armed(armed);
}

void Cycle::record(const build::Program& program, std::int64_t start_ns,
                   rt::SpscRing& ring) noexcept {
  std::byte* slot = ring.reserve();
  if (slot != nullptr) {
    control::write_record(program.plan(), program.state(), tick_, output_, start_ns, phases_,
                          sequence_, slot);
    ring.commit();
  }
}

void Cycle::stop() noexcept {
  for (const Slot& slot : slots_) slot.device->stop();
  set_armed(false);
}

double largest_contact_force_N(const build::Program& program) noexcept {
  double largest = 0;
  for (const control::DevicePlan& device : program.plan().devices) {
    double square = 0;
    for (const double component :
         program.state().force.subspan(device.first_coordinate, device.coordinates)) {
      square += component * component;
    }
    largest = std::fmax(largest, square);
  }
  return std::sqrt(largest);
}

}  // namespace hapticd::daemon
