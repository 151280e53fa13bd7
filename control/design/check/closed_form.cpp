#include "control/design/check/closed_form.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "control/design/check/certified.h"
#include "control/design/check/weak_convexity.h"
#include "control/design/check/weights.h"

namespace hapticd::check {
namespace {

/// Largest factor c with spring * c + damper < Delta.
double stiffest(const Matrix& spring, const Matrix& damper, const Vector& damping) {
  if (spring.isZero(0)) return kForEver;
  const Matrix room = Matrix(damping.asDiagonal()) - damper;
  const Eigen::LLT<Matrix> factor(room);
  if (factor.info() != Eigen::Success) return 0;
  const Matrix half = factor.matrixL().solve(spring);
  const Matrix scaled = factor.matrixL().solve(half.transpose());
  return 1 / largest_eigenvalue(symmetric_part(scaled));
}

class ClosedForm {
 public:
  ClosedForm(const TiedCase& given, double limit)
      : given_(given),
        limit_(limit),
        period_(given.plan.period_s),
        latency_(given.latency),
        late_(given.latency > 0),
        coupled_(!given.needs.coupled.isZero(0) || given.damped) {}

  PassiveAnswer answer() {
    PassiveAnswer result;
    result.theorem = theorem();
    result.why = problem(result.theorem);
    if (!result.why.empty()) {
      result.theorem = Theorem::none;
      return result;
    }
    judge(result);
    if (!result.proved) result.theorem = Theorem::none;
    return result;
  }

 private:
  /// The one that holds for most scenes.
  Theorem theorem() const {
    const bool any_shape = !(given_.heavy && !given_.scene.passive()) && !given_.negative;
    if (!any_shape) return Theorem::passive_scene;
    if (!late_) return Theorem::any_static_scene;
    if (coupled_ && (given_.damped || (is_blunt() && given_.scene.passive())))
      return Theorem::passive_scene;
    return Theorem::any_static_scene_latency;
  }

  std::string problem(Theorem theorem) const {
    if (!given_.needs.problem.empty()) return given_.needs.problem;
    if (!given_.needs.exact_only.empty()) return given_.needs.exact_only;
    if (!given_.plain)
      return "the coupling is a general V(z), not a spring and a damper: it needs a certificate";
    if (!given_.model.passive_network)
      return "the network's integrator is not backward Euler, so it is not passive by "
             "construction: it needs a certificate";
    if (theorem == Theorem::passive_scene && !given_.scene.passive()) {
      const std::string found = problem_of_weakness();
      if (!found.empty()) return found;
    }
    return late_ ? problem_of_latency(theorem) : std::string();
  }

  std::string problem_of_weakness() const {
    const std::string what = given_.nonconvex();
    if (given_.negative) return "the coupling has negative damping, and " + what + " is not convex";
    if (late_) {
      return given_.heavy
                 ? what +
                       " is not convex and is felt together with the masses of a network, and "
                       "latency_s is not zero: no proof is known for both"
                 : "latency_s is not zero, the coupling has damping, and " + what +
                       " is not convex";
    }
    if (!given_.model.all_coupled || std::isinf(given_.scene.weakest))
      return what + " is not convex, nor nearly, and is felt together with the masses of a network";
    return {};
  }
  /// Is the scene passive only together with its level (weak_convexity.h)?
  bool is_weak(Theorem theorem) const {
    return theorem == Theorem::passive_scene && !given_.scene.passive();
  }

  std::string problem_of_latency(Theorem theorem) const {
    if (given_.needs.has_observer || !given_.needs.direct_damper.isZero(0) ||
        !given_.needs.joint_damper.isZero(0))
      return "latency_s is not zero, and the scene has damping that is rendered directly, or there "
             "is a compensation or an observer: no proof is known for both";
    const bool direct = !given_.needs.direct.isZero(0) || !given_.needs.travel.isZero(0);
    if (direct && !given_.needs.convex)
      return "latency_s is not zero, and an object that is rendered directly is not convex or has "
             "friction: give its contact a coupling";
    if (!coupled_) return {};
    if (latency_ > period_)
      return "latency_s is longer than a period: no proof is known for a coupling then";
    if (theorem == Theorem::any_static_scene_latency && is_blunt())
      return worded("the loop's descent check is too blunt for this latency: needs %.4g, has %.4g",
                    needed_sharpness(), sharpness_of_loop());
    return {};
  }

  Matrix coupled(const Matrix& over_coordinates) const {
    const Matrix j = constant_jacobian(given_.plan, given_.devices);
    return j.transpose() * over_coordinates * j;
  }

  /// By the damping that is left for the coupling; where something beside it takes of that, by the
  /// fastest rate that any proof allows.
  double needed_sharpness() const {
    if (!given_.beside(1).isZero(0))
      return sharpness(latency_, period_, 1 / coupled_weight(latency_, period_));
    return sharpness(latency_, period_, share_of(coupled(given_.needs.coupled), given_.damping));
  }
  double sharpness_of_loop() const {
    double least = kForEver;
    for (const control::GroupPlan& group : given_.plan.groups) {
      const std::size_t contact = given_.plan.group_contacts[group.first_contact];
      const auto& own = given_.devices;
      if (std::find(own.begin(), own.end(), given_.plan.contacts[contact].device) != own.end())
        least = std::min(least, group.sharpen);
    }
    return least;
  }
  bool is_blunt() const {
    return latency_ <= period_ && sharpness_of_loop() < needed_sharpness() * (1 - kStrict);
  }

  /// What the coupling asks when its springs are `factor` times as stiff: each matrix on its own.
  std::vector<Matrix> demands(Theorem theorem, double factor) const {
    if (!coupled_) return {Matrix::Zero(given_.damping.size(), given_.damping.size())};
    if (theorem != Theorem::passive_scene) {
      const double weight = late_ ? coupled_weight(latency_, period_) : 0.5 * period_;
      return {coupled(factor * weight * given_.needs.coupled + given_.needs.coupled_damper)};
    }
    const Matrix j = given_.coupled_jacobian();
    std::vector<Matrix> all =
        passive_scene_demands(factor * given_.model.K, given_.model.B, latency_, period_);
    for (Matrix& demand : all) demand = (j.transpose() * demand * j).eval();
    return all;
  }

  double share(Theorem theorem, double factor) const {
    const std::vector<Matrix> all = demands(theorem, factor);
    const Matrix dampers = given_.beside(0);
    const Matrix rest = factor * (given_.beside(direct_weight(latency_, period_)) - dampers);
    double most = all.empty() ? kForEver : 0;
    for (const Matrix& demand : all) {
      const double asked = share_of(demand + rest + dampers, given_.damping);
      if (!(asked <= most)) most = asked;
      if (std::isnan(most)) return kForEver;
    }
    if (!is_weak(theorem)) return most;
    const auto left = [this](double part) { return damping_left(given_, part); };
    return std::max(most, share_with_level(factor * given_.model.K, given_.model.B,
                                           given_.weak_level(), left, period_));
  }

  double stiffness_factor(Theorem theorem) const {
    if (theorem != Theorem::passive_scene) {
      const Matrix dampers = given_.beside(0) + coupled(given_.needs.coupled_damper);
      const Matrix springs =
          demands(theorem, 1).front() + given_.beside(direct_weight(latency_, period_)) - dampers;
      return stiffest(springs, dampers, limit_ * given_.damping);
    }
    // No closed form: the largest factor found to pass.
    double passes = 0, fails = 1;
    for (int i = 0; i < 60 && share(theorem, fails) < limit_; ++i) passes = fails, fails *= 2;
    for (int i = 0; i < 30; ++i) {
      const double middle = 0.5 * (passes + fails);
      (share(theorem, middle) < limit_ ? passes : fails) = middle;
    }
    return passes;
  }

  void judge(PassiveAnswer& result) const {
    const Theorem theorem = result.theorem;
    const Matrix dampers = given_.beside(0) + coupled(given_.needs.coupled_damper);
    result.damping_used = share(theorem, 1);
    result.stiffness_factor = stiffness_factor(theorem);
    result.proved = result.damping_used < limit_ - kStrict;
    // A force held for h instead of T: (h/2) K + (h/T) B < Delta, all of it grows with h/T. What an
    // observer does over a longer hold is not known.
    if (!late_ && theorem == Theorem::any_static_scene && !given_.needs.has_observer)
      result.longest_hold_s =
          result.damping_used > 0 ? limit_ * period_ / result.damping_used : kForEver;
    const double used = 100 * result.damping_used;
    if (theorem == Theorem::passive_scene) {
      result.why = rule(theorem) + worded(result.proved ? " holds: uses %.1f %% of the damping"
                                                        : " fails: needs %.1f %% of the damping",
                                          used);
      return;
    }
    const Matrix springs =
        demands(theorem, 1).front() + given_.beside(direct_weight(latency_, period_)) - dampers;
    result.why = rule(theorem) +
                 worded(result.proved ? " holds: uses %.1f %% of the damping (springs alone %.1f "
                                        "%%, dampers alone %.1f %%)"
                                      : " fails: needs %.1f %% of the damping (springs alone %.1f "
                                        "%%, dampers alone %.1f %%)",
                        used, 100 * share_of(springs, given_.damping),
                        100 * share_of(dampers, given_.damping));
  }

  std::string rule(Theorem theorem) const {
    if (is_weak(theorem)) {
      return worded(
          "Theorem 3 for springs stiffer than the scene is weak (%.4g N/m) and softer than the "
          "device damping allows",
          given_.scene.weakest);
    }
    if (theorem == Theorem::passive_scene) {
      return late_ ? worded("Theorem B with K, B and any latency up to %.4g ms < device damping",
                            1e3 * latency_)
                   : "Theorem B with K T/2 + B and (T/2) K (K + 2 B/T)^-1 K < device damping";
    }
    if (!late_) return "K T/2 + B < device damping";
    const double weight =
        coupled_ ? coupled_weight(latency_, period_) : direct_weight(latency_, period_);
    return worded("K times %.4g ms < device damping", 1e3 * weight);
  }

  const TiedCase& given_;
  double limit_;
  double period_;
  double latency_;
  bool late_;
  bool coupled_;
};

}  // namespace

PassiveAnswer closed_form(const TiedCase& given, double limit) {
  return ClosedForm(given, limit).answer();
}

}  // namespace hapticd::check
