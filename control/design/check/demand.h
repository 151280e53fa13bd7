// What a scene asks of the damping of the devices that feel it, as matrices: over the coordinates of
// their contacts for what acts there, over their joints for what acts on those.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "control/plan.h"

namespace hapticd::check {

/// Devices that a coupling or a network ties, in plan order: their joints share one inequality.
using Tied = std::vector<std::size_t>;
std::vector<Tied> tied_devices(const control::Plan& plan);

/// Coordinates and joints of the devices, each one device after the other.
struct Demand {
  Eigen::MatrixXd direct;          ///< N/m: bodies on the contact itself
  Eigen::MatrixXd direct_damper;   ///< N s/m: of those, and what contact observers take
  Eigen::MatrixXd coupled;         ///< N/m: springs of the coupling
  Eigen::MatrixXd coupled_damper;  ///< N s/m: its dampers
  Eigen::VectorXd travel;          ///< N/m or N m/rad, per joint: ends of travel, pendulums
  Eigen::VectorXd joint_damper;    ///< N s/m or N m s/rad: friction compensation, axis observers
  bool convex = true;              ///< all that is rendered directly is convex and without friction
  bool has_observer = false;
  std::string problem;     ///< what nothing is known for; empty: nothing
  std::string exact_only;  ///< what only a proof for one linear scene may cover
};

/// Bodies count as if all that can be touched at once were.
Demand demand(const control::Plan& plan, const Tied& devices);

/// dx/dq of all of the devices, whose Jacobians are constant: coordinates x joints.
Eigen::MatrixXd constant_jacobian(const control::Plan& plan, const Tied& devices);

/// What the devices feel behind a coupling.
struct Behind {
  bool any = false;              ///< any object at all, coupled or direct
  bool linear = true;            ///< nothing but constant fields everywhere
  std::vector<double> weakness;  ///< N/m per coordinate of the plan: rho of objects.h
  double weakest = 0;            ///< the largest of them
  /// Bodies are convex, friction or not; fields only damp or are constant.
  bool passive() const noexcept { return weakest == 0; }
};
Behind behind(const control::Plan& plan, const Tied& devices);

}  // namespace hapticd::check
