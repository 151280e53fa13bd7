// Each kind of scripted failure, as the loop gets to see it.
#include <gtest/gtest.h>
#include <time.h>

#include <cmath>

#include "bench_device.h"

namespace hapticd::sim {
namespace {

/// Moves one count a tick from the tick after it was armed; fails in ticks 10, 11 and 12 on axis 0.
DeviceOptions failing(FailureKind kind) {
  DeviceOptions options = free_mass();
  options.axes[0].counts_per_m = 1e6;
  options.axes.push_back(options.axes[0]);
  options.failures = {{.kind = kind, .axis = 0, .at_s = 0.010, .for_s = 0.003, .size_m = 0.5}};
  return options;
}

class Failing : public BenchDevice {
 public:
  explicit Failing(FailureKind kind) : BenchDevice(failing(kind)) {
    device.set_armed(true);
    read();
    command(1);
    read();
    command(0);  // from here on 1e-3 m/s: one count a tick
  }
  /// Reads up to and with this tick.
  const AxisSample& read_tick(std::int64_t wanted) {
    while (tick < wanted) read();
    return samples[0];
  }
};

TEST(SimFailure, NanIsReportedAsFreshForItsTime) {
  Failing bench(FailureKind::nan);
  EXPECT_FALSE(std::isnan(bench.read_tick(9).raw));
  for (const std::int64_t tick : {10, 11, 12}) {
    EXPECT_TRUE(std::isnan(bench.read_tick(tick).raw));
    EXPECT_EQ(bench.samples[0].freshness, Freshness::fresh);
    EXPECT_FALSE(std::isnan(bench.samples[1].raw)) << "another axis";
  }
  EXPECT_FALSE(std::isnan(bench.read_tick(13).raw));
}

TEST(SimFailure, StuckRepeatsTheLastValueAndCallsItFresh) {
  Failing bench(FailureKind::stuck);
  const double last = bench.read_tick(9).raw;
  for (const std::int64_t tick : {10, 11, 12}) {
    EXPECT_EQ(bench.read_tick(tick).raw, last);
    EXPECT_EQ(bench.samples[0].freshness, Freshness::fresh);
  }
  EXPECT_EQ(bench.samples[1].raw, last + 3) << "another axis moves on";
  EXPECT_EQ(bench.read_tick(13).raw, last + 4) << "the plant moved on";
}

TEST(SimFailure, JumpReportsThatMuchTooMuch) {
  Failing bench(FailureKind::jump);
  const double last = bench.read_tick(9).raw;
  EXPECT_EQ(bench.read_tick(10).raw, last + 1 + 500'000);
  EXPECT_EQ(bench.samples[1].raw, last + 1);
  EXPECT_EQ(bench.read_tick(13).raw, last + 4);
}

TEST(SimFailure, MissingGivesNoSample) {
  Failing bench(FailureKind::missing);
  EXPECT_EQ(bench.read_tick(9).freshness, Freshness::fresh);
  for (const std::int64_t tick : {10, 11, 12}) {
    EXPECT_EQ(bench.read_tick(tick).freshness, Freshness::missing);
    EXPECT_EQ(bench.samples[1].freshness, Freshness::fresh);
  }
  EXPECT_EQ(bench.read_tick(13).freshness, Freshness::fresh);
}

TEST(SimFailure, DisarmDropsThePowerUntilItIsAskedForAgain) {
  Failing bench(FailureKind::disarm);
  bench.read_tick(9);
  EXPECT_TRUE(bench.aux.armed);
  bench.read_tick(10);
  EXPECT_FALSE(bench.aux.armed);
  EXPECT_EQ(bench.command(5), 0);
  bench.device.set_armed(true);
  bench.read_tick(12);
  EXPECT_FALSE(bench.aux.armed) << "too early";
  bench.read_tick(13);
  EXPECT_TRUE(bench.aux.armed);
  Failing alone(FailureKind::disarm);
  alone.read_tick(100);
  EXPECT_FALSE(alone.aux.armed) << "nobody asked";
}

TEST(SimFailure, FaultSaysThatTheDeviceCannotGoOn) {
  Failing bench(FailureKind::fault);
  bench.read_tick(9);
  EXPECT_FALSE(bench.aux.faulted);
  EXPECT_TRUE(bench.device.fault_text().empty());
  bench.read_tick(10);
  EXPECT_TRUE(bench.aux.faulted);
  EXPECT_FALSE(bench.device.fault_text().empty());
  bench.read_tick(13);
  EXPECT_FALSE(bench.aux.faulted);
}

std::int64_t processor_time_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

TEST(SimFailure, SlowBurnsItsProcessorTimeOnce) {
  Failing bench(FailureKind::slow);
  bench.read_tick(9);
  const std::int64_t before_ns = processor_time_ns();
  bench.read_tick(10);
  EXPECT_GE(processor_time_ns() - before_ns, 3'000'000);
  const std::int64_t after_ns = processor_time_ns();
  bench.read_tick(13);
  EXPECT_LT(processor_time_ns() - after_ns, 3'000'000) << "burnt again";
}

TEST(SimFailure, SlowIsNotLostInMissedTicks) {
  Failing bench(FailureKind::slow);
  bench.read_tick(5);
  const std::int64_t before_ns = processor_time_ns();
  bench.read(50);
  EXPECT_GE(processor_time_ns() - before_ns, 3'000'000);
}

TEST(SimFailure, WithoutDurationLastsOneTick) {
  DeviceOptions options = free_mass();
  options.failures = {
      {.kind = FailureKind::nan, .at_s = 0.3}};  // 0.3 / 0.001 is above 300 in binary
  BenchDevice bench(options);
  while (bench.tick < 299) ASSERT_FALSE(std::isnan(bench.read().raw));
  EXPECT_TRUE(std::isnan(bench.read().raw));
  EXPECT_FALSE(std::isnan(bench.read().raw));
}

TEST(SimFailure, HappensAgainAfterAnotherConnect) {
  Failing bench(FailureKind::nan);
  EXPECT_TRUE(std::isnan(bench.read_tick(10).raw));
  bench.connect();
  EXPECT_FALSE(std::isnan(bench.read_tick(9).raw));
  EXPECT_TRUE(std::isnan(bench.read_tick(10).raw));
}

}  // namespace
}  // namespace hapticd::sim
