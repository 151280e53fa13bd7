#include "control/motion/homing.h"

#include <algorithm>
#include <cmath>

#include "control/plan.h"
#include "control/state.h"
#include "control/step.h"

namespace hapticd::control {
namespace {

constexpr double kStillShare = 0.1;  // of the way at full search speed: less is standing still

/// Brings a value that wraps into [-modulus/2, modulus/2); modulus 0: it does not wrap.
double nearest_turn(double raw, double modulus) noexcept {
  return modulus > 0 ? raw - modulus * std::round(raw / modulus) : raw;
}

/// One axis that has something to find.
class Homing {
 public:
  Homing(const Plan& plan, State& state, const TickInput& input, std::size_t index) noexcept
      : homing_(plan.homings[index]),
        plan_(plan.axes[homing_.axis]),
        period_s_(plan.period_s),
        at_(state.homings[index]),
        axis_(state.axes[homing_.axis]),
        ledger_(state.ledger[homing_.axis]),
        q_(state.q[homing_.axis]),
        qd_(state.qd[homing_.axis]),
        sample_(input.axes[homing_.axis]) {}

  bool drivable() const noexcept { return homing_.effort != 0; }
  bool done() const noexcept { return at_.done; }

  /// What needs no search: the device's word, an index pulse that came by.
  void look(Findings& findings) noexcept {
    const bool fresh = axis_.motion != Motion::held;
    if (homing_.by == HomingBy::device && fresh && sample_.homed != at_.done) {
      if (at_.done) report(findings, 0);
      if (!at_.done) take_absolute();
      at_.done = sample_.homed;
    } else if (homing_.by == HomingBy::index && !at_.done && fresh && sample_.index &&
               std::isfinite(sample_.index_raw)) {
      const double back = nearest_turn(sample_.raw - sample_.index_raw, plan_.modulus_raw);
      refer(q_ - plan_.unit_per_raw * back);
    }
    axis_.homed = at_.done;
  }

  /// One tick of the search.
  void search(Findings& findings) noexcept {
    if (++at_.ticks > homing_.max_ticks) return report(findings, at_.ticks * period_s_);
    const double towards = (at_.turned ? -1 : 1) * std::copysign(1.0, homing_.effort);
    drive(towards);
    if (!stands_still()) return;
    at_.effort = 0;
    at_.still = 0;
    if (homing_.by == HomingBy::hard_stop) {
      refer(q_);
    } else if (at_.turned) {
      report(findings, at_.ticks * period_s_);  // from stop to stop, and no index between
    } else {
      at_.turned = true;
    }
    axis_.homed = at_.done;
  }

  void rest() noexcept {
    at_.effort = 0;
    at_.ticks = at_.still = 0;
    at_.turned = false;
    at_.from = q_;
  }

 private:
  /// Grows the effort while the axis is slower than half the search speed, takes it back where it is
  /// faster, and lets go at twice the speed.
  void drive(double towards) noexcept {
    const double speed = qd_ * towards;
    double effort = at_.effort * towards;
    if (speed < 0.5 * homing_.velocity) effort += homing_.effort_per_tick;
    if (speed > homing_.velocity) effort -= 2 * homing_.effort_per_tick;
    if (std::abs(qd_) > 2 * homing_.velocity) effort = 0;
    at_.effort = towards * std::clamp(effort, 0.0, std::abs(homing_.effort));
  }

  /// Under full effort for still_ticks, without having come further than a crawl.
  bool stands_still() noexcept {
    const double crawl = kStillShare * homing_.velocity * period_s_ * homing_.still_ticks;
    if (std::abs(at_.effort) < std::abs(homing_.effort) || std::abs(q_ - at_.from) > crawl) {
      at_.from = q_;
      at_.still = 0;
      return false;
    }
    return ++at_.still >= homing_.still_ticks;
  }

  /// The device's raw value is absolute from now on.
  void take_absolute() noexcept {
    axis_.unwrapped = nearest_turn(sample_.raw, plan_.modulus_raw);
    axis_.zero = 0;
    shift(plan_.unit_per_raw * axis_.unwrapped + plan_.offset - q_);
  }

  /// What is `reference` in q as counted so far is homing.position.
  void refer(double reference) noexcept {
    axis_.zero += homing_.position - reference;
    shift(homing_.position - reference);
    at_.done = true;
    at_.effort = 0;
  }

  /// The axis did not move, its scale did: nobody takes a difference, and no work is booked.
  void shift(double by) noexcept {
    q_ += by;
    ledger_.q += by;
    qd_ = 0;
    axis_.motion = Motion::reseeded;
  }

  void report(Findings& findings, double found) noexcept {
    findings.report({.code = Fault::homing,
                     .axis = homing_.axis,
                     .found = found,
                     .allowed = homing_.max_ticks * period_s_});
    rest();
  }

  const HomingPlan& homing_;
  const AxisPlan& plan_;
  const double period_s_;
  HomingState& at_;
  AxisState& axis_;
  LedgerState& ledger_;
  double& q_;
  double& qd_;
  const AxisSample& sample_;
};

}  // namespace

void home(const Plan& plan, State& state, const TickInput& input, Findings& findings) noexcept {
  bool searching = state.mode != Mode::homing;  // one axis at a time, and none outside that mode
  for (std::size_t i = 0; i < plan.homings.size(); ++i) {
    // What was found before the device went away need not hold any more.
    if (input.axes[plan.homings[i].axis].freshness == Freshness::first) state.homings[i] = {};
    Homing axis(plan, state, input, i);
    if (!state.axes[plan.homings[i].axis].seeded) {
      findings.homed = false;
      continue;
    }
    axis.look(findings);
    if (!axis.done() && axis.drivable() && !searching) {
      searching = true;
      axis.search(findings);
    } else {
      axis.rest();
    }
    findings.homed = findings.homed && axis.done();
    findings.search = findings.search || (!axis.done() && axis.drivable());
  }
}

}  // namespace hapticd::control
