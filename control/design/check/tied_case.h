// All that is known of devices that share one inequality, and the shares of damping that matrices
// ask of them.
#pragma once
#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "control/design/check/demand.h"
#include "control/design/check/models.h"
#include "control/design/check/stability.h"

namespace hapticd::check {

inline constexpr double kForEver = std::numeric_limits<double>::infinity();
/// Rounding of the small eigenvalue problems stays far below this: equality is not taken for a
/// strict inequality.
inline constexpr double kStrict = 1e-9;

struct TiedCase {
  TiedCase(const control::Plan& plan, const std::vector<DeviceAssumption>& assumed,
           const Tied& devices);

  const control::Plan& plan;
  const std::vector<DeviceAssumption>& assumed;
  const Tied& devices;
  Demand needs;
  TiedModel model;
  Behind scene;
  Vector damping;      ///< Delta_D, per joint
  double latency = 0;  ///< the longest of all
  bool jointed = false;
  bool heavy = false;     ///< masses in the network
  bool plain = false;     ///< the coupling is none, or springs and dampers
  bool damped = false;    ///< it has dampers
  bool negative = false;  ///< B is not >= 0

  /// "sphere 'ball', mesh 'hill'": bodies that are not convex.
  std::string nonconvex() const;
  /// "left, right".
  std::string names() const;
  /// What direct rendering, travel and compensation ask, over the joints, springs weighed by
  /// `weight` [s]; constant Jacobians only.
  Matrix beside(double weight) const;
  /// (T/2) rho over the model's coordinates: the level of bodies and fields (weak_convexity.h).
  Matrix weak_level() const;
  /// Rows of the constant Jacobian that belong to the model's coordinates.
  Matrix coupled_jacobian() const;
};

/// Largest s with det(demand - s Delta) = 0: the share of the damping that is used. Delta > 0,
/// diagonal.
double share_of(const Matrix& demand, const Vector& damping);

/// printf with up to four numbers.
std::string worded(const char* format, double a = 0, double b = 0, double c = 0, double d = 0);

}  // namespace hapticd::check
