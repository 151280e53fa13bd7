// Invariants of the tick, over random devices, scenes and inputs: whatever comes in, what goes out
// is bounded.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/support/full_program.h"

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

/// Everything that a plan can name, some of it left out.
build::ProgramSpec random_full_spec() {
  auto spec = test::full_spec();
  const auto sometimes = [](auto& entries) {
    if (*rc::gen::inRange(0, 4) == 0) entries.clear();
  };
  sometimes(spec.low_passes);
  sometimes(spec.least_squares);
  sometimes(spec.foaws);
  sometimes(spec.alpha_beta_gammas);
  sometimes(spec.homings);
  sometimes(spec.force_sensors);
  sometimes(spec.axis_observers);
  sometimes(spec.contact_observers);
  sometimes(spec.gravity_axes);
  sometimes(spec.gravity_tips);
  sometimes(spec.frictions);
  sometimes(spec.travels);
  sometimes(spec.thermals);
  sometimes(spec.power_limits);
  sometimes(spec.workspaces);
  sometimes(spec.passivity_controllers);
  sometimes(spec.planes);
  spec.devices[0].max_slew = *rc::gen::element(0.01, 0.5, 100.0);
  return spec;
}

/// `calm`: every axis moves a little, as a hand would move it, so that forces stay on.
void random_tick(Rig& rig, bool calm = false) {
  for (AxisSample& sample : rig.samples) {
    sample.raw = calm ? sample.raw + *rc::gen::inRange(-300, 300) : *raw_value();
    sample.homed = calm || *rc::gen::weightedElement<bool>({{9, true}, {1, false}});
    sample.freshness = *rc::gen::weightedElement<Freshness>(
        {{calm ? 100 : 10, Freshness::fresh}, {1, Freshness::missing}, {1, Freshness::repeated}});
  }
  for (Aux& aux : rig.aux) {
    aux.digital = calm ? 1 : *rc::gen::weightedElement<std::uint32_t>({{9, 1}, {1, 0}, {1, 3}});
    for (double& channel : aux.analogue)
      channel = *rc::gen::weightedOneOf<double>(
          {{9, rc::gen::element(0.0, 1.0, -5.0)}, {1, any_double()}});
  }
  rig.input.missed_ticks = *rc::gen::weightedElement<std::int64_t>({{10, 0}, {1, 1}, {1, 1000000}});
  rig.input.enable = *rc::gen::weightedElement<bool>({{9, true}, {1, false}});
  rig.input.clear_fault = *rc::gen::arbitrary<bool>();
  rig.input.host_fault.code =
      calm ? Fault::none
           : *rc::gen::weightedElement<Fault>(
                 {{20, Fault::none}, {1, Fault::estop}, {1, Fault::overrun}});
}

double norm_of(std::span<const double> values, const DevicePlan& device) {
  double square = 0;
  for (std::size_t i = 0; i < device.coordinates; ++i)
    square += values[device.first_coordinate + i] * values[device.first_coordinate + i];
  return std::sqrt(square);
}

void expect_inside_every_limit(const Rig& rig, const TickOutput& output,
                               const std::vector<double>& last) {
  const Plan& plan = rig.program.plan();
  const State& state = rig.program.state();
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    RC_ASSERT(std::isfinite(output.effort[i]));
    RC_ASSERT(std::abs(output.effort[i]) <= plan.axes[i].max_effort);
    if (output.mode != Mode::enabled) RC_ASSERT(output.effort[i] == 0.0);
  }
  std::vector<double> change(state.slewed.begin(), state.slewed.end());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= last[i];
  for (std::size_t d = 0; d < plan.devices.size(); ++d) {
    RC_ASSERT(norm_of(state.force, plan.devices[d]) <= plan.devices[d].max_force * (1 + 1e-12));
    if (output.mode == Mode::enabled)
      RC_ASSERT(norm_of(change, plan.devices[d]) <= plan.devices[d].max_slew * (1 + 1e-9));
  }
  for (const PowerLimit& limit : plan.power_limits) {
    double power = 0;
    for (std::size_t i = 0; i < plan.devices[limit.device].axes; ++i)
      power += output.effort[i] * state.qd[i];
    RC_ASSERT(power <= limit.max_W * (1 + 1e-9));
  }
  for (const double heat : state.heat) RC_ASSERT(heat >= 0 && heat <= 1 + 1e-3);
}

void any_input(build::ProgramSpec spec) {
  Rig rig(std::move(spec));
  const bool calm = *rc::gen::arbitrary<bool>();
  std::vector<double> last(rig.program.plan().coordinates, 0.0);
  for (int tick = *rc::gen::inRange(1, 60); tick > 0; --tick) {
    random_tick(rig, calm);
    const TickOutput output = rig.run();
    expect_inside_every_limit(rig, output, last);
    last.assign(rig.program.state().slewed.begin(), rig.program.state().slewed.end());
    if (rig.input.host_fault.code != Fault::none && rig.input.enable)
      RC_ASSERT(output.mode == Mode::fault);
  }
}

RC_GTEST_PROP(Step, AnyInputGivesAFiniteOutputInsideEveryLimit, ()) {
  any_input(random_spec());
}

RC_GTEST_PROP(Step, AnyInputToEverythingAPlanCanNameGivesAFiniteOutputInsideEveryLimit, ()) {
  any_input(random_full_spec());
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
