// What a tick of a CAN device may cost: no heap, so many system calls, and that for a very long time.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/drivers/can_configs.h"
#include "tests/drivers/can_rig.h"
#include "tests/drivers/system_calls.h"
#include "tests/support/heap_guard.h"

namespace hapticd::test {
namespace {

using control::Mode;

class CanCost : public testing::TestWithParam<Bus> {};

std::string cost_name(const testing::TestParamInfo<Bus>& info) {
  return std::string(info.param.driver) + "_" + info.param.timing;
}
INSTANTIATE_TEST_SUITE_P(All, CanCost, testing::ValuesIn(kBuses), cost_name);

Emulation fine_torque() {
  Emulation emulation;
  emulation.cia402.rated_torque_Nm = 0.1;
  return emulation;
}

/// One exchange of the device, its bus moving between the calls.
struct Calls {
  long heap = 0, sends = 0, receives = 0;
};
Calls exchange(CanRig& rig) {
  std::array<AxisSample, 1> samples{};
  std::array<double, 1> effort{0.1}, delivered{};
  Aux aux;
  Calls calls;
  const auto counted = [&](auto call) {
    const SystemCalls before = system_calls();
    const HeapGuard guard;
    call();
    calls.heap += guard.calls();
    calls.sends += system_calls().sends - before.sends;
    calls.receives += system_calls().receives - before.receives;
  };
  const drivers::TickTime time = rig.begin_tick();
  counted([&] { rig.device().request(time); });
  if (rig.compiled().can[0]->timing == drivers::Timing::in_phase) rig.pass(450'000);
  counted([&] { (void)rig.device().collect(samples, aux); });
  counted([&] { rig.device().command(effort, delivered); });
  rig.end_tick();
  EXPECT_EQ(samples[0].freshness, Freshness::fresh);
  EXPECT_TRUE(aux.armed);
  return calls;
}

TEST_P(CanCost, NoHeapAndFewSystemCallsInATick) {
  CanRig rig(wall_on(GetParam()), fine_torque());
  ASSERT_TRUE(rig.connect());
  ASSERT_TRUE(rig.enable()) << rig.fault_text();
  const bool in_phase = std::string(GetParam().timing) == "in_phase";
  for (int i = 0; i < 100; ++i) {
    const Calls calls = exchange(rig);
    if (HeapGuard::available()) {
      EXPECT_EQ(calls.heap, 0);
    }
    EXPECT_EQ(calls.sends, in_phase ? 2 : 1) << "questions, torques";
    EXPECT_LE(calls.receives, in_phase ? 2 : 1);
  }
}

/// A million ticks of each, a bus that is not perfect, drives whose clocks run off: nothing wears out. A tenth of that in
/// every run, the rest with HAPTICD_LONG.
TEST_P(CanCost, AMillionTicks) {
  const bool whole = std::getenv("HAPTICD_LONG") != nullptr;
#ifdef HAPTICD_SANITIZED
  constexpr int kUsual = 20'000;
#else
  constexpr int kUsual = 100'000;
#endif
  const int ticks = whole ? 1'000'000 : kUsual;
  Emulation emulation = fine_torque();
  emulation.wire = {.loss = 1e-4, .duplicate = 1e-3, .jitter_s = 20e-6};
  emulation.odrive.clock_drift = 80e-6;
  emulation.cia402.clock_drift = -80e-6;
  emulation.step_s = 500e-6;
  CanRig rig(wall_on(GetParam()), emulation);
  ASSERT_TRUE(rig.connect());
  ASSERT_TRUE(rig.enable()) << rig.fault_text();
  int held = 0;
  for (int i = 0; i < ticks; ++i) {
    ASSERT_EQ(rig.tick().mode, Mode::enabled) << i << " " << rig.fault_text();
    held += rig.cycle().output().limits.has(Limit::sample_held) ? 1 : 0;
    ASSERT_TRUE(std::isfinite(rig.motor_Nm()));
    ASSERT_LT(std::abs(rig.motor_Nm()), 0.0637) << "more than 8 N";
  }
  EXPECT_LT(held, ticks / 500);
  EXPECT_EQ(rig.device().traffic()->not_sent.load(), 0U);
  EXPECT_NEAR(rig.drives().body().position(0), -1.0 / 300, 1e-4);
}

}  // namespace
}  // namespace hapticd::test
