#include "control/design/check/tied_case.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cstdio>

#include "control/design/check/poses.h"

namespace hapticd::check {

TiedCase::TiedCase(const control::Plan& of, const std::vector<DeviceAssumption>& what,
                   const Tied& who)
    : plan(of),
      assumed(what),
      devices(who),
      needs(demand(of, who)),
      model(tied_model(of, who)),
      scene(behind(of, who)),
      damping(needs.travel.size()) {
  Eigen::Index joint = 0;
  for (const std::size_t d : devices) {
    for (const double least : assumed[d].min_damping) damping[joint++] = least;
    latency = std::max(latency, assumed[d].latency_s);
    jointed = jointed || is_jointed(plan, d);
    heavy = heavy || assumed[d].heavy_network;
  }
  // Of a body whose contact is held in part nothing but convexity is known.
  for (std::size_t c = 0; c < scene.weakness.size(); ++c)
    if (scene.weakness[c] > 0 && !std::ranges::binary_search(model.coordinates, c))
      scene.weakest = kForEver;
  // Coordinates of a network that no coupling holds ask for the exact test, whatever the rest is.
  plain = model.coordinates.empty() || !model.all_coupled || model.spring_damper;
  damped = !needs.coupled_damper.isZero(0);
  if (damped) {
    const double scale = needs.coupled_damper.norm();
    negative = smallest_eigenvalue(needs.coupled_damper) < -1e-12 * scale;
  }
}

std::string TiedCase::nonconvex() const {
  std::vector<std::string> labels;
  for (const std::size_t d : devices)
    for (const std::string& label : assumed[d].nonconvex)
      if (std::find(labels.begin(), labels.end(), label) == labels.end()) labels.push_back(label);
  std::string list;
  for (const std::string& label : labels) list += (list.empty() ? "" : ", ") + label;
  return list.empty() ? "an object" : list;
}

std::string TiedCase::names() const {
  std::string list;
  for (const std::size_t d : devices) list += (list.empty() ? "" : ", ") + assumed[d].name;
  return list;
}

Matrix TiedCase::beside(double weight) const {
  const Matrix j = constant_jacobian(plan, devices);
  Matrix sum = j.transpose() * (weight * needs.direct + needs.direct_damper) * j;
  sum.diagonal() += weight * needs.travel + needs.joint_damper;
  return sum;
}

Matrix TiedCase::weak_level() const {
  const auto m = static_cast<Eigen::Index>(model.coordinates.size());
  Matrix level = Matrix::Zero(m, m);
  for (Eigen::Index i = 0; i < m; ++i)
    level(i, i) =
        0.5 * plan.period_s * scene.weakness[model.coordinates[static_cast<std::size_t>(i)]];
  return level;
}

Matrix TiedCase::coupled_jacobian() const {
  const Matrix j = constant_jacobian(plan, devices);
  Matrix rows(static_cast<Eigen::Index>(model.coordinates.size()), j.cols());
  Eigen::Index row = 0, first = 0;
  for (const std::size_t d : devices) {
    const control::DevicePlan& device = plan.devices[d];
    for (const std::size_t coordinate : model.coordinates) {
      if (coordinate < device.first_coordinate ||
          coordinate >= std::size_t{device.first_coordinate} + device.coordinates)
        continue;
      rows.row(row++) = j.row(first + static_cast<Eigen::Index>(coordinate) -
                              static_cast<Eigen::Index>(device.first_coordinate));
    }
    first += device.coordinates;
  }
  return rows;
}

double share_of(const Matrix& demand, const Vector& damping) {
  const Vector scale = damping.array().rsqrt();
  return largest_eigenvalue(scale.asDiagonal() * demand * scale.asDiagonal());
}

std::string worded(const char* format, double a, double b, double c, double d) {
  char buffer[320];
  std::snprintf(buffer, sizeof buffer, format, a, b, c, d);
  return buffer;
}

}  // namespace hapticd::check
