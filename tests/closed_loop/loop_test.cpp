// Claims about loop and simulated device together that need no paper.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/support/closed_loop.h"
#include "tests/support/generators.h"
#include "tests/support/heap_guard.h"

namespace hapticd::test {
namespace {

RC_GTEST_PROP(Loop, EmptySceneGivesZeroForce, ()) {
  sim::DeviceOptions device = one_axis_device(any_number(0.01, 0.5), any_number(0, 2));
  device.axes[0].noise_counts = any_number(0, 1e6);
  device.hand = {
      .mass_kg = any_number(0, 1),
      .stiffness_N_m = any_number(0, 1000),
      .damping_Ns_m = any_number(0, 5),
      .script = {{.at_s = 0, .force_N = any_number(-5, 5), .position_m = any_number(-0.1, 0.1)},
                 {.at_s = 0.1, .force_N = any_number(-5, 5), .position_m = any_number(-0.1, 0.1)}}};
  ClosedLoop loop(device, {});
  for (int i = 0; i < 200; ++i) {
    loop.run();
    RC_ASSERT(loop.effort_N() == 0);
    RC_ASSERT(loop.device().truth(0).effort_N == 0);
  }
  RC_ASSERT(loop.cycle().output().mode == control::Mode::enabled);
}

// Everything that can differ between runs switched on at once.
std::vector<std::byte> recorded_run(std::uint64_t seed) {
  sim::DeviceOptions device = one_axis_device(0.05, 0.5);
  device.seed = seed;
  device.axes[0].counts_per_m = 163840;
  device.axes[0].noise_counts = 1.5;
  device.axes[0].coulomb_N = 0.05;
  device.axes[0].delay_s = 0.00037;
  device.axes[0].dac_step_N = 0.01;
  device.axes[0].max_effort_N = 8;
  device.hand = {.mass_kg = 0.2,
                 .stiffness_N_m = 300,
                 .damping_Ns_m = 2,
                 .script = {{.at_s = 0.5, .force_N = 2, .position_m = 0.01}}};
  ClosedLoop loop(device, {.stiffness_N_m = 600, .damping_Ns_m = 0.1});
  const std::size_t bytes = loop.program().plan().record.bytes;
  std::vector<std::byte> storage(bytes * 4), result;
  rt::SpscRing ring(storage, bytes);
  loop.ring = &ring;
  for (int i = 0; i < 1000; ++i) {
    loop.run(i % 97 == 0 ? 2 : 0);
    const std::byte* record = ring.front();
    result.insert(result.end(), record, record + bytes);
    ring.pop();
  }
  return result;
}

TEST(Loop, SameOptionsAndSeedGiveTheSameBits) {
  EXPECT_EQ(recorded_run(1), recorded_run(1));
}
TEST(Loop, AnotherSeedGivesOtherBits) {
  EXPECT_NE(recorded_run(1), recorded_run(2));
}

TEST(Loop, NeverCallsTheHeap) {
  if (!HeapGuard::available()) GTEST_SKIP() << "heap calls cannot be counted under this sanitizer";
  sim::DeviceOptions device = one_axis_device(0.05, 0.5);
  device.axes[0].noise_counts = 1;
  device.axes[0].delay_s = 0.0017;
  device.hand.script = {{.at_s = 0.1, .force_N = 5, .position_m = 0}};
  device.failures = {
      {.kind = sim::FailureKind::nan, .axis = 0, .at_s = 0.5, .for_s = 0.1, .size_m = 0}};
  ClosedLoop loop(device, {.stiffness_N_m = 400, .damping_Ns_m = 0.1});
  const std::size_t bytes = loop.program().plan().record.bytes;
  std::vector<std::byte> storage(bytes * 4);
  rt::SpscRing ring(storage, bytes);
  loop.ring = &ring;
  const HeapGuard guard;
  for (int i = 0; i < 1000; ++i) {
    loop.run();
    ring.pop();
  }
  EXPECT_EQ(guard.calls(), 0);
  EXPECT_EQ(loop.cycle().output().mode, control::Mode::fault) << "the fault path was not run";
}

TEST(Loop, MissedTicksHoldTheForceAndAreNoFault) {
  sim::DeviceOptions device = one_axis_device(0.1, 1);
  device.hand.script = {{.at_s = 0, .force_N = 2, .position_m = 0}};
  ClosedLoop loop(device, {.stiffness_N_m = 400, .damping_Ns_m = 0.1});
  while (loop.tick() < 20) loop.run();
  const double held_N = loop.effort_N();
  const double work_J = loop.device().truth(0).effort_work_J;
  const double before_m = loop.device().truth(0).position_m;
  ASSERT_LT(held_N, -0.01);
  loop.run(3);
  EXPECT_EQ(loop.tick(), 24);
  EXPECT_EQ(loop.device().truth(0).effort_N, held_N);
  const double moved_m = loop.device().truth(0).position_m - before_m;
  EXPECT_NEAR(loop.device().truth(0).effort_work_J - work_J, held_N * moved_m,
              1e-12 * std::abs(held_N * moved_m));
  EXPECT_EQ(loop.cycle().output().mode, control::Mode::enabled);
}

}  // namespace
}  // namespace hapticd::test
