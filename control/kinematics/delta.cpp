// Delta of the Novint Falcon (Tsai and Stamper 1996). Leg i, in the plane turned by its angle
// around z, has its driven arm (length a, angle q) at the origin and sees the tip at
//
//   u = cos x + sin y - r,  v = -sin x + cos y - s,  w = z;  X = u + c,  V = v + f
//
// The parallelogram (length b, leant sideways by V) lies between arm and tip:
//
//   g = (X - a cos q)^2 + (w - a sin q)^2 - L^2 = 0,  L = d + e + sqrt(b^2 - V^2)
//
// The legs trace parts of a torus, not of a sphere, so the forward solution is Newton's. With
// G = dg/dp (3 x 3) and g_q = dg/dq: dp/dq = -G^-1 diag(g_q).
//
// Two signs tell the assembled device from the other solutions of the same equations: g_q < 0 (knee
// out), and det G, which a pose can only change by passing through a singular one.
#include <Eigen/LU>
#include <cmath>

#include "control/kinematics/kinematics.h"

namespace hapticd::control {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A Falcon takes 4 from 2 mm away and at most 8 from (0, 0, 0.11) to any place of its box.
constexpr int kMaxNewtonSteps = 12;
/// m: a step so small is the last. The error left is of the order of its square over a length of
/// the device; what is wrong with J, of the order of the step over that length.
constexpr double kLastStep = 1e-10;

struct ArmAngles {
  Vector3d cos, sin;
  explicit ArmAngles(const double* q) noexcept
      : cos(std::cos(q[0]), std::cos(q[1]), std::cos(q[2])),
        sin(std::sin(q[0]), std::sin(q[1]), std::sin(q[2])) {}
};

/// How well three arm angles and a tip fit together.
struct Closure {
  Vector3d gap;       ///< m^2: g
  Matrix3d by_tip;    ///< m: G
  Vector3d by_angle;  ///< m^2: g_q
};

/// NaN where the tip is further to the side of a leg than its parallelogram is long.
Closure close_legs(const Delta& delta, const ArmAngles& arm, const Vector3d& tip) noexcept {
  Closure out;
  for (int i = 0; i < 3; ++i) {
    const auto [c, s] = delta.leg[static_cast<std::size_t>(i)];
    const double across = -s * tip.x() + c * tip.y() - delta.s + delta.f;
    const double flat = std::sqrt(delta.b * delta.b - across * across);
    const double rod = delta.d + delta.e + flat;
    const double u = c * tip.x() + s * tip.y() - delta.r + delta.c - delta.a * arm.cos[i];
    const double w = tip.z() - delta.a * arm.sin[i];
    const double by_u = 2 * u, by_v = 2 * rod * across / flat;
    out.gap[i] = u * u + w * w - rod * rod;
    out.by_tip.row(i) << c * by_u - s * by_v, s * by_u + c * by_v, 2 * w;
    out.by_angle[i] = 2 * delta.a * (u * arm.sin[i] - w * arm.cos[i]);
  }
  return out;
}

/// Twice the area of the triangle of the legs' directions: its sign is that of their numbering.
double handedness(const Delta& delta) noexcept {
  const auto& [l, m, n] = delta.leg;
  return (m[0] - l[0]) * (n[1] - l[1]) - (m[1] - l[1]) * (n[0] - l[0]);
}

/// False for NaN.
bool is_assembled(const Delta& delta, const Closure& legs) noexcept {
  return legs.by_tip.determinant() * handedness(delta) > 0 && (legs.by_angle.array() < 0).all();
}

bool solve_from(Vector3d tip, const Delta& delta, const ArmAngles& arm,
                LinkagePose& pose) noexcept {
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    const Closure legs = close_legs(delta, arm, tip);
    const Matrix3d inverse = legs.by_tip.inverse();
    const Vector3d step = -inverse * legs.gap;
    const double length = step.norm(), longest = delta.a / 2;
    tip += length > longest ? Vector3d(step * (longest / length)) : step;
    if (!(length <= kLastStep)) continue;
    if (!is_assembled(delta, legs)) return false;
    const Matrix3d jacobian = -inverse * legs.by_angle.asDiagonal();
    for (int row = 0; row < 3; ++row) {
      pose.tip[static_cast<std::size_t>(row)] = tip[row];
      for (int leg = 0; leg < 3; ++leg)
        pose.jacobian[static_cast<std::size_t>(row)][static_cast<std::size_t>(leg)] =
            jacobian(row, leg);
    }
    return true;
  }
  return false;
}

}  // namespace

// The last tip is where it starts; from where that leads nowhere (first tick, after a gap), home.
bool pose_of(const Delta& delta, const double* q, LinkagePose& pose) noexcept {
  const ArmAngles arm(q);
  return solve_from(Vector3d(pose.tip.data()), delta, arm, pose) ||
         solve_from(Vector3d(delta.home.data()), delta, arm, pose);
}

// g = 0 as an equation for q: X cos q + w sin q = (X^2 + w^2 + a^2 - L^2) / 2a, that is
// rho cos(q - atan2(w, X)) on the right-hand side; knee out is the smaller of its two angles.
bool joints_of(const Delta& delta, const std::array<double, 3>& tip, double* q) noexcept {
  std::array<double, 3> angle{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [c, s] = delta.leg[i];
    const double across = -s * tip[0] + c * tip[1] - delta.s + delta.f;
    const double rod = delta.d + delta.e + std::sqrt(delta.b * delta.b - across * across);
    const double x = c * tip[0] + s * tip[1] - delta.r + delta.c, w = tip[2];
    const double rho = std::hypot(x, w);
    const double along = (rho * rho + delta.a * delta.a - rod * rod) / (2 * delta.a * rho);
    angle[i] = std::atan2(w, x) - std::acos(along);  // NaN where the tip is out of reach
  }
  const Closure legs = close_legs(delta, ArmAngles(angle.data()), Vector3d(tip.data()));
  if (!is_assembled(delta, legs)) return false;
  for (std::size_t i = 0; i < 3; ++i) q[i] = angle[i];
  return true;
}

}  // namespace hapticd::control
