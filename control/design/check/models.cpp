#include "control/design/check/models.h"

#include <Eigen/LU>
#include <algorithm>

namespace hapticd::check {
namespace {

using control::ContactPlan;
using control::Gain;
using control::GroupPlan;
using Eigen::Index;
using Indices = std::vector<Index>;

/// One group of a plan with its gains as matrices; a gain that is no term is zero.
class GroupGains {
 public:
  GroupGains(const control::Plan& plan, const GroupPlan& group) : plan_(plan), group_(group) {}

  Index m() const { return group_.coordinates; }
  Index memory() const { return group_.memory; }
  Index states() const { return group_.states; }

  Matrix of(const Gain& gain, Index rows, Index columns) const {
    if (gain.empty()) return Matrix::Zero(rows, columns);
    using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const ByRows>(plan_.gains.data() + gain.offset, rows, columns);
  }
  Matrix reach() const {
    return group_.reach.empty() ? Matrix::Identity(m(), m()) : of(group_.reach, m(), m());
  }
  Matrix lag() const { return of(group_.lag, m(), memory()); }
  Matrix hold() const { return of(group_.hold, m(), m()); }
  Matrix pull() const { return of(group_.pull, m(), m()); }

  System network() const {
    return {of(group_.sway_on, states(), states()), of(group_.drive, states(), m()),
            of(group_.swing, m(), states()), pull()};
  }

 private:
  const control::Plan& plan_;
  const GroupPlan& group_;
};

/// Rows of the group that the coupling holds, and those that it or the network names.
struct Named {
  Indices coupled, all;
};

Named named_rows(const GroupGains& gains) {
  Named rows;
  const Matrix hold = gains.hold();
  const System network = gains.network();
  for (Index i = 0; i < gains.m(); ++i) {
    const bool coupled = hold(i, i) != 0;
    const bool touched =
        !network.D.row(i).isZero(0) || !network.C.row(i).isZero(0) || !network.B.col(i).isZero(0);
    if (coupled) rows.coupled.push_back(i);
    if (coupled || touched) rows.all.push_back(i);
  }
  return rows;
}

System restricted(const System& g, const Indices& rows) {
  return {g.A, g.B(Eigen::all, rows), g.C(rows, Eigen::all), g.D(rows, rows)};
}

/// x -> -f over all rows of the group.
System rendered(const GroupGains& gains, const GroupPlan& group) {
  const Index m = gains.m(), n = gains.memory(), p = gains.states();
  const System e = gains.network();
  const Matrix reach = gains.reach(), carry = reach * gains.lag();
  const Matrix sway = gains.of(group.sway, m, p);
  System f;
  f.C.resize(m, n + p);
  f.C << -e.D * carry, e.C - e.D * sway;
  f.D = e.D * reach;
  f.A = Matrix::Zero(n + p, n + p);
  f.B = Matrix::Zero(n + p, m);
  f.A.bottomRows(p) << -e.B * carry, e.A - e.B * sway;
  f.B.bottomRows(p) = e.B * reach;
  if (group.remembers_stretch) {
    f.A.topRows(n) << carry, sway;
    f.B.topRows(n) = Matrix::Identity(n, m) - reach;
  } else if (n > 0) {
    const Matrix learn = gains.of(group.learn, n, m);
    f.A.topRows(n) = learn * f.C;
    f.A.topLeftCorner(n, n) += gains.of(group.recall, n, n);
    f.B.topRows(n) = learn * f.D;
  }
  return f;
}

/// V over the coupled rows: its feed-through is Z^-1, and hold = Z + D_E there.
System coupling(const GroupGains& gains, const GroupPlan& group, const Indices& rows) {
  const Matrix z = gains.hold()(rows, rows) - gains.pull()(rows, rows);
  const Matrix yields = z.partialPivLu().inverse();
  if (!group.remembers_stretch) {
    return {gains.of(group.recall, gains.memory(), gains.memory()),
            gains.of(group.learn, gains.memory(), gains.m())(Eigen::all, rows),
            gains.lag()(rows, Eigen::all), yields};
  }
  const Matrix carry = gains.lag()(rows, rows);  // the last stretch is the state
  return {carry, yields, carry, yields};
}

/// The one group of these devices; none: nullptr.
const GroupPlan* group_of(const control::Plan& plan, const Tied& devices) {
  for (const ContactPlan& contact : plan.contacts) {
    const bool own = std::find(devices.begin(), devices.end(), contact.device) != devices.end();
    if (own && contact.group != ContactPlan::kNoGroup) return &plan.groups[contact.group];
  }
  return nullptr;
}

/// Coordinates of the plan, by row of the group.
std::vector<std::size_t> coordinates_of(const control::Plan& plan, const GroupPlan& group) {
  std::vector<std::size_t> coordinates;
  for (std::size_t i = 0; i < group.contacts; ++i) {
    const ContactPlan& contact = plan.contacts[plan.group_contacts[group.first_contact + i]];
    for (std::size_t c = 0; c < contact.coordinates; ++c)
      coordinates.push_back(std::size_t{contact.first_coordinate} + c);
  }
  return coordinates;
}

}  // namespace

TiedModel tied_model(const control::Plan& plan, const Tied& devices) {
  TiedModel model;
  const GroupPlan* group = group_of(plan, devices);
  if (!group) return model;
  const GroupGains gains(plan, *group);
  const Named rows = named_rows(gains);
  const std::vector<std::size_t> coordinates = coordinates_of(plan, *group);
  for (const Index row : rows.all)
    model.coordinates.push_back(coordinates[static_cast<std::size_t>(row)]);
  model.F = restricted(rendered(gains, *group), rows.all);
  model.E = restricted(gains.network(), rows.all);
  model.passive_network = group->passive_network;
  model.all_coupled = rows.coupled.size() == rows.all.size();
  if (!model.all_coupled) return model;
  model.V = coupling(gains, *group, rows.all);
  model.K = gains.of(group->stiffness, gains.m(), gains.m())(rows.all, rows.all);
  model.B = gains.of(group->damping, gains.m(), gains.m())(rows.all, rows.all);
  // A general V stores no stiffness in some row: Z = K + B/T then does not hold there.
  const Matrix z = gains.hold()(rows.all, rows.all) - gains.pull()(rows.all, rows.all);
  model.spring_damper = group->remembers_stretch || model.V.states() == 0;
  const Matrix rest = z - model.K - model.B / plan.period_s;
  model.spring_damper = model.spring_damper && rest.norm() <= 1e-9 * z.norm();
  return model;
}

}  // namespace hapticd::check
