#include "control/kinematics/kinematics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "control/kinematics/reach.h"
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {
namespace {

bool every_axis(const State& state, const Linkage& at, bool AxisState::*flag) noexcept {
  const auto axes = state.axes.subspan(at.first_axis, at.axes);
  return std::all_of(axes.begin(), axes.end(), [=](const AxisState& axis) { return axis.*flag; });
}

/// x, v and J of a contact from the pose in the device's own frame.
void place_contact(const Linkage& at, const LinkagePose& pose, State& state) noexcept {
  double* row = state.jacobian.data() + at.jacobian;
  const double* qd = state.qd.data() + at.first_axis;
  const auto& [px, py, pz] = pose.jacobian;
  for (std::size_t i = 0; i < at.coordinates; ++i, row += at.axes) {
    const auto [tx, ty, tz] = at.turn[i];  // a copy: stores to `row` cannot change it
    double v = 0;
    for (std::size_t j = 0; j < at.axes; ++j) {
      const double entry = tx * px[j] + ty * py[j] + tz * pz[j];
      v += entry * qd[j];
      row[j] = entry;
    }
    state.x[at.first_coordinate + i] =
        at.origin[i] + (tx * pose.tip[0] + ty * pose.tip[1] + tz * pose.tip[2]);
    state.v[at.first_coordinate + i] = v;
  }
}

template <class Kind>
double reach_of(const Kind&, const Plan&, const Linkage& at, const double* jacobian) noexcept {
  return reach_of(at, jacobian);
}

/// Columns of turning and of sliding joints have no unit in common, so nothing can be said of J
/// itself. In a chain that has both, a column stands for the tip's motion per unit of effort that its
/// actuator can give: all are then m/J, and kappa compares the forces that the motors can make.
double reach_of(const Serial& chain, const Plan& plan, const Linkage& at,
                const double* jacobian) noexcept {
  const auto slides = [](const DhJoint& joint) { return joint.prismatic; };
  const auto end = chain.joint.begin() + chain.joints;
  const auto sliding = std::count_if(chain.joint.begin(), end, slides);
  if (sliding == 0 || sliding == chain.joints) return reach_of(at, jacobian);
  std::array<double, kMaxContactCoordinates * kMaxJoints> scaled;
  for (std::size_t k = 0; k < std::size_t{at.coordinates} * at.axes; ++k)
    scaled[k] = jacobian[k] / plan.axes[at.first_axis + k % at.axes].max_effort;
  return reach_of(at, scaled.data());
}

/// No pose fits: the last one stands, at rest and without force.
void keep_pose(const Linkage& at, State& state, Findings& findings) noexcept {
  for (std::size_t i = 0; i < at.coordinates; ++i) state.v[at.first_coordinate + i] = 0;
  state.reach[at.device] = 0;
  if (every_axis(state, at, &AxisState::homed))
    findings.report({.code = Fault::kinematics, .device = at.device});
}

template <class Kind>
void move_linkage(const Kind& kind, const Plan& plan, State& state, Findings& findings) noexcept {
  const Linkage& at = plan.linkages[kind.linkage];
  double& reach = state.reach[at.device];
  if (!every_axis(state, at, &AxisState::seeded)) {
    reach = 0;
    return;
  }
  LinkageState& kept = state.linkages[kind.linkage];
  LinkagePose pose{.tip = kept.tip};
  if (pose_of(kind, state.q.data() + at.first_axis, pose)) {
    kept = {.tip = pose.tip};
    place_contact(at, pose, state);
    reach = std::isinf(at.max_condition)
                ? 1
                : reach_of(kind, plan, at, state.jacobian.data() + at.jacobian);
  } else {
    keep_pose(at, state, findings);
  }
  if (reach < 1) findings.limits.set(Limit::singular);
}

void move_linkages(const Plan& plan, State& state, Findings& findings) noexcept {
  for (const LinearMap& map : plan.linear_maps) move_linkage(map, plan, state, findings);
  for (const FiveBar& bars : plan.five_bars) move_linkage(bars, plan, state, findings);
  for (const Delta& delta : plan.deltas) move_linkage(delta, plan, state, findings);
  for (const Serial& chain : plan.serials) move_linkage(chain, plan, state, findings);
}

/// f of J' f = effort: the rows of J' are three planes (filled up to three by unit vectors), f is
/// where they meet.
bool solve_transposed(const Linkage& at, const double* jacobian, const double* effort,
                      double* force) noexcept {
  constexpr double kFlat =
      1e-9;  // volume of the rows, each of length 1, below which none is inverted
  if (at.axes != at.coordinates) return false;
  const std::size_t n = at.axes;
  std::array<Eigen::Vector3d, 3> row = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                        Eigen::Vector3d::UnitZ()};
  std::array<double, 3> right{};
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) row[j][static_cast<int>(i)] = jacobian[i * n + j];
    right[j] = effort[j];
  }
  const Eigen::Vector3d across = row[1].cross(row[2]);
  const double volume = row[0].dot(across);
  if (!(std::abs(volume) > kFlat * row[0].norm() * row[1].norm() * row[2].norm())) return false;
  const Eigen::Vector3d met =
      (right[0] * across + right[1] * row[2].cross(row[0]) + right[2] * row[0].cross(row[1])) /
      volume;
  for (std::size_t i = 0; i < n; ++i) force[i] = met[static_cast<int>(i)];
  return true;
}

}  // namespace

void forward(const Plan& plan, State& state, Findings& findings) noexcept {
  for (const CartesianAxis& pair : plan.cartesian_axes) {
    state.x[pair.coordinate] = pair.scale * state.q[pair.axis] + pair.origin;
    state.v[pair.coordinate] = pair.scale * state.qd[pair.axis];
  }
  if (!plan.linkages.empty()) move_linkages(plan, state, findings);
}

void transpose(const Plan& plan, const State& state, std::span<const double> force,
               std::span<double> effort) noexcept {
  for (const CartesianAxis& pair : plan.cartesian_axes)
    effort[pair.axis] = pair.scale * force[pair.coordinate];
  for (const Linkage& at : plan.linkages) {
    for (std::size_t j = 0; j < at.axes; ++j) {
      double sum = 0;
      for (std::size_t i = 0; i < at.coordinates; ++i)
        sum += state.jacobian[at.jacobian + i * at.axes + j] * force[at.first_coordinate + i];
      effort[at.first_axis + j] = sum;
    }
  }
}

bool contact_force(const Plan& plan, const State& state, std::size_t device, const double* effort,
                   double* force) noexcept {
  for (const Linkage& at : plan.linkages) {
    if (at.device == device)
      return solve_transposed(at, state.jacobian.data() + at.jacobian, effort, force);
  }
  const DevicePlan& here = plan.devices[device];
  for (const CartesianAxis& pair : plan.cartesian_axes) {
    if (pair.axis < here.first_axis || pair.axis >= here.first_axis + here.axes) continue;
    force[pair.coordinate - here.first_coordinate] =
        effort[pair.axis - here.first_axis] / pair.scale;
  }
  return true;
}

}  // namespace hapticd::control
