#include "control/motion/sense.h"

#include <cmath>

#include "control/motion/estimators.h"
#include "control/motion/homing.h"

namespace hapticd::control {
namespace {

/// Brings a difference of two values in [0, modulus) into [-modulus/2, modulus/2). Modulus 0 leaves
/// it as it is.
double wrap(double difference, double modulus) noexcept {
  const double half = 0.5 * modulus;
  if (difference >= half) return difference - modulus;
  if (difference < -half) return difference + modulus;
  return difference;
}

/// One axis in an unusual tick: the first one, a sample that is missing, not a number, too far
/// away, or over a gap.
class Unusual {
 public:
  Unusual(const Plan& plan, State& state, std::uint16_t index, Findings& findings) noexcept
      : plan_(plan.axes[index]),
        rate_Hz_(plan.rate_Hz),
        axis_(state.axes[index]),
        ledger_(state.ledger[index]),
        q_(state.q[index]),
        qd_(state.qd[index]),
        index_(index),
        driven_(state.axes[index].homed || state.mode == Mode::homing),
        findings_(findings) {}

  void sense(const AxisSample& sample, std::int64_t missed_ticks,
             std::uint32_t max_stale_ticks) noexcept {
    if (sample.freshness == Freshness::first) axis_.seeded = false;
    if (sample.freshness < Freshness::fresh) {
      hold(max_stale_ticks);
    } else if (!std::isfinite(sample.raw)) {
      hold(~0u);
      findings_.report({.code = Fault::input_not_finite, .axis = index_, .found = sample.raw});
    } else if (!axis_.seeded) {
      seed(sample.raw);
    } else {
      advance(sample.raw, missed_ticks);
    }
  }

 private:
  void move(double raw, double counts) noexcept {
    axis_.raw = raw;
    axis_.counts = counts;
    axis_.unwrapped += counts;
    axis_.stale_ticks = 0;
    q_ = plan_.unit_per_raw * axis_.unwrapped + (plan_.offset + axis_.zero);
  }

  void seed(double raw) noexcept {
    axis_.seeded = axis_.homed = true;  // home() knows better where there is something to find
    axis_.unwrapped = axis_.zero = 0;
    ledger_.known = false;
    move(raw, wrap(raw, plan_.modulus_raw));
    axis_.motion = Motion::reseeded;
    qd_ = 0;
  }

  void hold(std::uint32_t max_stale_ticks) noexcept {
    if (!axis_.seeded) {
      findings_.ready = false;
      return;
    }
    axis_.motion = Motion::held;
    ++axis_.stale_ticks;
    axis_.still_ticks = 0;  // nothing is known about the encoder: the stuck watch starts anew
    findings_.limits.set(Limit::sample_held);
    if (axis_.stale_ticks <= max_stale_ticks) return;
    findings_.report({.code = Fault::sample_missing,
                      .axis = index_,
                      .found = static_cast<double>(axis_.stale_ticks),
                      .allowed = static_cast<double>(max_stale_ticks)});
  }

  /// No velocity is taken over a gap, but each of its ticks may have moved the axis so much
  /// further.
  void advance(double raw, std::int64_t missed_ticks) noexcept {
    const double ticks = 1 + static_cast<double>(missed_ticks) + axis_.stale_ticks;
    const double counts = wrap(raw - axis_.raw, plan_.modulus_raw);
    const double moved = std::abs(plan_.unit_per_raw * counts);
    move(raw, counts);
    const bool jumped = moved > plan_.max_step * ticks;
    axis_.motion = ticks > 1 || jumped ? Motion::reseeded : Motion::advanced;
    qd_ = ticks > 1 ? 0 : plan_.unit_per_raw * counts * rate_Hz_;
    if (ticks > 1) findings_.limits.set(Limit::reseeded);
    if (jumped) ledger_.known = false;  // nothing real went so far: it did no work
    if (!driven_) return;  // nobody drives it yet, and a device that finds its zero may jump
    if (jumped) {
      findings_.report({.code = Fault::encoder_jump,
                        .axis = index_,
                        .found = moved,
                        .allowed = plan_.max_step * ticks});
    } else if (std::abs(qd_) > plan_.max_velocity) {
      findings_.report({.code = Fault::velocity,
                        .axis = index_,
                        .found = std::abs(qd_),
                        .allowed = plan_.max_velocity});
    }
  }

  const AxisPlan& plan_;
  const double rate_Hz_;
  AxisState& axis_;
  LedgerState& ledger_;
  double& q_;
  double& qd_;
  const std::uint16_t index_;
  const bool driven_;
  Findings& findings_;
};

/// The everyday tick: fresh after fresh, and not further than the velocity limit allows in one
/// period. That comparison also stands for "a number" and "no jump": where it fails, Unusual finds
/// out why. False: nothing was touched.
bool sense_usual(const AxisPlan& plan, double rate_Hz, const AxisSample& sample, AxisState& axis,
                 double& q, double& qd) noexcept {
  const double counts = wrap(sample.raw - axis.raw, plan.modulus_raw);
  const double velocity = plan.unit_per_raw * counts * rate_Hz;
  const bool usual = sample.freshness == Freshness::fresh && axis.seeded && axis.stale_ticks == 0 &&
                     std::abs(velocity) <= plan.max_velocity;
  if (!usual) return false;
  axis.raw = sample.raw;
  axis.counts = counts;
  axis.unwrapped += counts;
  axis.motion = Motion::advanced;
  q = plan.unit_per_raw * axis.unwrapped + (plan.offset + axis.zero);
  qd = velocity;
  return true;
}

void watch_stuck(const Plan& plan, State& state, const TickInput& input,
                 Findings& findings) noexcept {
  for (const StuckWatch& watch : plan.stuck_watches) {
    AxisState& axis = state.axes[watch.axis];
    const bool pushed = std::abs(input.delivered[watch.axis]) >= watch.min_effort;
    axis.still_ticks =
        pushed && axis.counts == 0 && axis.stale_ticks == 0 ? axis.still_ticks + 1 : 0;
    if (axis.still_ticks <= watch.ticks) continue;
    findings.report({.code = Fault::encoder_stuck,
                     .axis = watch.axis,
                     .found = static_cast<double>(axis.still_ticks) * plan.period_s,
                     .allowed = static_cast<double>(watch.ticks) * plan.period_s});
  }
}

[[gnu::cold]] void sense_unusual(const Plan& plan, State& state, const TickInput& input,
                                 std::size_t index, Findings& findings) noexcept {
  std::size_t device = 0;
  while (index >= std::size_t{plan.devices[device].first_axis} + plan.devices[device].axes)
    ++device;
  Unusual(plan, state, static_cast<std::uint16_t>(index), findings)
      .sense(input.axes[index], input.missed_ticks, plan.devices[device].max_stale_ticks);
}

}  // namespace

void sense(const Plan& plan, State& state, const TickInput& input, Findings& findings) noexcept {
  const bool gap = input.missed_ticks != 0;
  const std::span<const AxisPlan> plans = plan.axes;
  const std::span<const AxisSample> samples = input.axes;
  const std::span<AxisState> axes = state.axes;
  const std::span<double> q = state.q, qd = state.qd;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const bool done = !gap && sense_usual(plans[i], plan.rate_Hz, samples[i], axes[i], q[i], qd[i]);
    if (!done) sense_unusual(plan, state, input, i, findings);
  }
  watch_stuck(plan, state, input, findings);
  if (!plan.homings.empty()) home(plan, state, input, findings);
  estimate_velocity(plan, state);
}

}  // namespace hapticd::control
