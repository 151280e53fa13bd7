// The passivity controller against scenes made to be active, and the ledger against the work that a
// simulated mass really gets.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using test::Rig;

constexpr double kCounts = 1e9;  // per metre: quantisation out of the way
constexpr int kSubsteps = 20;

/// A mass with a damper, held by a springy hand, under an effort that comes `delay` ticks late.
struct Mass {
  double mass = 0.1, damping = 1;
  double hand_stiffness = 100, hand_rest = -0.005;
  std::size_t delay = 0;
  double x = 1e-3, v = 0;
  std::deque<double> efforts{};

  double work = 0;        ///< J: of the effort, over the last tick
  double dissipated = 0;  ///< J: least that the damper took in it, (b/T) dx^2

  void run(double effort) {
    efforts.push_front(effort);
    const double held = efforts.size() > delay ? efforts[delay] : 0;
    const double from = x;
    for (int i = 0; i < kSubsteps; ++i) {
      const double h = 1e-3 / kSubsteps;
      v += h / mass * (held - damping * v - hand_stiffness * (x - hand_rest));
      x += h * v;
    }
    work = held * (x - from);
    dissipated = damping * (x - from) * (x - from) * 1e3;
  }
};

build::ProgramSpec spec(const PlaneContact& plane, const Mass& mass) {
  auto spec = test::spec_of(1);
  spec.axes[0].unit_per_raw = 1 / kCounts;
  spec.axes[0].modulus_raw = 0;
  spec.axes[0].max_effort = spec.devices[0].max_force = spec.devices[0].max_slew = 1e6;
  spec.axes[0].max_velocity = spec.axes[0].max_step = 1e6;
  spec.axes[0].min_damping = mass.damping;
  spec.axes[0].delay_ticks = static_cast<std::uint16_t>(mass.delay);
  spec.planes = {plane};
  return spec;
}

TickOutput tick(Rig& rig, const Mass& mass) {
  rig.samples[0].raw = std::round(mass.x * kCounts);
  return rig.again();
}

struct Outcome {
  double worst_excess = -1e300;  ///< J: net energy given out beyond budget and one tick's work
  double speed = 0;              ///< m/s: largest in the last tenth of the run
  bool weakened = false;
  bool gain_in_range = true;
  double worst_reserve = -1e300;  ///< J: reserve beyond the stored energy and the budget
};

Outcome run(const PlaneContact& plane, Mass mass, const PassivityPlan* controller, int ticks) {
  auto made = spec(plane, mass);
  if (controller != nullptr) made.passivity_controllers = {*controller};
  Rig rig(made);
  rig.input.enable = true;
  Outcome outcome;
  double net = 0, last_ticks = 0;  // the most that the ticks until a force has ended ever gave
  std::deque<double> recent;
  const double budget = controller != nullptr ? controller->budget : 0;
  const double credit = controller != nullptr ? controller->credit : 0;
  for (int k = 0; k < ticks; ++k) {
    const TickOutput output = tick(rig, mass);
    outcome.weakened = outcome.weakened || output.limits.has(Limit::passivity);
    if (controller != nullptr) {
      const double gain = rig.program.state().gain[0], depth = std::max(0.0, -mass.x);
      outcome.gain_in_range = outcome.gain_in_range && gain >= 0 && gain <= 1;
      outcome.worst_reserve =
          std::max(outcome.worst_reserve, rig.program.state().reserve[0] - budget -
                                              gain * 0.5 * plane.stiffness * depth * depth);
    }
    mass.run(output.effort[0]);
    net += mass.work - credit * mass.dissipated;
    recent.push_front(std::max(0.0, mass.work));
    if (recent.size() > mass.delay + 1) recent.pop_back();
    last_ticks = std::max(last_ticks, std::accumulate(recent.begin(), recent.end(), 0.0));
    outcome.worst_excess = std::max(outcome.worst_excess, net - budget - last_ticks);
    if (10 * k > 9 * ticks) outcome.speed = std::max(outcome.speed, std::abs(mass.v));
  }
  return outcome;
}

RC_GTEST_PROP(PassivityController, NetEnergyOutStaysBelowBudgetAndOneTicksWork, ()) {
  PlaneContact plane = test::wall(std::pow(10.0, *rc::gen::inRange(0, 450) / 100.0),
                                  *rc::gen::inRange(-2000, 500) / 100.0);
  Mass mass;
  mass.mass = *rc::gen::element(0.02, 0.1, 0.5);
  mass.damping = *rc::gen::element(0.0, 0.2, 1.0, 3.0);
  mass.hand_stiffness = *rc::gen::element(0.0, 50.0, 500.0);
  mass.delay = *rc::gen::inRange<std::size_t>(0, 4);
  mass.v = *rc::gen::element(0.0, -0.3, -1.0);
  const PassivityPlan controller{.budget = *rc::gen::element(1e-4, 2e-3, 0.1),
                                 .credit = *rc::gen::element(0.0, 0.5, 0.95),
                                 .leak = *rc::gen::element(0.0, 1e-3),
                                 .rise = *rc::gen::element(0.002, 0.1, 1.0)};
  const Outcome outcome = run(plane, mass, &controller, 3000);
  // What is left is the encoder: half a count times the force, tick after tick.
  RC_ASSERT(outcome.worst_excess <= 1e-5);
  RC_ASSERT(outcome.gain_in_range);
  RC_ASSERT(outcome.worst_reserve <= 1e-5);
}

TEST(PassivityController, TheScenesAreActiveWithoutIt) {
  Mass mass;
  mass.damping = 1.37;
  const PlaneContact negative = test::wall(1000, -20);
  EXPECT_GT(run(negative, mass, nullptr, 3000).worst_excess, 0.1);
  mass.delay = 1;
  EXPECT_GT(run(test::wall(6000, 0), mass, nullptr, 3000).worst_excess, 0.1);
}

/// A wall of 20 000 N/m on a device that stands 2740 N/m, and 6000 N/m with a tick of delay: the
/// controller weakens them until they are quiet.
TEST(PassivityController, AWallFarTooStiffComesToRest) {
  const PassivityPlan controller{.budget = 2e-3, .credit = 0.5, .leak = 0, .rise = 0.002};
  Mass mass;
  mass.damping = 1.37;
  for (const std::size_t delay : {0u, 1u}) {
    mass.delay = delay;
    const PlaneContact plane = test::wall(delay == 0 ? 20000 : 6000, 0);
    EXPECT_GT(run(plane, mass, nullptr, 20000).speed, 0.05) << "or there is nothing to tame";
    const Outcome outcome = run(plane, mass, &controller, 20000);
    EXPECT_LT(outcome.speed, 1e-3);
    EXPECT_TRUE(outcome.weakened);
  }
}

TEST(PassivityController, LeavesAWallAloneThatItsCreditPaysFor) {
  const PassivityPlan controller{.budget = 2e-3, .credit = 0.95, .leak = 0, .rise = 0.01};
  Mass mass;
  mass.damping = 1.37;
  EXPECT_FALSE(run(test::wall(2000, 0), mass, &controller, 5000).weakened);
}

/// Without delay the booked work is that of the simulated mass, whatever the scene does.
RC_GTEST_PROP(Ledger, EqualsTheWorkOnASimulatedMass, ()) {
  Mass mass;
  mass.delay = *rc::gen::inRange<std::size_t>(0, 5);
  mass.v = -0.5;
  mass.damping = *rc::gen::element(0.2, 1.37);
  auto made = spec(test::wall(*rc::gen::element(300.0, 3000.0), *rc::gen::element(0.0, 2.0)), mass);
  made.axes[0].unit_per_raw = 1e-15;
  Rig rig(made);
  rig.input.enable = true;
  double work = 0, throughput = 0;
  for (int k = 0; k < 2000; ++k) {
    rig.samples[0].raw = mass.x * 1e15;
    const TickOutput output = rig.again();
    mass.run(output.effort[0]);
    work += mass.work;
    throughput += std::abs(mass.work);
  }
  rig.samples[0].raw = mass.x * 1e15;
  rig.again();
  RC_ASSERT(throughput > 1e-3);
  RC_ASSERT(std::abs(rig.program.state().work[0] - work) <= 1e-9 * throughput);
}

}  // namespace
}  // namespace hapticd::control
