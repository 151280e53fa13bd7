// The matrices of control/coupling/group.h. With the rows of coupled coordinates c and of direct
// ones d, E's D_E and C_E on all of them, the proxies balance as
//
//   Z (y_c - x_free,c) = F_c + push_c - D_cc y_c - D_cd y_d - C_c eta,      y_d = x_free,d
//
// so hold = Z + D_cc, give = hold^-1, reach = (give Z, -give D_cd; 0, 1), sway = give C_c,
// rest = give push_c.
#include <Eigen/Dense>
#include <algorithm>
#include <utility>

#include "control/build/eigen.h"
#include "control/build/grouping.h"
#include "control/scene/encounter.h"

namespace hapticd::build {
namespace {

using control::GroupPlan;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Indices = std::vector<Index>;

/// Rows of the group's coordinates, by contact.
std::vector<std::uint32_t> rows_of(const GroupsSpec& spec, const TiedContacts& tied) {
  std::vector<std::uint32_t> rows;
  for (const std::uint16_t contact : tied.contacts)
    for (std::uint32_t i = 0; i < spec.contacts[contact].coordinates; ++i)
      rows.push_back(spec.contacts[contact].first_coordinate + i);
  return rows;
}

Indices indices(const std::vector<std::uint32_t>& coordinates,
                const std::vector<std::uint32_t>& rows) {
  Indices result;
  for (const std::uint32_t coordinate : coordinates)
    result.push_back(std::ranges::find(rows, coordinate) - rows.begin());
  return result;
}

/// Of a symmetric matrix > 0.
MatrixXd inverse(const MatrixXd& matrix) {
  return symmetric(matrix.llt().solve(MatrixXd::Identity(matrix.rows(), matrix.rows())));
}

/// V over the group's m rows: d = lag xi - Z^-1 f; rows of direct coordinates are zero.
struct Coupling {
  MatrixXd Z, lag, recall, learn, stiffness, damping;
  Indices coupled;
  bool remembers_stretch = false;
};

/// V = (K + B sigma)^-1 with the last stretch as its state: A = C = Z^-1 B/T, B = D = Z^-1.
CouplingBlock::StateSpace as_state_space(const CouplingBlock& block, double period_s) {
  const MatrixXd damping = symmetric(dense(block.damping)) / period_s;
  const MatrixXd D = inverse(symmetric(dense(block.stiffness)) + damping);
  if (damping.isZero(0)) return {.A = {}, .B = {}, .C = {}, .D = plain(D)};
  const Matrix carry = plain(D * damping);
  return {.A = carry, .B = plain(D), .C = carry, .D = plain(D)};
}

void append_memory(Coupling& all, const CouplingBlock::StateSpace& v, const Indices& rows) {
  const Index m = all.Z.rows(), before = all.recall.rows();
  const Index n = before + static_cast<Index>(v.A.rows);
  all.recall.conservativeResizeLike(MatrixXd::Zero(n, n));
  all.learn.conservativeResizeLike(MatrixXd::Zero(n, m));
  all.lag.conservativeResizeLike(MatrixXd::Zero(m, n));
  if (n == before) return;
  const auto own = Eigen::seq(before, n - 1);
  all.recall(own, own) = dense(v.A);
  all.learn(own, rows) = dense(v.B);
  all.lag(rows, own) = dense(v.C);
}

Coupling general_coupling(Coupling all, const std::vector<CouplingBlock>& blocks,
                          const std::vector<std::uint32_t>& rows, double period_s) {
  for (const CouplingBlock& block : blocks) {
    const CouplingBlock::StateSpace v =
        block.state_space ? *block.state_space : as_state_space(block, period_s);
    const Indices own = indices(block.coordinates, rows);
    all.Z(own, own) = inverse(symmetric(dense(v.D)));
    append_memory(all, v, own);
  }
  return all;
}

/// K, B and Z = K + B/T of the blocks that are springs and dampers.
Coupling springs_and_dampers(const std::vector<CouplingBlock>& blocks,
                             const std::vector<std::uint32_t>& rows, double period_s) {
  const auto m = static_cast<Index>(rows.size());
  Coupling all;
  all.stiffness = all.damping = MatrixXd::Zero(m, m);
  all.lag.resize(m, 0);
  all.learn.resize(0, m);
  for (const CouplingBlock& block : blocks) {
    const Indices own = indices(block.coordinates, rows);
    all.coupled.insert(all.coupled.end(), own.begin(), own.end());
    if (block.state_space) continue;
    all.stiffness(own, own) = symmetric(dense(block.stiffness));
    all.damping(own, own) = symmetric(dense(block.damping));
  }
  std::ranges::sort(all.coupled);
  all.Z = all.stiffness + all.damping / period_s;
  return all;
}

Coupling coupling_of(const std::vector<CouplingBlock>& blocks,
                     const std::vector<std::uint32_t>& rows, double period_s) {
  Coupling all = springs_and_dampers(blocks, rows, period_s);
  if (std::ranges::any_of(blocks, [](const auto& block) { return block.state_space.has_value(); }))
    return general_coupling(std::move(all), blocks, rows, period_s);
  if (all.damping.isZero(0)) return all;
  all.remembers_stretch = true;
  all.lag = MatrixXd::Zero(all.Z.rows(), all.Z.rows());
  const Indices& c = all.coupled;
  all.lag(c, c) = inverse(all.Z(c, c)) * all.damping(c, c) / period_s;
  return all;
}

/// E on the group's rows.
struct Environment {
  MatrixXd A, B, C, D, start_gain;
  VectorXd push, drift, start_offset;
};

VectorXd vector(const std::vector<double>& values) {
  return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

Environment environment_of(const GroupsSpec& spec, const TiedContacts& tied,
                           const std::vector<std::uint32_t>& rows) {
  const LinearScene scene =
      linear_scene(tied.networks, spec.period_s, spec.integrator, spec.substeps);
  const Indices touched = indices(scene.coordinates, rows);
  const auto m = static_cast<Index>(rows.size()), p = static_cast<Index>(scene.A.rows);
  Environment e;
  e.A = dense(scene.A);
  e.B = e.start_gain = MatrixXd::Zero(p, m);
  e.C = MatrixXd::Zero(m, p);
  e.D = MatrixXd::Zero(m, m);
  e.push = VectorXd::Zero(m);
  e.drift = vector(scene.drift);
  e.start_offset = vector(scene.start_offset);
  e.B(Eigen::all, touched) = dense(scene.B);
  e.start_gain(Eigen::all, touched) = dense(scene.start_gain);
  e.C(touched, Eigen::all) = dense(scene.C);
  e.D(touched, touched) = dense(scene.D);
  e.push(touched) = vector(scene.push);
  return e;
}

/// Puts matrices into the plan's gains. What is zero throughout is no term.
class Store {
 public:
  explicit Store(std::vector<double>& gains) : gains_(gains) {}
  control::Gain always(const MatrixXd& matrix) {
    const Matrix rows = plain(matrix);
    const control::Gain gain{.offset = static_cast<std::uint32_t>(gains_.size()),
                             .rows = static_cast<std::uint16_t>(rows.rows),
                             .columns = static_cast<std::uint16_t>(rows.columns)};
    gains_.insert(gains_.end(), rows.values.begin(), rows.values.end());
    return gain;
  }
  control::Gain term(const MatrixXd& matrix) {
    return matrix.isZero(0) ? control::Gain{} : always(matrix);
  }

 private:
  std::vector<double>& gains_;
};

void fold_coupling(GroupPlan& group, const Coupling& coupling, const MatrixXd& give,
                   const MatrixXd& hold, Store& store) {
  group.memory = static_cast<std::uint16_t>(coupling.lag.cols());
  group.remembers_stretch = coupling.remembers_stretch;
  group.lag = store.term(coupling.lag);
  group.recall = store.term(coupling.recall);
  group.learn = store.term(coupling.learn);
  group.give = store.always(give);
  group.hold = store.always(hold);
  group.stiffness = store.term(coupling.stiffness);
  group.damping = store.term(coupling.damping);
}

void fold_environment(GroupPlan& group, const Environment& e, const Coupling& coupling,
                      const MatrixXd& give, Store& store) {
  const Index m = e.D.rows();
  MatrixXd reach = give * coupling.Z;
  MatrixXd is_direct = MatrixXd::Identity(m, m);
  for (const Index i : coupling.coupled) is_direct(i, i) = 0;
  reach += is_direct - give * e.D * is_direct;
  group.states = static_cast<std::uint16_t>(e.A.rows());
  if (!coupling.coupled.empty()) group.reach = store.always(reach);
  group.sway = store.term(give * e.C);
  group.rest = store.term(give * e.push);
  group.push = store.term(e.push);
  group.pull = store.always(e.D);
  group.swing = store.term(e.C);
  group.sway_on = store.term(e.A);
  group.drive = store.term(e.B);
  group.drift = store.term(e.drift);
}

GroupPlan fold_group(const GroupsSpec& spec, const TiedContacts& tied, Groups& all) {
  const std::vector<std::uint32_t> rows = rows_of(spec, tied);
  const Coupling coupling = coupling_of(tied.blocks, rows, spec.period_s);
  const Environment e = environment_of(spec, tied, rows);
  const auto m = static_cast<Index>(rows.size());
  const Indices& c = coupling.coupled;
  MatrixXd hold = MatrixXd::Zero(m, m), give = hold;
  hold(c, c) = coupling.Z(c, c) + e.D(c, c);
  give(c, c) = inverse(hold(c, c));

  GroupPlan group;
  group.first_contact = static_cast<std::uint32_t>(all.group_contacts.size());
  group.contacts = static_cast<std::uint16_t>(tied.contacts.size());
  group.coordinates = static_cast<std::uint16_t>(rows.size());
  group.first_memory = static_cast<std::uint32_t>(all.memory);
  group.first_state = static_cast<std::uint32_t>(all.states);
  group.max_sweeps = spec.max_sweeps;
  group.tolerance = spec.tolerance;
  // Several steps of backward Euler within a period are passive each, not in what the period samples.
  group.passive_network = tied.networks.empty() ||
                          (spec.integrator == Integrator::backward_euler && spec.substeps == 1);
  for (const std::uint16_t contact : tied.contacts)
    if (!spec.sharpen.empty()) group.sharpen = std::max(group.sharpen, spec.sharpen[contact]);
  Store store(all.gains);
  fold_coupling(group, coupling, give, hold, store);
  if (!tied.networks.empty()) fold_environment(group, e, coupling, give, store);
  all.start_offset.insert(all.start_offset.end(), e.start_offset.begin(), e.start_offset.end());
  all.start_gain.push_back(plain(e.start_gain));
  return group;
}

}  // namespace

Groups fold(const GroupsSpec& spec) {
  Groups all;
  all.group_of.assign(spec.contacts.size(), control::ContactPlan::kNoGroup);
  for (const TiedContacts& tied : tied_contacts(spec)) {
    const GroupPlan group = fold_group(spec, tied, all);
    for (const std::uint16_t contact : tied.contacts)
      all.group_of[contact] = static_cast<std::uint16_t>(all.groups.size());
    all.group_contacts.insert(all.group_contacts.end(), tied.contacts.begin(), tied.contacts.end());
    all.memory += group.memory;
    all.states += group.states;
    all.groups.push_back(group);
  }
  return all;
}

}  // namespace hapticd::build
