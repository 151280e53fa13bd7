// Latency takes away from what a descent step may leave: the check is sharpened (Theorem A'). With
// a coupling without damping and latency tau of at most one period T
//
//   g = tau/T + tau (T - tau) lambda / T,    lambda = lambda_max(Delta^-1 K) [1/s],    0 <= g <= 1
//
// Delta the least damping of the devices, in contact coordinates: Delta^-1 = J D_q^-1 J'. Springs at
// the ends of travel take of it, too, and on a linkage it depends on the pose: then lambda is the
// fastest rate that any proof allows. All of a group counts together; 0 where the theorem does not
// apply, or nobody knows the damping.
#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "config/compilation.h"
#include "config/coordinates.h"
#include "config/device_groups.h"
#include "config/matrices.h"
#include "control/core/algebra.h"
#include "control/design/check/weights.h"

namespace hapticd::config {
namespace {

using Eigen::MatrixXd;

Eigen::Index index_of_size(std::size_t n) {
  return static_cast<Eigen::Index>(n);
}

bool is_linkage(const DevicePlace& place) {
  return !std::holds_alternative<Cartesian>(place.device.kinematics);
}

/// Delta^-1 of one device [m/(N s)], over all of its coordinates; of a linkage, which has none for all poses, 0.
std::optional<MatrixXd> mobility(const DevicePlace& place) {
  const std::size_t n = place.frame.directions.size();
  MatrixXd made = MatrixXd::Zero(index_of_size(n), index_of_size(n));
  if (is_linkage(place)) return made;
  for (std::size_t a = 0; a < place.axes.size(); ++a) {
    if (!place.axes[a].model || !(place.axes[a].model->least_damping() > 0)) return {};
    Eigen::VectorXd column(index_of_size(n));  // of J
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3 turn = place.frame.turn(i);
      const Vector3& motion = place.frame.motions[a];
      column[index_of_size(i)] = turn[0] * motion[0] + turn[1] * motion[1] + turn[2] * motion[2];
    }
    made += column * column.transpose() / place.axes[a].model->least_damping();
  }
  return made;
}

bool is_plain_spring(const build::CouplingBlock& block) {
  const std::vector<double>& damping = block.damping.values;
  return !block.state_space &&
         std::all_of(damping.begin(), damping.end(), [](double b) { return b == 0; });
}

/// K and Delta^-1 of one group, over the coordinates of all of its devices.
struct GroupMatrices {
  MatrixXd K, inverse_damping;
  bool linkage = false;  ///< among its devices
};

std::optional<GroupMatrices> group_matrices(const Compilation& compilation,
                                            const std::vector<DevicePlace>& places,
                                            const std::vector<std::size_t>& groups,
                                            std::size_t group) {
  const std::size_t n = compilation.spec.coordinate_names.size();
  GroupMatrices made{.K = MatrixXd::Zero(index_of_size(n), index_of_size(n)),
                     .inverse_damping = MatrixXd::Zero(index_of_size(n), index_of_size(n))};
  for (const DevicePlace& place : places) {
    if (groups[place.index] != group) continue;
    made.linkage = made.linkage || is_linkage(place);
    const auto own = mobility(place);
    if (!own) return {};
    made.inverse_damping.block(place.first_coordinate, place.first_coordinate, own->rows(),
                               own->cols()) = *own;
  }
  for (const build::CouplingBlock& block : compilation.spec.coupling) {
    if (groups[device_of(compilation, block.coordinates.front())] != group) continue;
    if (!is_plain_spring(block)) return {};
    made.K(block.coordinates, block.coordinates) = to_eigen(block.stiffness);
  }
  return made;
}

/// lambda_max(Delta^-1 K) = that of the symmetric S K S with S S = Delta^-1.
double largest_rate(const GroupMatrices& group) {
  const algebra::SymmetricEigen eigen = algebra::symmetric_eigen(group.inverse_damping);
  const MatrixXd S = eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() *
                     eigen.vectors.transpose();
  return algebra::symmetric_eigenvalues(S * group.K * S).maxCoeff();
}

}  // namespace

void compile_sharpening(Compilation& compilation, const std::vector<DevicePlace>& places) {
  build::ProgramSpec& spec = compilation.spec;
  spec.sharpen.assign(spec.contacts.size(), 0);
  if (spec.coupling.empty()) return;
  const std::vector<std::size_t> groups = device_groups(compilation);
  for (std::size_t i = 0; i < spec.contacts.size(); ++i) {
    const double latency_s = places[i].device.latency_s;
    if (!(latency_s > 0)) continue;
    const auto group = group_matrices(compilation, places, groups, groups[i]);
    if (!group || latency_s > spec.period_s) continue;
    const bool known = spec.travels.empty() && !group->linkage;
    const double rate =
        known ? largest_rate(*group) : 1 / check::coupled_weight(latency_s, spec.period_s);
    if (rate > 0) spec.sharpen[i] = std::min(1.0, check::sharpness(latency_s, spec.period_s, rate));
  }
}

}  // namespace hapticd::config
