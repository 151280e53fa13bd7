// Groups as their folded gains say (control/coupling/group.h), and couplings with networks as their
// own equations say.
#pragma once
#include <utility>
#include <vector>

#include "tests/support/networks.h"

namespace hapticd::test {

struct Answer {
  VectorXd force, proxies;  ///< on the contacts; of the group's rows
};

/// The recursion of one group, bodies' forces F given.
class FoldedGroup {
 public:
  FoldedGroup(const build::Groups& groups, std::size_t index, const VectorXd& at)
      : groups_(groups), plan_(groups.groups[index]) {
    const auto p = static_cast<Index>(plan_.states);
    xi_ = VectorXd::Zero(plan_.memory);
    eta_ = eigen(groups.start_gain[index]) * at +
           eigen(groups.start_offset).segment(static_cast<Index>(plan_.first_state), p);
  }

  Answer tick(const VectorXd& x, const VectorXd& bodies) {
    const Index m = plan_.coordinates, n = plan_.memory, p = plan_.states;
    const VectorXd x_free = x - gain(plan_.lag, m, n) * xi_;
    VectorXd y0 = x_free;
    if (!plan_.reach.empty())
      y0 =
          gain(plan_.reach, m, m) * x_free - gain(plan_.sway, m, p) * eta_ + gain(plan_.rest, m, 1);
    const VectorXd y = y0 + gain(plan_.give, m, m) * bodies;
    const VectorXd f = bodies + gain(plan_.push, m, 1) - gain(plan_.pull, m, m) * y -
                       gain(plan_.swing, m, p) * eta_;
    if (plan_.remembers_stretch)
      xi_ = x - y;
    else
      xi_ = (gain(plan_.recall, n, n) * xi_ - gain(plan_.learn, n, m) * f).eval();
    eta_ =
        (gain(plan_.sway_on, p, p) * eta_ + gain(plan_.drive, p, m) * y + gain(plan_.drift, p, 1))
            .eval();
    return {f, y};
  }

  MatrixXd gain(const control::Gain& of, Index rows, Index columns) const {
    if (of.empty()) return MatrixXd::Zero(rows, columns);
    EXPECT_EQ(of.rows, rows);
    EXPECT_EQ(of.columns, columns);
    build::Matrix result{.rows = of.rows, .columns = of.columns, .values = {}};
    const auto begin = groups_.gains.begin() + of.offset;
    result.values.assign(begin, begin + of.rows * of.columns);
    return eigen(result);
  }

 private:
  const build::Groups& groups_;
  const control::GroupPlan& plan_;
  VectorXd xi_, eta_;
};

/// Couplings and networks in backward Euler, all unknowns of a tick in one system: proxies, nodes
/// and each coupling's pull on its proxies.
class LongHand {
 public:
  LongHand(const build::GroupsSpec& spec, const VectorXd& at) : spec_(spec), stretch_(0 * at) {
    for (const auto& network : spec.networks) networks_.emplace_back(network, spec.period_s, at);
    for (const auto& block : spec.blocks)
      memory_.push_back(
          VectorXd::Zero(block.state_space ? static_cast<Index>(block.state_space->A.rows) : 0));
  }

  Answer tick(const VectorXd& x, const VectorXd& bodies) {
    const Index m = x.size();
    Index size = 2 * m;
    for (const auto& network : networks_) size += network.nodes.size();
    const VectorXd z =
        root_of(size, [&](const VectorXd& at) { return miss(at, x, bodies).unbalanced; });
    const Miss found = miss(z, x, bodies);
    const VectorXd y = z.head(m), pulls = z.segment(m, m);
    remember(z, x - y, pulls);
    return {bodies - found.on_contacts, y};
  }

 private:
  struct Miss {
    VectorXd unbalanced, on_contacts;
  };

  static std::vector<Index> rows(const build::CouplingBlock& block) {
    return {block.coordinates.begin(), block.coordinates.end()};
  }

  Miss miss(const VectorXd& z, const VectorXd& x, const VectorXd& bodies) const {
    const Index m = x.size();
    const VectorXd y = z.head(m), pulls = z.segment(m, m), d = x - y;
    VectorXd result = VectorXd::Zero(z.size()), on_contacts = VectorXd::Zero(m);
    Index first = 2 * m;
    for (const auto& network : networks_) {
      const Index n = network.nodes.size();
      VectorXd on_nodes = VectorXd::Zero(n);
      network.add_forces(y, z.segment(first, n), on_contacts, on_nodes);
      result.segment(first, n) = on_nodes;
      first += n;
    }
    result.head(m) = d;            // without coupling the proxy is the contact
    result.segment(m, m) = pulls;  // and nothing pulls
    for (std::size_t b = 0; b < spec_.blocks.size(); ++b) {
      const auto own = rows(spec_.blocks[b]);
      const VectorXd pull = pulls(own), net = on_contacts(own), given = bodies(own);
      result(own) = given - net + pull;
      VectorXd law = pull;
      if (const auto& v = spec_.blocks[b].state_space)
        law = d(own) - eigen(v->C) * memory_[b] - eigen(v->D) * pull;
      else
        law = pull - eigen(spec_.blocks[b].stiffness) * d(own) -
              eigen(spec_.blocks[b].damping) * (d(own) - stretch_(own)) / spec_.period_s;
      for (std::size_t i = 0; i < own.size(); ++i) result(m + own[i]) = law(static_cast<Index>(i));
    }
    return {result, on_contacts};
  }

  void remember(const VectorXd& z, const VectorXd& stretch, const VectorXd& pulls) {
    const Index m = stretch.size();
    Index first = 2 * m;
    for (auto& network : networks_) {
      const Index n = network.nodes.size();
      network.accept(z.head(m), z.segment(first, n));
      first += n;
    }
    stretch_ = stretch;
    for (std::size_t b = 0; b < memory_.size(); ++b)
      if (const auto& v = spec_.blocks[b].state_space)
        memory_[b] = (eigen(v->A) * memory_[b] + eigen(v->B) * pulls(rows(spec_.blocks[b]))).eval();
  }

  const build::GroupsSpec& spec_;
  std::vector<LongHandNetwork> networks_;
  VectorXd stretch_;
  std::vector<VectorXd> memory_;
};

}  // namespace hapticd::test
