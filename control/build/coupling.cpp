#include "control/build/coupling.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "control/build/eigen.h"
#include "control/core/algebra.h"
#include "control/core/capacity.h"

namespace hapticd::build {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kSymmetry = 1e-9;  ///< of the largest entry: what a file's digits may lose

std::string text(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                 std::chars_format::general, 6);
  return {digits.data(), end.ptr};
}

std::string size_text(std::size_t rows, std::size_t columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

/// `name` is a matrix of that size and of finite numbers.
std::string matrix_problem(const Matrix& matrix, const std::string& name, std::size_t rows,
                           std::size_t columns) {
  if (matrix.rows != rows || matrix.columns != columns || matrix.values.size() != rows * columns)
    return name + " is " + size_text(matrix.rows, matrix.columns) + "; expected " +
           size_text(rows, columns);
  if (!std::ranges::all_of(matrix.values, [](double value) { return std::isfinite(value); }))
    return name + " has an entry that is not finite";
  return {};
}

std::string symmetry_problem(const Matrix& matrix, const std::string& name) {
  const MatrixXd full = dense(matrix);
  const double largest = full.cwiseAbs().maxCoeff();
  Index i = 0, j = 0;
  const double off = (full - full.transpose()).cwiseAbs().maxCoeff(&i, &j);
  if (off <= kSymmetry * largest) return {};
  return name + " is not symmetric: entry (" + std::to_string(i) + ", " + std::to_string(j) +
         ") is " + text(full(i, j)) + ", its mirror " + text(full(j, i));
}

/// Of symmetric ones. `hint` is what to do.
std::string definiteness_problem(const MatrixXd& matrix, const std::string& name,
                                 const std::string& hint) {
  const Eigen::VectorXd values = algebra::symmetric_eigenvalues(symmetric(matrix));
  const double lowest = values.minCoeff();
  if (lowest > 1e-14 * values.cwiseAbs().maxCoeff()) return {};
  return name + " is not positive definite: its smallest eigenvalue is " + text(lowest) + "; " +
         hint;
}

template <typename... Checks>
std::string first_of(const Checks&... checks) {
  std::string found;
  static_cast<void>(((found = checks(), !found.empty()) || ...));
  return found;
}

std::string spring_problem(const CouplingBlock& block, double period_s) {
  const std::size_t m = block.coordinates.size();
  return first_of([&] { return matrix_problem(block.stiffness, "the stiffness", m, m); },
                  [&] { return matrix_problem(block.damping, "the damping", m, m); },
                  [&] { return symmetry_problem(block.stiffness, "the stiffness"); },
                  [&] { return symmetry_problem(block.damping, "the damping"); },
                  [&] {
                    return definiteness_problem(
                        dense(block.stiffness), "the stiffness [N/m]",
                        "a spring that pushes outward holds nothing: make it stiffer");
                  },
                  // V's own pole, Z^-1 B/T, is inside the unit circle; Z = K + B/T > 0 follows.
                  [&] {
                    return definiteness_problem(
                        dense(block.stiffness) + 2 / period_s * dense(block.damping),
                        "stiffness + 2 damping/T [N/m]",
                        "the coupling would ring by itself: make the damping less negative");
                  });
}

std::string pole_problem(const Matrix& A) {
  if (A.rows == 0) return {};
  const double largest = algebra::eigenvalues(dense(A)).cwiseAbs().maxCoeff();
  if (largest < 1) return {};
  return "its A is not stable: the largest eigenvalue has the size " + text(largest) +
         "; expected less than 1";
}

std::string state_space_problem(const CouplingBlock::StateSpace& v, std::size_t m) {
  const std::size_t n = v.A.rows;
  return first_of([&] { return matrix_problem(v.A, "A", n, n); },
                  [&] { return matrix_problem(v.B, "B", n, m); },
                  [&] { return matrix_problem(v.C, "C", m, n); },
                  [&] { return matrix_problem(v.D, "D", m, m); },
                  [&] { return symmetry_problem(v.D, "D"); },
                  [&] {
                    return definiteness_problem(dense(v.D), "D [m/N]",
                                                "a coupling must yield to a force at once");
                  },
                  [&] { return pole_problem(v.A); });
}

std::set<std::uint32_t> coordinates_of(const GroupsSpec& spec) {
  std::set<std::uint32_t> found;
  for (const auto& contact : spec.contacts)
    for (std::uint32_t i = 0; i < contact.coordinates; ++i)
      found.insert(contact.first_coordinate + i);
  return found;
}

std::string naming_problem(const GroupsSpec& spec) {
  const std::set<std::uint32_t> known = coordinates_of(spec);
  std::map<std::uint32_t, std::size_t> owner;
  for (std::size_t b = 0; b < spec.blocks.size(); ++b) {
    const std::string here = "block " + std::to_string(b) + ": ";
    if (spec.blocks[b].coordinates.empty()) return here + "it names no coordinate";
    for (const std::uint32_t coordinate : spec.blocks[b].coordinates) {
      const std::string named = here + "coordinate " + std::to_string(coordinate);
      if (!known.contains(coordinate)) return named + " belongs to no contact";
      const auto [at, is_new] = owner.emplace(coordinate, b);
      if (is_new) continue;
      if (at->second == b) return named + " is named twice";
      return named + " is in block " + std::to_string(at->second) +
             " too; a coordinate has one coupling";
    }
  }
  return {};
}

std::string block_problem(const GroupsSpec& spec) {
  for (std::size_t b = 0; b < spec.blocks.size(); ++b) {
    const CouplingBlock& block = spec.blocks[b];
    const std::string found =
        block.state_space ? state_space_problem(*block.state_space, block.coordinates.size())
                          : spring_problem(block, spec.period_s);
    if (!found.empty()) return "block " + std::to_string(b) + ": " + found;
  }
  return {};
}

std::string frame_problem(const GroupsSpec& spec) {
  if (!(spec.period_s > 0) || !std::isfinite(spec.period_s))
    return "the period is " + text(spec.period_s) + " s; expected more than 0";
  if (spec.substeps == 0) return "a network takes at least 1 step per period";
  if (!spec.sharpen.empty() && spec.sharpen.size() != spec.contacts.size())
    return "there are " + std::to_string(spec.sharpen.size()) + " latency shares for " +
           std::to_string(spec.contacts.size()) + " contacts";
  return {};
}

std::string network_problem(const GroupsSpec& spec) {
  const std::set<std::uint32_t> known = coordinates_of(spec);
  const std::string found = problem(spec.networks, known.empty() ? 0 : *known.rbegin() + 1);
  if (!found.empty()) return found;
  for (std::size_t n = 0; n < spec.networks.size(); ++n)
    for (const NetworkElement& element : spec.networks[n].elements)
      for (const NetworkEnd end : {element.a, element.b})
        if (end.at == NetworkEnd::At::coordinate && !known.contains(end.index))
          return "network " + std::to_string(n) + ": coordinate " + std::to_string(end.index) +
                 " belongs to no contact";
  return {};
}

/// Backward Euler's D_E is >= 0; that of others need not be.
std::string hold_problem(const Groups& groups, const control::GroupPlan& group) {
  const std::size_t m = group.coordinates;
  Matrix hold{.rows = m, .columns = m, .values = {}};
  const auto begin = groups.gains.begin() + group.hold.offset;
  hold.values.assign(begin, begin + group.hold.rows * group.hold.columns);
  for (std::size_t i = 0; i < m; ++i)
    if (hold(i, i) == 0) hold(i, i) = 1;  // direct: no coupling has to hold it
  return definiteness_problem(dense(hold), "coupling and network together [N/m]",
                              "the network swings faster than a tick: take backward_euler");
}

std::string size_problem(const control::GroupPlan& group) {
  const auto limit = std::to_string(kMaxGroupStates);
  if (group.coordinates > kMaxCoordinates)
    return "they have " + std::to_string(group.coordinates) + " coordinates; expected at most " +
           std::to_string(kMaxCoordinates);
  if (group.states > kMaxGroupStates)
    return "their networks have " + std::to_string(group.states) + " states; expected at most " +
           limit + ": use fewer masses or dampers";
  if (group.memory > kMaxGroupStates)
    return "their coupling has " + std::to_string(group.memory) + " states; expected at most " +
           limit + ": use a smaller A";
  return {};
}

std::string group_problem(const GroupsSpec& spec) {
  const Groups groups = fold(spec);
  for (const control::GroupPlan& group : groups.groups) {
    const std::string found =
        first_of([&] { return size_problem(group); }, [&] { return hold_problem(groups, group); });
    if (!found.empty())
      return "the contacts that are tied to contact " +
             std::to_string(groups.group_contacts[group.first_contact]) + ": " + found;
  }
  return {};
}

}  // namespace

std::string problem(const GroupsSpec& spec) {
  return first_of([&] { return frame_problem(spec); }, [&] { return naming_problem(spec); },
                  [&] { return block_problem(spec); }, [&] { return network_problem(spec); },
                  [&] { return group_problem(spec); });
}

}  // namespace hapticd::build
