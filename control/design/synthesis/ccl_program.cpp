#include "control/design/synthesis/ccl_program.h"

#include <Eigen/Dense>
#include <algorithm>

#include "control/design/synthesis/balance.h"
#include "control/design/synthesis/lmi_levels.h"

namespace hapticd::synthesis {

using Eigen::Index;

namespace {

double unit_of(const HapticLoop& loop, const CclOptions& options) {
  if (options.unit_Ns_m > 0) return options.unit_Ns_m;
  return loop.device_level.trace() / static_cast<double>(loop.device_level.rows());
}

/// Which entries of a matrix over the coordinates, and over states and coordinates of V-hat, couple
/// nothing that the form keeps apart.
struct Patterns {
  Pattern levels, states;
};

Patterns patterns(const Form& form, Index m, Storages storages) {
  const Index n = order(form);
  const bool full = storages == Storages::full;
  Patterns p{Pattern::Constant(m, m, full), Pattern::Constant(n + m, n + m, full)};
  Index state = 0;
  for (const FormBlock& block : form) {
    std::vector<Index> members;
    const Index own =
        block.spring_damper ? static_cast<Index>(block.coordinates.size()) : block.order;
    for (Index k = 0; k < own; ++k) members.push_back(state + k);
    for (const Index i : block.coordinates) members.push_back(n + i);
    for (const Index i : members) {
      for (const Index j : members) {
        p.states(i, j) = true;
        if (i >= n && j >= n) p.levels(i - n, j - n) = true;
      }
    }
    state += own;
  }
  return p;
}

Affine identity(Index n) {
  return Affine(Matrix::Identity(n, n));
}

/// Adds one inequality for each set of rows that nothing ties together.
void at_least_by_parts(Lmi& lmi, const Affine& a, double shift) {
  std::vector<Index> part(static_cast<std::size_t>(a.rows()));
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = static_cast<Index>(i);
  const auto root = [&](Index i) {
    while (part[static_cast<std::size_t>(i)] != i) i = part[static_cast<std::size_t>(i)];
    return i;
  };
  for (const Affine::Term& t : a.terms()) {
    const Index i = root(t.row), j = root(t.column);
    part[static_cast<std::size_t>(std::max(i, j))] = std::min(i, j);
  }
  std::vector<Index> place(part.size()), size(part.size(), 0);
  for (std::size_t i = 0; i < part.size(); ++i) {
    place[i] = size[static_cast<std::size_t>(root(static_cast<Index>(i)))]++;
  }
  std::vector<Affine> parts;
  for (const Index rows : size) parts.emplace_back(rows, rows);
  for (const Affine::Term& t : a.terms()) {
    parts[static_cast<std::size_t>(root(t.row))].add(
        t.variable, place[static_cast<std::size_t>(t.row)],
        place[static_cast<std::size_t>(t.column)], t.value);
  }
  for (const Affine& block : parts) {
    if (block.rows() > 0) lmi.at_least(block, shift);
  }
}

}  // namespace

CclProgram::CclProgram(const HapticLoop& loop, const Form& form, const CclOptions& options)
    : options_(options), form_{Affine(0, 0), Affine(0, 0), Affine(0, 0), Affine(0, 0)} {
  const Index m = loop.device_level.rows();
  if (!covers(form, m)) {
    problem_ = "the form of the coupling does not name every coordinate once";
    return;
  }
  if (!(check::smallest_eigenvalue(loop.device_level) > 0)) {
    problem_ = "the device has no damping";
    return;
  }
  unit_ = unit_of(loop, options);
  form_ = variables(lmi_, form, m);
  const auto [levels, states] = patterns(form, m, options.storages);
  const Affine phi = lmi_.symmetric(levels), delta = lmi_.symmetric(levels);
  scene(loop, phi, delta);
  if (problem_.empty()) coupling(loop, delta, levels, states);
}

void CclProgram::scene(const HapticLoop& loop, const Affine& phi, const Affine& delta) {
  const auto small =
      balanced(check::scaled(without_integrator(loop.scene, loop.period_s), 1 / unit_));
  if (!small) {
    problem_ = "the scene has a pole that is not inside the unit circle";
    return;
  }
  const Affine p = lmi_.symmetric(small->states());
  lmi_.at_least(passive_matrix(*small, p, -1.0 * phi), options_.shift);
  if (small->states() > 0) lmi_.at_least(p, options_.shift);
  const Affine device(loop.device_level / unit_);
  at_least_by_parts(lmi_, symmetric_blocks({{device - phi, -1.0 * phi}, {delta - phi}}),
                    options_.shift);
}

void CclProgram::coupling(const HapticLoop& loop, const Affine& delta, const Pattern& levels,
                          const Pattern& states) {
  const Index m = delta.rows(), n = form_.a.rows();
  const Affine k(0.5 * unit_ * loop.device_level.inverse());
  const Affine a = blocks({{form_.a, -1.0 * form_.b}, {Affine(m, n), Affine(m, m)}});
  const Affine b = blocks({{form_.b}, {identity(m)}});
  const Affine c = blocks({{form_.c, k - form_.d}});
  const Affine d = form_.d - k;
  const Affine sigma = lmi_.symmetric(levels), q = lmi_.symmetric(states),
               y = lmi_.symmetric(states);
  const Affine lemma = symmetric_blocks({{y, 0.5 * c.transpose(), a.transpose(), c.transpose()},
                                         {0.5 * twice_symmetric(d), b.transpose(), d.transpose()},
                                         {q, Affine(n + m, m)},
                                         {sigma}});
  at_least_by_parts(lmi_, lemma, options_.shift);
  complementary(sigma, delta);
  complementary(q, y);
}

void CclProgram::complementary(const Affine& w, const Affine& z) {
  const Index n = w.rows();
  at_least_by_parts(lmi_, symmetric_blocks({{w, identity(n)}, {z}}), options_.shift);
  pairs_.push_back({w, z, Matrix::Identity(n, n), Matrix::Identity(n, n)});
}

SdpAnswer CclProgram::step(const Affine* cost, double weight) {
  Lmi lmi = lmi_;
  for (const Complementary& pair : pairs_) {
    lmi.minimise(pair.w_last, pair.z);
    lmi.minimise(pair.z_last, pair.w);
  }
  const Vector traces = lmi.problem().cost;
  if (cost != nullptr) lmi.minimise(weight * Matrix::Identity(cost->rows(), cost->rows()), *cost);
  SdpAnswer answer = lmi.solve(options_.solver);
  if (answer.x.size() == 0 || answer.infeasible) return answer;
  answer.objective = traces.dot(answer.x);
  complementarity_ = 0;
  for (Complementary& pair : pairs_) {
    pair.w_last = pair.w.at(answer.x);
    pair.z_last = pair.z.at(answer.x);
    const Index n = pair.w_last.rows();
    const Matrix off = pair.w_last * pair.z_last - Matrix::Identity(n, n);
    complementarity_ = std::max(complementarity_, algebra::singular_values(off)[0]);
  }
  return answer;
}

}  // namespace hapticd::synthesis
