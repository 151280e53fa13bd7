// Planar five-bar with equal links l and bases `base` apart. E1, E2 are the elbows, P the tip,
// r_i = P - E_i the outer links:
//
//   D = E2 - E1,  h^2 = l^2 - |D|^2 / 4,  P = (E1 + E2) / 2 + h (-Dy, Dx) / |D|
//
// |r_i| = l for ever, so r_i . (P' - E_i') = 0 with E_i' = l (-sin q_i, cos q_i) q_i':
//
//   [r_1'; r_2'] P' = diag(r_i . dE_i/dq_i) q'
//
// whose determinant is r_1 x r_2 = |D| h = l^2 sin(angle between the outer links).
#include <cmath>

#include "control/kinematics/kinematics.h"

namespace hapticd::control {
namespace {

/// Outer links closer than this to one line (sine of the angle between them) hold the tip in one
/// direction only: no motor effort resists the other.
constexpr double kMinOuterSine = 1e-3;

}  // namespace

bool pose_of(const FiveBar& bars, const double* q, LinkagePose& pose) noexcept {
  const double l = bars.link_m;
  const double c1 = std::cos(q[0]), s1 = std::sin(q[0]);
  const double c2 = std::cos(q[1]), s2 = std::sin(q[1]);
  const double dx = bars.base_m + l * (c2 - c1), dy = l * (s2 - s1);
  const double apart2 = dx * dx + dy * dy, apart = std::sqrt(apart2);
  const double height = std::sqrt(l * l - apart2 / 4);  // NaN where the outer links cannot meet
  const double det = apart * height;
  if (!(det > kMinOuterSine * l * l)) return false;  // NaN fails too

  const double up_x = -height / apart * dy, up_y = height / apart * dx;
  const double r1x = up_x + dx / 2, r1y = up_y + dy / 2;
  const double r2x = up_x - dx / 2, r2y = up_y - dy / 2;
  const double drive1 = l * (r1y * c1 - r1x * s1) / det;
  const double drive2 = l * (r2y * c2 - r2x * s2) / det;
  pose.tip = {l * c1 + r1x - bars.base_m / 2, l * s1 + r1y, 0};
  pose.jacobian = {{{r2y * drive1, -r1y * drive2}, {-r2x * drive1, r1x * drive2}, {}}};
  return true;
}

// Each pair of links is an isosceles triangle over the line base to tip (length rho, direction
// phi): q_1 = phi_1 + alpha_1, q_2 = phi_2 - alpha_2, cos alpha = rho / 2l; the outer links point
// along phi_1 - alpha_1 and phi_2 + alpha_2. tip[2] is not looked at.
bool joints_of(const FiveBar& bars, const std::array<double, 3>& tip, double* q) noexcept {
  const double x1 = tip[0] + bars.base_m / 2, x2 = tip[0] - bars.base_m / 2;
  const double phi1 = std::atan2(tip[1], x1), phi2 = std::atan2(tip[1], x2);
  const double alpha1 = std::acos(std::hypot(x1, tip[1]) / (2 * bars.link_m));
  const double alpha2 = std::acos(std::hypot(x2, tip[1]) / (2 * bars.link_m));
  // NaN where a tip is out of reach, negative where it is on the lower branch.
  if (!(std::sin(phi2 + alpha2 - phi1 + alpha1) > kMinOuterSine)) return false;
  q[0] = phi1 + alpha1;
  q[1] = phi2 - alpha2;
  return true;
}

}  // namespace hapticd::control
