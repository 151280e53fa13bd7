// The condition in joint space for devices whose Jacobian depends on the pose, device by device: what
// ties two of them, W_ij, is taken for |W_ij| on each (2 a'W_ij b <= |W_ij| (|a|^2 + |b|^2)).
//
// Under latency tau <= T, springs of a coupling alone, any static scene (Theorem A' on a linkage):
//
//   s (J'KJ + 2 F_max |d2x/dq2|) < D_q  at every pose,  s = coupled_weight(tau, T),
//
// with the descent check as sharp as any proof needs. Proof. The old torque acts on the joints' motion a,
// the new one on b, D = a + b. The virtual side takes J_k'f_k.D - e.a,
//   e = J_k'f_k - J_{k-1}'f_{k-1} = J_k'(f_k - f_{k-1}) + (J_k - J_{k-1})'f_{k-1}.
// With norms by D_q, let kappa bound J'KJ and m bound F_max d2x/dq2, as quadratic forms, at all poses. Then
//   f_k.J_k D >= f_k.(x_{k+1} - x_k) - (m/2) |D|^2,   |x_{k+1} - x_k|_K^2 <= kappa |D|^2,
//   |J_k a|_K^2 <= kappa |a|^2,   |(J_k - J_{k-1})'f_{k-1}.a| <= (m/2) (|D_{k-1}|^2 + |a|^2),
// and what is left is the inequality of Theorem A' for one axis with K = kappa, D_q = 1, and m |D|^2 +
// (m/2) |a|^2 beside it: with g <= 1 its terms (kappa/2)(1 + eta) |D|^2 + (kappa/2)(1/g + 1/eta) |a|^2 cover
// these if kappa is taken for kappa + 2 m.
#include <Eigen/Dense>
#include <cmath>

#include "control/design/check/closed_form.h"
#include "control/design/check/poses.h"
#include "control/design/check/weights.h"

namespace hapticd::check {
namespace {

class JointSpace {
 public:
  JointSpace(const TiedCase& given, double limit)
      : given_(given),
        limit_(limit),
        late_(given.latency > 0),
        spring_s_(late_ ? coupled_weight(given.latency, given.plan.period_s)
                        : 0.5 * given.plan.period_s) {}

  PassiveAnswer answer() const {
    PassiveAnswer result;
    result.why = problem();
    if (!result.why.empty()) return result;
    double least = kForEver;
    Eigen::Index joint = 0, coordinate = 0;
    for (const std::size_t d : given_.devices) {
      PassiveAnswer own = of_device(d, joint, coordinate);
      if (given_.devices.size() > 1) own.why = given_.assumed[d].name + ": " + own.why;
      const double room = own.proved ? limit_ - own.damping_used : -1 - own.damping_used;
      if (room < least) result = own, least = room;
      joint += given_.plan.devices[d].axes;
      coordinate += given_.plan.devices[d].coordinates;
    }
    const Theorem theorem = late_ ? Theorem::any_static_scene_latency : Theorem::any_static_scene;
    result.theorem = result.proved ? theorem : Theorem::none;
    return result;
  }

 private:
  std::string problem() const {
    if (!given_.needs.problem.empty()) return given_.needs.problem;
    if (!given_.needs.exact_only.empty()) return given_.needs.exact_only;
    if (late_) {
      if (std::string why = problem_of_latency(); !why.empty()) return why;
    }
    if (!given_.plain || !given_.model.passive_network || given_.negative)
      return "on a linkage only springs and dampers, and networks of them, are proved";
    if (given_.heavy && !given_.scene.passive())
      return given_.nonconvex() +
             " is not convex and is felt together with the masses of a network";
    for (const control::ObserverPlan& observer : given_.plan.contact_observers) {
      if (is_jointed(given_.plan, observer.device) && is_own(observer.device))
        return "an observer at the contact of a linkage is not linear in its joints: put it at the "
               "axes";
    }
    return {};
  }

  /// The proof is about springs of a coupling and what stands still behind them.
  std::string problem_of_latency() const {
    const Demand& needs = given_.needs;
    if (!needs.direct.isZero(0) || !needs.direct_damper.isZero(0) || !needs.travel.isZero(0))
      return "latency_s is not zero, and something is rendered directly on a linkage, or at the "
             "ends of its "
             "travel: give its contact a coupling";
    if (needs.has_observer || !needs.joint_damper.isZero(0) || !needs.coupled_damper.isZero(0) ||
        given_.damped)
      return "latency_s is not zero, and a linkage has a coupling with damping, a compensation or "
             "an observer: no "
             "proof is known for both";
    if (given_.heavy)
      return "latency_s is not zero, and a linkage feels a network with masses: no proof is known "
             "for both";
    if (given_.latency > given_.plan.period_s)
      return "latency_s is longer than a period: no proof is known for a linkage then";
    const double needed = sharpness(given_.latency, given_.plan.period_s, 1 / spring_s_);
    for (const control::GroupPlan& group : given_.plan.groups) {
      const std::size_t contact = given_.plan.group_contacts[group.first_contact];
      if (is_own(given_.plan.contacts[contact].device) && group.sharpen < needed * (1 - kStrict))
        return worded(
            "the loop's descent check is too blunt for this latency: needs %.4g, has %.4g", needed,
            group.sharpen);
    }
    return {};
  }

  bool is_own(std::size_t device) const {
    for (const std::size_t d : given_.devices)
      if (d == device) return true;
    return false;
  }

  /// W of one device: its own block, and on the diagonal what ties it to others.
  Matrix weight(Eigen::Index first, Eigen::Index count) const {
    const Demand& needs = given_.needs;
    const Matrix all =
        spring_s_ * (needs.direct + needs.coupled) + needs.direct_damper + needs.coupled_damper;
    Matrix others = all.middleRows(first, count);
    Matrix own = others.middleCols(first, count);
    others.middleCols(first, count).setZero();
    // 2 |x' W y| <= |W| (|x|^2 + |y|^2) for each of the others: norms of blocks add up.
    own.diagonal().array() += others.colwise().norm().sum();
    return own;
  }

  /// Largest force on the contact, of the scene and of the weight that motors hold there [N], as often as it counts.
  double bending_force(std::size_t d) const {
    double weight = 0;
    for (const control::GravityTip& tip : given_.plan.gravity_tips)
      if (tip.device == d) weight = std::hypot(tip.weight[0], tip.weight[1], tip.weight[2]);
    // `poses` weighs it with T/2.
    const double share = late_ ? 4 * spring_s_ / given_.plan.period_s : 1;
    return share * (given_.plan.devices[d].max_force + weight);
  }

  PassiveAnswer of_device(std::size_t d, Eigen::Index joint, Eigen::Index coordinate) const {
    const control::DevicePlan& device = given_.plan.devices[d];
    const Vector damping = given_.damping.segment(joint, device.axes);
    const Vector asked =
        0.5 * given_.plan.period_s * given_.needs.travel.segment(joint, device.axes) +
        given_.needs.joint_damper.segment(joint, device.axes);
    const double joints = asked.cwiseQuotient(damping).maxCoeff();
    const Matrix own = weight(coordinate, device.coordinates);
    PassiveAnswer result;
    if (!is_jointed(given_.plan, d)) {
      const Matrix j = constant_jacobian(given_.plan, {d});
      result.damping_used = joints + share_of(j.transpose() * own * j, damping);
      result.proved = result.damping_used < limit_ - kStrict;
      result.stiffness_factor = (limit_ - joints) / (result.damping_used - joints);
      result.why =
          worded(result.proved ? "uses %.1f %% of the damping" : "needs %.1f %% of the damping",
                 100 * result.damping_used);
      return result;
    }
    const PoseAnswer poses =
        largest_share(given_.plan, d, damping, {.weight = own, .bending_force = bending_force(d)});
    word(poses, joints, result);
    return result;
  }

  /// The left side, with or without what curvature asks.
  std::string rule(bool curvature) const {
    if (late_)
      return worded(curvature ? "%.4g ms (J'KJ + 2 F_max |d2x/dq2|)" : "%.4g ms J'KJ",
                    1e3 * spring_s_);
    return curvature ? "J'(K T/2 + B)J + (T/2) F_max |d2x/dq2|" : "J'(K T/2 + B)J";
  }

  void word(const PoseAnswer& poses, double joints, PassiveAnswer& result) const {
    result.why = poses.problem;
    if (!result.why.empty()) return;
    if (!poses.met) {
      result.why = "no pose was found that the guards let pass: nothing can be said";
      return;
    }
    const double found = poses.found + joints;
    result.worst_pose =
        worded("contact at (%.4g, %.4g, %.4g) m", poses.pose[0], poses.pose[1], poses.pose[2]);
    result.damping_used = poses.share + joints;
    result.proved = result.damping_used < limit_ - kStrict;
    if (result.proved) {
      const double springs = poses.share - poses.bending;
      result.stiffness_factor =
          springs > 0 ? (limit_ - joints - poses.bending) / springs : kForEver;
      result.why = rule(true) + " < device damping holds at every pose of the guarded workspace: " +
                   worded(
                       "uses at most %.1f %% of the damping (%.1f %% where it was seen worst, "
                       "curvature at most %.1f %%), ",
                       100 * result.damping_used, 100 * found, 100 * poses.bending) +
                   result.worst_pose;
      return;
    }
    result.damping_used = std::isfinite(result.damping_used) ? result.damping_used : found;
    result.stiffness_factor = poses.found > 0 ? (limit_ - joints) / poses.found : 0;
    if (found >= limit_) {
      result.damping_used = found;
      result.why = rule(false) +
                   worded(" < device damping fails: needs %.3g times the damping with ", found) +
                   result.worst_pose;
      return;
    }
    result.why =
        "could not decide whether " + rule(true) +
        worded(" < device damping holds at every pose: %.1f %% of the damping is used with ",
               100 * found) +
        result.worst_pose +
        (std::isfinite(poses.share)
             ? worded(", and no more than %.1f %% could be shown anywhere",
                      100 * (poses.share + joints))
             : ", and a step at the largest velocity may lead from some pose to a singular one") +
        "; a smaller guard.workspace or a lower guard.max_velocity_rad_s may help";
  }

  const TiedCase& given_;
  double limit_;
  bool late_;
  double spring_s_;  ///< what a spring asks: N s/m for each N/m
};

}  // namespace

PassiveAnswer joint_space_form(const TiedCase& given, double limit) {
  return JointSpace(given, limit).answer();
}

}  // namespace hapticd::check
