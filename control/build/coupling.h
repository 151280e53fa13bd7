// Couplings, networks and contacts -> groups with folded gains (control/coupling/group.h).
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "control/build/network.h"
#include "control/coupling/group.h"

namespace hapticd::build {

/// One block of the coupling, over coordinates of any contacts: K and B (symmetric; K > 0 and
/// K + B/T > 0; B may be slightly negative), or a general V(z) = (A, B, C, D) with D = D' > 0.
struct CouplingBlock {
  std::vector<std::uint32_t> coordinates;  ///< ascending
  Matrix stiffness;                        ///< N/m
  Matrix damping;                          ///< N s/m
  struct StateSpace {
    Matrix A, B, C, D;  ///< n x n, n x m, m x n, m x m; D in m/N, C and B so that C xi is in m
  };
  std::optional<StateSpace> state_space;  ///< instead of stiffness and damping
};

struct GroupsSpec {
  double period_s = 1e-3;
  std::vector<CouplingBlock> blocks;
  std::vector<Network> networks;
  Integrator integrator = Integrator::backward_euler;
  std::size_t substeps = 1;
  /// Of contact c: its coordinates are first_coordinate[c] .. + count[c].
  struct ContactRange {
    std::uint32_t first_coordinate = 0;
    std::uint16_t coordinates = 0;
  };
  std::vector<ContactRange> contacts;
  std::uint16_t max_sweeps = 50;
  double tolerance = 1e-10;     ///< N
  std::vector<double> sharpen;  ///< per contact: g of Theorem A'; a group has its largest
};

struct Groups {
  std::vector<control::GroupPlan> groups;
  std::vector<std::uint16_t> group_contacts;  ///< contacts of each group, ascending
  std::vector<std::uint16_t> group_of;        ///< per contact; ContactPlan::kNoGroup: none
  std::vector<double> gains;
  std::size_t memory = 0;  ///< sizes of the state's arrays
  std::size_t states = 0;
  /// Per state: first value = offset + gain y(start), gains as in LinearScene::start_gain.
  std::vector<double> start_offset;
  std::vector<Matrix> start_gain;  ///< per group, p x m
};

/// What cannot be folded, for people; empty: sound. Names blocks by index: "block 2: ...".
std::string problem(const GroupsSpec& spec);

/// `problem(spec)` is empty. A group is a set of contacts tied by blocks or networks; contacts that
/// nothing names have no group.
Groups fold(const GroupsSpec& spec);

}  // namespace hapticd::build
