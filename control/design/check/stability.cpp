#include "control/design/check/stability.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace hapticd::check {
namespace {

using Matrix = Eigen::MatrixXd;

/// Rounding of the small eigenvalue problems stays far below this: equality is not taken for a
/// strict inequality.
constexpr double kMargin = 1e-9;

/// What planes, travel springs and friction compensation of one device ask of its damping, in joint
/// space: spring part (T/2) sum k nn', damper part sum b nn'.
struct Demand {
  Matrix spring, damper;
};

/// dx/dq of a device whose Jacobian is constant: contact coordinates x axes.
Matrix jacobian(const control::Plan& plan, const control::DevicePlan& device) {
  Matrix j = Matrix::Zero(device.coordinates, device.axes);
  for (const control::CartesianAxis& pair : plan.cartesian_axes) {
    const int axis = pair.axis - device.first_axis;
    if (axis >= 0 && axis < device.axes)
      j(pair.coordinate - device.first_coordinate, axis) = pair.scale;
  }
  for (const control::LinearMap& map : plan.linear_maps) {
    const control::Linkage& linkage = plan.linkages[map.linkage];
    if (linkage.first_axis != device.first_axis) continue;
    for (int row = 0; row < device.coordinates; ++row) {
      for (int axis = 0; axis < device.axes; ++axis) {
        for (std::size_t i = 0; i < 3; ++i)
          j(row, axis) += linkage.turn[static_cast<std::size_t>(row)][i] *
                          map.columns[i][static_cast<std::size_t>(axis)];
      }
    }
  }
  return j;
}

Demand demand(const control::Plan& plan, const control::DevicePlan& device) {
  const Matrix j = jacobian(plan, device);
  Demand sum{Matrix::Zero(device.axes, device.axes), Matrix::Zero(device.axes, device.axes)};
  for (const control::PlaneContact& plane : plan.planes) {
    if (plane.first_coordinate != device.first_coordinate) continue;
    const Eigen::Map<const Eigen::VectorXd> in_world(plane.normal.data(), device.coordinates);
    const Eigen::VectorXd normal = j.transpose() * in_world;
    sum.spring += 0.5 * plan.period_s * plane.stiffness * normal * normal.transpose();
    sum.damper += plane.damping * normal * normal.transpose();
  }
  for (const control::FrictionAxis& friction : plan.frictions) {
    const int axis = friction.axis - device.first_axis;
    if (axis >= 0 && axis < device.axes)
      sum.damper(axis, axis) += friction.viscous + friction.coulomb / friction.smooth;
  }
  for (const control::TravelPlan& travel : plan.travels) {
    const int axis = travel.axis - device.first_axis;
    if (axis >= 0 && axis < device.axes)
      sum.spring(axis, axis) += 0.5 * plan.period_s * travel.stiffness;
  }
  return sum;
}

/// Largest s with det(demand - s Delta) = 0, Delta diagonal and positive: the share of the damping
/// that is used.
double share(const Matrix& demand, const Eigen::VectorXd& damping) {
  const Eigen::VectorXd scale = damping.array().rsqrt();
  const Matrix scaled = scale.asDiagonal() * demand * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Matrix>(scaled, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

/// Largest factor c with spring * c + damper < Delta; the share grows with c, so bisection is safe.
double stiffness_factor(const Demand& demand, const Eigen::VectorXd& damping) {
  if (demand.spring.isZero(0)) return std::numeric_limits<double>::infinity();
  const Matrix room = Matrix(damping.asDiagonal()) - demand.damper;
  const Eigen::LLT<Matrix> factor(room);
  if (factor.info() != Eigen::Success) return 0;
  const Matrix half = factor.matrixL().solve(demand.spring);
  const Matrix scaled = factor.matrixL().solve(half.transpose());
  const Matrix symmetric = 0.5 * (scaled + scaled.transpose());
  return 1 / Eigen::SelfAdjointEigenSolver<Matrix>(symmetric, Eigen::EigenvaluesOnly)
                 .eigenvalues()
                 .maxCoeff();
}

std::string text(const char* format, double a, double b, double c) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

/// What is left, for people: how much stiffer the scene may get, how many ticks in a row may be missed.
std::string margin(const PassiveAnswer& answer, double period_s) {
  if (!(answer.damping_used > 0)) return {};
  if (!answer.proved) {
    return text("; it would hold up to %.3g times this stiffness", answer.stiffness_factor, 0, 0);
  }
  const double missed = std::max(0.0, std::ceil(answer.longest_hold_s / period_s) - 2);
  return text(
      "; holds up to %.3g times this stiffness, and while a force is held less than %.3g ms, "
      "so with %.0f missed ticks in a row",
      answer.stiffness_factor, 1e3 * answer.longest_hold_s, missed);
}

std::string missing_premise(const control::DevicePlan& device, const DeviceAssumption& assumed) {
  if (!assumed.obstacles.empty()) {
    std::string text = assumed.obstacles.front();
    for (std::size_t i = 1; i < assumed.obstacles.size(); ++i) text += "; " + assumed.obstacles[i];
    return text;
  }
  if (assumed.min_damping.size() != device.axes)
    return "no `model` with a damping for every axis: nothing can be proved";
  for (const double damping : assumed.min_damping) {
    if (!(damping > 0))
      return "the smallest damping of an axis is zero: a passive spring needs damping in the "
             "device";
  }
  if (assumed.latency_s != 0)
    return "latency_s is not zero: no proof is known yet for a plane under latency";
  return {};
}

PassiveAnswer answer(const control::Plan& plan, const control::DevicePlan& device,
                     const DeviceAssumption& assumed) {
  PassiveAnswer result;
  result.why = missing_premise(device, assumed);
  if (!result.why.empty()) return result;
  const Eigen::Map<const Eigen::VectorXd> damping(assumed.min_damping.data(), device.axes);
  const Demand needs = demand(plan, device);
  result.damping_used = share(needs.spring + needs.damper, damping);
  result.stiffness_factor = stiffness_factor(needs, damping);
  // A force held for h instead of T: (h/2) k + (h/T) b < Delta, the whole demand grows with h/T.
  result.longest_hold_s = result.damping_used > 0 ? plan.period_s / result.damping_used
                                                  : std::numeric_limits<double>::infinity();
  result.proved = result.damping_used < 1 - kMargin;
  result.why =
      text(result.proved ? "K T/2 + B < device damping holds: uses %.1f %% of the damping "
                           "(K T/2 alone %.1f %%, B alone %.1f %%)"
                         : "K T/2 + B < device damping fails: needs %.1f %% of the damping "
                           "(K T/2 alone %.1f %%, B alone %.1f %%)",
           100 * result.damping_used, 100 * share(needs.spring, damping),
           100 * share(needs.damper, damping));
  result.why += margin(result, plan.period_s);
  return result;
}

}  // namespace

std::vector<PassiveAnswer> passive(const control::Plan& plan,
                                   const std::vector<DeviceAssumption>& assumed) {
  std::vector<PassiveAnswer> answers;
  for (std::size_t i = 0; i < plan.devices.size(); ++i)
    answers.push_back(answer(plan, plan.devices[i], assumed.at(i)));
  return answers;
}

}  // namespace hapticd::check
