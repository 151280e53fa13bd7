#include "daemon/doctor_measure.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "daemon/engine.h"
#include "daemon/monotonic.h"

namespace hapticd::daemon {
namespace {

double seconds_of(std::uint64_t ns) {
  return 1e-9 * static_cast<double>(ns);
}

void wait(double seconds, const std::atomic<bool>& interrupt, const std::atomic<bool>* ended) {
  const std::int64_t until = monotonic_ns() + static_cast<std::int64_t>(1e9 * seconds);
  while (monotonic_ns() < until && !interrupt && !(ended && ended->load()))
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

void take_wake(LoopTimes& times, const Histogram& wake) {
  times.wake_p50_s = seconds_of(wake.percentile_ns(0.5));
  times.wake_p999_s = seconds_of(wake.percentile_ns(0.999));
  times.wake_max_s = seconds_of(wake.max_ns());
}

/// The longest of its axes.
double simulated_delay_s(const config::Device& device) {
  double longest = 0;
  if (device.sim)
    for (const config::SimAxis& axis : device.sim->axes) longest = std::max(longest, axis.delay_s);
  return longest;
}

/// The oldest of its axes.
DeviceTimes device_times(const config::Device& device, const control::DevicePlan& plan,
                         const LiveView& live) {
  DeviceTimes times{.name = device.name,
                    .seen = live.known,
                    .simulated = device.driver == config::Driver::sim,
                    .simulated_delay_s = simulated_delay_s(device),
                    .latency_s = device.latency_s};
  for (std::size_t i = 0; live.known && i < plan.axes; ++i) {
    const SampleAges& ages = live.ages[plan.first_axis + i];
    times.seen = times.seen && ages.samples > 0;
    times.p50_s = std::max(times.p50_s, ages.p50_s);
    times.p999_s = std::max(times.p999_s, ages.p999_s);
    times.max_s = std::max(times.max_s, ages.max_s);
  }
  return times;
}

}  // namespace

Result<Measured> measure(config::Compiled& compiled, double seconds,
                         const std::atomic<bool>& interrupt) {
  const std::vector<config::Device> devices = compiled.document.config.devices;
  // Only looked at: nothing is written.
  compiled.document.config.telemetry = {.flight_dir = "", .record = {}};
  Engine engine(compiled, {.flight_written = [](const std::string&, std::uint64_t) {},
                           .failed = [](const Error&) {}});
  if (auto connected = engine.connect(); !connected) return tl::unexpected(connected.error());
  const std::int64_t begin = monotonic_ns();
  engine.start();
  wait(seconds, interrupt, &engine.shared().ended);
  const LiveView live = engine.live();
  const ServoCounters& counters = engine.shared().counters;
  Measured made{.times = {}, .rights = engine.realtime()};
  LoopTimes& times = made.times;
  times.seconds = seconds_of(static_cast<std::uint64_t>(monotonic_ns() - begin));
  times.period_s = engine.program().plan().period_s;
  times.ticks = counters.ticks;
  times.missed = counters.missed_ticks;
  take_wake(times, counters.times[static_cast<std::size_t>(Phase::wake)]);
  const Histogram& collect = counters.times[static_cast<std::size_t>(Phase::collect)];
  times.collect_p50_s = seconds_of(collect.percentile_ns(0.5));
  times.collect_p999_s = seconds_of(collect.percentile_ns(0.999));
  times.collect_max_s = seconds_of(collect.max_ns());
  for (const Phase phase : {Phase::step, Phase::command})
    times.answer_p999_s +=
        seconds_of(counters.times[static_cast<std::size_t>(phase)].percentile_ns(0.999));
  for (std::size_t d = 0; d < devices.size(); ++d)
    times.devices.push_back(device_times(devices[d], engine.program().plan().devices[d], live));
  engine.stop();
  return made;
}

Measured measure_wake_ups(int priority, double seconds, const std::atomic<bool>& interrupt) {
  constexpr std::int64_t kPeriod_ns = 1'000'000;
  Measured made;
  const auto late = std::make_unique<Histogram>();
  std::atomic<bool> run{true};
  std::uint64_t missed = 0;
  ProcessRealtime process(made.rights);
  std::thread loop([&] {
    enter_realtime(priority, {}, made.rights);
    std::int64_t next = monotonic_ns() + kPeriod_ns;
    for (; run.load(std::memory_order_relaxed); next += kPeriod_ns) {
      const timespec at{.tv_sec = static_cast<time_t>(next / 1'000'000'000),
                        .tv_nsec = static_cast<long>(next % 1'000'000'000)};
      clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
      const std::int64_t behind = monotonic_ns() - next;
      late->add(behind);
      missed += static_cast<std::uint64_t>(behind / kPeriod_ns);
      next += behind / kPeriod_ns * kPeriod_ns;
    }
  });
  const std::int64_t begin = monotonic_ns();
  wait(seconds, interrupt, nullptr);
  run = false;
  loop.join();
  made.times.seconds = seconds_of(static_cast<std::uint64_t>(monotonic_ns() - begin));
  made.times.ticks = late->count();
  made.times.missed = missed;
  take_wake(made.times, *late);
  return made;
}

}  // namespace hapticd::daemon
