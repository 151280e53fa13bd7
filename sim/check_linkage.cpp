#include "sim/check_linkage.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "sim/check_value.h"
#include "sim/joint_mass.h"

namespace hapticd::sim {
namespace {

std::string value_problem(const LinkageOptions& linkage) {
  const auto& g = linkage.gravity;
  std::string problem = first_negative(std::array{Field{"inner_link_kg", linkage.inner_link_kg},
                                                  Field{"outer_link_kg", linkage.outer_link_kg},
                                                  Field{"tip_kg", linkage.tip_kg}});
  if (problem.empty()) {
    problem = first_not_finite(
        std::array{Field{"gravity", g[0]}, Field{"gravity", g[1]}, Field{"gravity", g[2]}});
  }
  if (!problem.empty()) return problem;
  const double length = Eigen::Vector3d::Map(linkage.hand_direction.data()).norm();
  if (!(std::abs(length - 1) <= 1e-9)) {
    return expected("hand_direction", "a vector of length 1", length);
  }
  const bool rods = linkage.inner_link_kg > 0 || linkage.outer_link_kg > 0;
  if (rods && !std::holds_alternative<control::FiveBar>(linkage.geometry)) {
    return expected("inner_link_kg, outer_link_kg",
                    "0: only a five-bar has them; give other links' inertia in mass_kg",
                    linkage.inner_link_kg + linkage.outer_link_kg);
  }
  return {};
}

std::string count_problem(const DeviceOptions& options) {
  const std::size_t axes = options.axes.size();
  if (axes > kMaxJoints) {
    return expected("axes", "at most 6 joints in a linkage", static_cast<double>(axes));
  }
  const std::size_t joints = joint_count(options.linkage->geometry);
  if (joints != 0 && joints != axes) {
    return expected("axes", std::to_string(joints) + ", one for each joint of the linkage",
                    static_cast<double>(axes));
  }
  return {};
}

// Runge-Kutta wants sub-steps well below every time that the linkage knows: the decay of its
// dampers and the swing of the hand's spring.
std::string step_problem(const DeviceOptions& options, const JointDynamics& start) {
  constexpr double kMost = 0.5;
  const HandOptions& hand = options.hand;
  const JointMatrix mobility = start.mass.llt().solve(JointMatrix::Identity());
  const PointJacobian& j = start.points.point[0].jacobian;
  const double tip = (j * mobility * j.transpose()).trace();  // 1/kg
  double rate = std::max(hand.damping_Ns_m * tip, std::sqrt(hand.stiffness_N_m * tip));
  for (std::size_t i = 0; i < options.axes.size(); ++i) {
    const auto joint = static_cast<int>(i);
    rate = std::max(rate, options.axes[i].damping_Ns_m * mobility(joint, joint));
  }
  const double least = rate * options.period_s / kMost;
  if (least <= options.substeps) return {};
  return expected("substeps",
                  "at least " + text(std::ceil(least)) +
                      ", for dampers and a hand this stiff on so light a linkage",
                  options.substeps);
}

}  // namespace

std::string linkage_problem(const DeviceOptions& options) {
  std::string problem = value_problem(*options.linkage);
  if (problem.empty()) problem = count_problem(options);
  if (!problem.empty()) return problem;
  const JointMass mass(*options.linkage, options.axes, options.hand.mass_kg);
  JointDynamics start;
  Joints q = Joints::Zero();
  for (std::size_t i = 0; i < options.axes.size(); ++i)
    q[static_cast<int>(i)] = options.axes[i].position_m;
  if (!mass.dynamics(q, Joints::Zero(), start)) {
    return "position_m: expected joints that the linkage can take together, found " + text(q[0]) +
           (options.axes.size() > 1 ? ", " + text(q[1]) : "") + ", ...: no pose fits them";
  }
  return step_problem(options, start);
}

}  // namespace hapticd::sim
