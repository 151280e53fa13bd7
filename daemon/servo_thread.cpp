#include "daemon/servo_thread.h"

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <cmath>
#include <utility>

#include "control/core/flush_denormals.h"

namespace hapticd::daemon {
namespace {

/// Zero-force cycles on every way out: a bus may lose one.
constexpr int kStopCycles = 5;
/// A loop that cannot ramp out within this time (a driver that blocks, a clock that stands) is
/// stopped as it is.
constexpr std::int64_t kLongestRampOut_ns = 10'000'000'000;

std::int64_t read_clock(clockid_t clock) noexcept {
  timespec time;
  clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

std::int64_t monotonic_ns() noexcept {
  return read_clock(CLOCK_MONOTONIC);
}

ClockPair read_clocks() noexcept {
  return {read_clock(CLOCK_MONOTONIC), read_clock(CLOCK_BOOTTIME)};
}

void sleep_until(std::int64_t time_ns) noexcept {
  const timespec time{.tv_sec = static_cast<time_t>(time_ns / 1'000'000'000),
                      .tv_nsec = static_cast<long>(time_ns % 1'000'000'000)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

/// Signals belong to the supervisor: none may interrupt a tick.
void block_signals() noexcept {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

template <class T>
void count(std::atomic<T>& counter, T by) noexcept {  // one writer: no need for a locked add
  counter.store(counter.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
}

}  // namespace

ServoThread::ServoThread(ServoOptions options, std::vector<drivers::Device*> devices,
                         build::Program* program, ServoShared& shared)
    : options_(options),
      cycle_(std::move(devices), program->plan()),
      schedule_(options.schedule),
      program_(program),
      shared_(shared) {}

ServoThread::~ServoThread() {
  stop();
}

void ServoThread::start(RealtimeReport& report) {
  thread_ = std::thread([this, &report] {
    block_signals();
    shared_.thread_id.store(gettid());
    enter_realtime(options_.priority, options_.cpu, report);
    running_.store(true, std::memory_order_release);
    running_.notify_all();
    loop();
    shared_.ended.store(true, std::memory_order_release);
  });
  running_.wait(false, std::memory_order_acquire);
}

void ServoThread::stop() {
  shared_.run.store(false);
  if (thread_.joinable()) thread_.join();
}

/// Until asked to end; then until the forces have faded, then the stop cycles.
void ServoThread::loop() noexcept {
  const FlushDenormals
      flush_denormals;  // for the thread's life: the one in each cycle then has nothing to do
  schedule_.start(read_clocks());
  std::int64_t asked_ns = 0;
  int stop_cycles = 0;
  while (stop_cycles < kStopCycles) {
    sleep_until(schedule_.next_ns());
    const Wake wake = schedule_.woke(read_clocks());
    const bool ending = !shared_.run.load(std::memory_order_relaxed);
    tick(wake, ending);
    if (!ending) continue;
    if (asked_ns == 0) asked_ns = wake.start_ns;
    const bool faded = cycle_.output().mode != control::Mode::enabled;
    if (!faded && wake.start_ns - asked_ns < kLongestRampOut_ns) continue;
    cycle_.stop();
    ++stop_cycles;
  }
}

void ServoThread::tick(const Wake& wake, bool ending) noexcept {
  adopt_plan();
  CycleInput input{.time = {.tick = wake.tick,
                            .start_ns = wake.start_ns,
                            .deadline_ns = wake.start_ns + options_.collect_ns},
                   .missed_ticks = wake.missed_ticks,
                   .host_fault = wake.fault,
                   .enable = !ending && shared_.enable.load(std::memory_order_relaxed)};
  take_orders(input);
  const bool held = shared_.records_held.load(std::memory_order_acquire);
  cycle_.run(*program_, input, monotonic_ns, held ? nullptr : &shared_.records);
  if (cycle_.output().mode == control::Mode::fault)
    shared_.enable.store(false, std::memory_order_relaxed);
  account(wake);
  publish_status(wake.tick);
}

void ServoThread::take_orders(CycleInput& input) noexcept {
  const std::uint32_t clears = shared_.clears.load(std::memory_order_acquire);
  input.clear_fault = clears != std::exchange(clears_seen_, clears);
  input.unproven = shared_.unproven.load(std::memory_order_relaxed);
  const auto raised = static_cast<Fault>(shared_.host_fault.exchange(0, std::memory_order_relaxed));
  if (raised != Fault::none) input.host_fault = {.code = raised};
  if (shared_.estop.load(std::memory_order_relaxed)) input.host_fault = {.code = Fault::estop};
}

void ServoThread::adopt_plan() noexcept {
  build::Program* fresh = shared_.plans.take();
  if (fresh == nullptr) return;
  control::carry_over(program_->plan(), program_->state(), fresh->plan(), fresh->state());
  if (program_->plan().record != fresh->plan().record)
    shared_.records_held.store(true, std::memory_order_relaxed);
  shared_.plans.release(std::exchange(program_, fresh));
}

void ServoThread::account(const Wake& wake) noexcept {
  ServoCounters& counters = shared_.counters;
  const control::PhaseTimes& phases = cycle_.phases();
  const std::int64_t woke = phases.wake_ns, collected = woke + phases.collect_ns,
                     stepped = collected + phases.step_ns;
  if (schedule_.finished({woke, collected, stepped, stepped + phases.command_ns}))
    count(counters.overruns, std::uint64_t{1});

  count(counters.ticks, std::uint64_t{1});
  if (wake.late_ns > options_.schedule.period_ns / 10) count(counters.late_wakes, std::uint64_t{1});
  if (wake.missed_ticks > 0) {
    const auto missed = static_cast<std::uint64_t>(wake.missed_ticks);
    count(counters.gaps, std::uint64_t{1});
    count(counters.missed_ticks, missed);
    count(counters.missed_by[static_cast<std::size_t>(wake.blamed)], missed);
  }
  if (cycle_.output().limits.has(Limit::sample_held))
    count(counters.samples_held, std::uint64_t{1});
  const std::array<std::int64_t, kPhases> times = {wake.late_ns, phases.collect_ns, phases.step_ns,
                                                   phases.command_ns};
  for (std::size_t phase = 0; phase < kPhases; ++phase) counters.times[phase].add(times[phase]);

  const double force_N = largest_contact_force_N(*program_);
  if (force_N > counters.largest_force_N.load(std::memory_order_relaxed)) {
    counters.largest_force_N.store(force_N, std::memory_order_relaxed);
  }
}

void ServoThread::publish_status(std::int64_t tick) noexcept {
  const control::TickOutput& output = cycle_.output();
  double ramp = 1;
  for (const double share : program_->state().ramp) ramp = std::fmin(ramp, share);
  shared_.status.store({.tick = tick,
                        .mode = output.mode,
                        .armed = cycle_.armed(),
                        .enable_wanted = shared_.enable.load(std::memory_order_relaxed),
                        .ramp = ramp,
                        .fault = output.fault});
}

}  // namespace hapticd::daemon
