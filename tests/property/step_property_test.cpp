// Invariants of the tick, over random devices, scenes and inputs: whatever comes in, what goes out
// is bounded.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using test::Rig;

rc::Gen<double> any_double() {
  return rc::gen::map(rc::gen::arbitrary<std::uint64_t>(), [](std::uint64_t bits) {
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  });
}

/// Mostly near places where things happen, sometimes anything at all.
rc::Gen<double> raw_value() {
  return rc::gen::weightedOneOf<double>(
      {{8, rc::gen::map(rc::gen::inRange(-20000, 20000),
                        [](int counts) { return counts < 0 ? counts + 4294967296.0 : counts; })},
       {1, any_double()},
       {1, rc::gen::element(std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::denorm_min(), -0.0, 1e308)}});
}

build::ProgramSpec random_spec() {
  const auto axes = *rc::gen::inRange<std::size_t>(1, 4);
  auto spec = test::spec_of(axes);
  spec.devices[0].max_slew = *rc::gen::element(0.01, 0.5, 100.0);
  spec.axes[0].max_effort = *rc::gen::element(0.5, 12.0);
  for (int i = *rc::gen::inRange(0, 4); i > 0; --i) {
    PlaneContact plane = test::wall(std::pow(10.0, *rc::gen::inRange(0, 7)),
                                    *rc::gen::element(0.0, 1.0, 100.0), axes);
    plane.normal = {0, 0, 0};
    plane.normal[*rc::gen::inRange<std::size_t>(0, axes)] = *rc::gen::element(-1.0, 1.0);
    plane.offset = 1e-3 * *rc::gen::inRange(-10, 10);
    spec.planes.push_back(plane);
  }
  return spec;
}

void random_tick(Rig& rig) {
  for (AxisSample& sample : rig.samples) {
    sample.raw = *raw_value();
    sample.freshness = *rc::gen::weightedElement<Freshness>(
        {{10, Freshness::fresh}, {1, Freshness::missing}, {1, Freshness::repeated}});
  }
  rig.input.missed_ticks = *rc::gen::weightedElement<std::int64_t>({{10, 0}, {1, 1}, {1, 1000000}});
  rig.input.enable = *rc::gen::weightedElement<bool>({{9, true}, {1, false}});
  rig.input.clear_fault = *rc::gen::arbitrary<bool>();
  rig.input.host_fault.code =
      *rc::gen::weightedElement<Fault>({{20, Fault::none}, {1, Fault::estop}, {1, Fault::overrun}});
}

RC_GTEST_PROP(Step, AnyInputGivesAFiniteOutputInsideEveryLimit, ()) {
  Rig rig(random_spec());
  std::vector<double> last(rig.program.plan().axes.size(), 0.0);
  for (int tick = *rc::gen::inRange(1, 60); tick > 0; --tick) {
    random_tick(rig);
    const TickOutput output = rig.run();
    double square = 0, change = 0;
    for (std::size_t i = 0; i < last.size(); ++i) {
      RC_ASSERT(std::isfinite(output.effort[i]));
      RC_ASSERT(std::abs(output.effort[i]) <= rig.program.plan().axes[i].max_effort);
      square += output.effort[i] * output.effort[i];
      change += (rig.program.state().force[i] - last[i]) * (rig.program.state().force[i] - last[i]);
      last[i] = rig.program.state().force[i];
      if (output.mode != Mode::enabled) RC_ASSERT(output.effort[i] == 0.0);
    }
    RC_ASSERT(std::sqrt(square) <= rig.program.plan().devices[0].max_force * (1 + 1e-12));
    if (output.mode == Mode::enabled)
      RC_ASSERT(std::sqrt(change) <= rig.program.plan().devices[0].max_slew * (1 + 1e-9));
    if (rig.input.host_fault.code != Fault::none && rig.input.enable)
      RC_ASSERT(output.mode == Mode::fault);
  }
}

RC_GTEST_PROP(Step, EmptySceneGivesExactlyZeroForce, ()) {
  auto spec = random_spec();
  spec.planes.clear();
  Rig rig(spec);
  for (int tick = 0; tick < 30; ++tick) {
    random_tick(rig);
    for (const double effort : rig.run().effort) RC_ASSERT(effort == 0.0);
  }
}

RC_GTEST_PROP(Step, SamePlanAndInputGiveTheSameBits, ()) {
  const auto spec = random_spec();
  Rig a(spec), b(spec);
  for (int tick = 0; tick < 30; ++tick) {
    random_tick(a);
    b.samples = a.samples;
    b.input.missed_ticks = a.input.missed_ticks;
    b.input.enable = a.input.enable;
    b.input.clear_fault = a.input.clear_fault;
    b.input.host_fault = a.input.host_fault;
    b.input.axes = b.samples;
    const TickOutput x = a.run(), y = b.run();
    RC_ASSERT(std::memcmp(x.effort.data(), y.effort.data(), x.effort.size_bytes()) == 0);
    RC_ASSERT(x.limits.bits() == y.limits.bits());
  }
}

/// The unwrap never drifts: a random walk over many turns of a small counter ends at the sum of its
/// steps.
RC_GTEST_PROP(Step, UnwrapFollowsAnyWalkBelowHalfATurn, ()) {
  auto spec = test::spec_of(1);
  const int modulus = 1 << *rc::gen::inRange(4, 20);
  spec.axes[0].modulus_raw = modulus;
  Rig rig(spec);
  std::int64_t position = 0;
  rig.samples[0].raw = 0;
  rig.again();
  for (int tick = 0; tick < 200; ++tick) {
    position += *rc::gen::inRange(-modulus / 2, modulus / 2);
    rig.samples[0].raw = static_cast<double>(((position % modulus) + modulus) % modulus);
    rig.again();
    RC_ASSERT(rig.program.state().axes[0].unwrapped == static_cast<double>(position));
  }
}

}  // namespace
}  // namespace hapticd::control
