#include "config/linkage_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticd::config {

control::LinearMap linear_map(const Cartesian& cartesian) {
  control::LinearMap map;
  for (std::size_t axis = 0; axis < cartesian.directions.size(); ++axis)
    map.columns[static_cast<std::size_t>(cartesian.directions[axis])][axis] = 1;
  return map;
}

control::FiveBar five_bar(const FiveBar& bars) {
  return {.link_m = bars.link_m, .base_m = bars.base_m};
}

control::Delta delta(const Delta& legs) {
  control::Delta made{.a = legs.a_m,
                      .b = legs.b_m,
                      .c = legs.c_m,
                      .d = legs.d_m,
                      .e = legs.e_m,
                      .f = legs.f_m,
                      .r = legs.r_m,
                      .s = legs.s_m,
                      .home = legs.home_m};
  for (std::size_t i = 0; i < made.leg.size(); ++i) {
    const double angle_rad = legs.legs_deg[i] * std::numbers::pi / 180;
    made.leg[i] = {std::cos(angle_rad), std::sin(angle_rad)};
  }
  return made;
}

control::Serial serial(const Serial& chain) {
  control::Serial made{.joints = static_cast<std::uint16_t>(chain.joints.size())};
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const SerialJoint& joint = chain.joints[i];
    made.joint[i] = {.theta = joint.theta_rad,
                     .d = joint.d_m,
                     .a = joint.a_m,
                     .cos_twist = std::cos(joint.alpha_rad),
                     .sin_twist = std::sin(joint.alpha_rad),
                     .prismatic = joint.prismatic,
                     .mass = joint.mass_kg,
                     .center = joint.center_m};
  }
  return made;
}

bool has_mass(const Serial& chain) {
  return std::any_of(chain.joints.begin(), chain.joints.end(),
                     [](const SerialJoint& joint) { return joint.mass_kg > 0; });
}

}  // namespace hapticd::config
