#include "control/design/check/demand.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "control/design/check/objects.h"
#include "control/design/check/observer_level.h"

namespace hapticd::check {
namespace {

using Matrix = Eigen::MatrixXd;
using control::ContactPlan;

/// dx/dq of a device whose Jacobian is constant: contact coordinates x axes.
Matrix jacobian(const control::Plan& plan, const control::DevicePlan& device) {
  Matrix j = Matrix::Zero(device.coordinates, device.axes);
  for (const control::CartesianAxis& pair : plan.cartesian_axes) {
    const int axis = pair.axis - device.first_axis;
    if (axis >= 0 && axis < device.axes)
      j(pair.coordinate - device.first_coordinate, axis) = pair.scale;
  }
  for (const control::LinearMap& map : plan.linear_maps) {
    const control::Linkage& linkage = plan.linkages[map.linkage];
    if (linkage.first_axis != device.first_axis) continue;
    for (int row = 0; row < device.coordinates; ++row) {
      for (int axis = 0; axis < device.axes; ++axis) {
        for (std::size_t i = 0; i < 3; ++i)
          j(row, axis) += linkage.turn[static_cast<std::size_t>(row)][i] *
                          map.columns[i][static_cast<std::size_t>(axis)];
      }
    }
  }
  return j;
}

/// Where the rows and columns of a device stand in the matrices of all.
struct Block {
  const control::DevicePlan& device;
  Eigen::Index joint = 0;
  Eigen::Index coordinate = 0;
};

std::vector<Block> blocks_of(const control::Plan& plan, const Tied& devices) {
  std::vector<Block> blocks;
  Eigen::Index joint = 0, coordinate = 0;
  for (const std::size_t d : devices) {
    blocks.push_back({plan.devices[d], joint, coordinate});
    joint += plan.devices[d].axes;
    coordinate += plan.devices[d].coordinates;
  }
  return blocks;
}

/// Does a coupling hold this coordinate?
bool is_coupled(const control::Plan& plan, const ContactPlan& contact, std::size_t coordinate) {
  if (contact.group == ContactPlan::kNoGroup) return false;
  const control::GroupPlan& group = plan.groups[contact.group];
  const std::size_t row = contact.first_row + coordinate;
  return plan.gains[group.hold.offset + row * group.coordinates + row] != 0;
}

class Collector {
 public:
  Collector(const control::Plan& plan, const Tied& devices)
      : plan_(plan), blocks_(blocks_of(plan, devices)) {
    const Block& last = blocks_.back();
    joints_ = last.joint + last.device.axes;
    coordinates_ = last.coordinate + last.device.coordinates;
    demand_.direct = demand_.direct_damper = square(coordinates_);
    demand_.coupled = demand_.coupled_damper = square(coordinates_);
    demand_.travel = demand_.joint_damper = Eigen::VectorXd::Zero(joints_);
  }

  Demand run() {
    for (const Block& block : blocks_) {
      add_planes(block);
      add_axes(block);
    }
    for (const ContactPlan& contact : plan_.contacts) add_contact(contact);
    for (const control::GroupPlan& group : plan_.groups) add_group(group);
    for (const control::ObserverPlan& observer : plan_.axis_observers) add_axis_observer(observer);
    for (const control::ObserverPlan& observer : plan_.contact_observers)
      add_contact_observer(observer);
    return demand_;
  }

 private:
  static Matrix square(Eigen::Index size) { return Matrix::Zero(size, size); }

  /// Row of a coordinate of the plan in the matrices; -1: of another device.
  Eigen::Index row_of(std::size_t coordinate) const {
    for (const Block& block : blocks_) {
      const std::size_t first = block.device.first_coordinate;
      if (coordinate >= first && coordinate < first + block.device.coordinates)
        return block.coordinate + static_cast<Eigen::Index>(coordinate - first);
    }
    return -1;
  }

  Eigen::Index joint_of(std::size_t axis) const {
    for (const Block& block : blocks_) {
      const std::size_t first = block.device.first_axis;
      if (axis >= first && axis < first + block.device.axes)
        return block.joint + static_cast<Eigen::Index>(axis - first);
    }
    return -1;
  }

  double loss_of(const control::ObserverPlan& observer) {
    demand_.has_observer = true;
    if (leaves_no_level(observer)) {
      demand_.problem = observer.hand_share != 0
                            ? "a disturbance observer in mode sensor feeds the hand's force back: "
                              "it leaves no level of passivity that could be claimed"
                            : "a disturbance observer in mode classic feeds commands back: it "
                              "leaves no level of passivity that could be claimed";
      return 0;
    }
    const double loss = observer_loss(observer, plan_.period_s);
    if (!std::isfinite(loss))
      demand_.problem = "what a disturbance observer leaves of the damping could not be bounded";
    return loss;
  }

  void add_axis_observer(const control::ObserverPlan& observer) {
    const Eigen::Index joint = joint_of(observer.source);
    if (joint >= 0) demand_.joint_damper[joint] += loss_of(observer);
  }

  void add_contact_observer(const control::ObserverPlan& observer) {
    const Eigen::Index row = row_of(observer.source);
    if (row >= 0) demand_.direct_damper(row, row) += loss_of(observer);
  }

  void add_planes(const Block& block) {
    for (const control::PlaneContact& plane : plan_.planes) {
      if (plane.first_coordinate != block.device.first_coordinate) continue;
      const Eigen::Map<const Eigen::VectorXd> n(plane.normal.data(), block.device.coordinates);
      const auto size = block.device.coordinates;
      demand_.direct.block(block.coordinate, block.coordinate, size, size) +=
          plane.stiffness * n * n.transpose();
      demand_.direct_damper.block(block.coordinate, block.coordinate, size, size) +=
          plane.damping * n * n.transpose();
    }
  }

  void add_axes(const Block& block) {
    for (const control::FrictionAxis& friction : plan_.frictions) {
      const int axis = friction.axis - block.device.first_axis;
      if (axis >= 0 && axis < block.device.axes)
        demand_.joint_damper[block.joint + axis] +=
            friction.viscous + friction.coulomb / friction.smooth;
    }
    // The weight of a pendulum is a force that follows the angle: a spring of either sign.
    for (const control::GravityAxis& gravity : plan_.gravity_axes) {
      const int axis = gravity.axis - block.device.first_axis;
      if (axis < 0 || axis >= block.device.axes || gravity.swing == 0) continue;
      demand_.travel[block.joint + axis] += std::abs(gravity.swing);
      demand_.convex = false;
    }
    for (const control::TravelPlan& travel : plan_.travels) {
      const int axis = travel.axis - block.device.first_axis;
      if (axis >= 0 && axis < block.device.axes)
        demand_.travel[block.joint + axis] += travel.stiffness;
    }
  }

  /// Objects act on the coordinates that no coupling holds; behind a coupling they ask nothing.
  void add_contact(const ContactPlan& contact) {
    if (row_of(contact.first_coordinate) < 0 || contact.encounters == 0) return;
    bool convex = true;
    const ObjectShare sum = objects_of(plan_, contact, convex);
    bool any = false;
    for (std::size_t i = 0; i < contact.coordinates; ++i) {
      if (is_held(contact, i)) continue;
      const Eigen::Index row = row_of(contact.first_coordinate + i);
      demand_.direct(row, row) += sum.stiffness;
      demand_.direct_damper(row, row) += sum.damping;
      any = true;
    }
    if (any) demand_.convex = demand_.convex && convex;
  }

  bool is_held(const ContactPlan& contact, std::size_t coordinate) const {
    return is_coupled(plan_, contact, coordinate);
  }

  void add_group(const control::GroupPlan& group) {
    std::vector<Eigen::Index> rows;
    bool direct = false;
    for (std::size_t i = 0; i < group.contacts; ++i) {
      const ContactPlan& contact = plan_.contacts[plan_.group_contacts[group.first_contact + i]];
      for (std::size_t c = 0; c < contact.coordinates; ++c) {
        rows.push_back(row_of(contact.first_coordinate + c));
        direct = direct || (is_touched(group, contact.first_row + c) && !is_held(contact, c));
      }
    }
    if (rows.empty() || rows.front() < 0) return;
    if (direct) {
      demand_.exact_only =
          "a network acts on a coordinate that no coupling holds; give it a coupling, or it needs "
          "the exact test of this one scene";
    }
    add_gain(group.stiffness, rows, demand_.coupled);
    add_gain(group.damping, rows, demand_.coupled_damper);
  }

  /// Does a network act on this row of a group?
  bool is_touched(const control::GroupPlan& group, std::size_t row) const {
    const auto has = [&](const control::Gain& gain) {
      const auto begin =
          plan_.gains.begin() + gain.offset + static_cast<std::ptrdiff_t>(row) * gain.columns;
      return !gain.empty() &&
             std::any_of(begin, begin + gain.columns, [](double g) { return g != 0; });
    };
    return has(group.pull) || has(group.swing);
  }

  void add_gain(const control::Gain& gain, const std::vector<Eigen::Index>& rows,
                Matrix& sum) const {
    for (std::size_t i = 0; i < gain.rows; ++i) {
      for (std::size_t j = 0; j < gain.columns; ++j)
        sum(rows[i], rows[j]) += plan_.gains[gain.offset + i * gain.columns + j];
    }
  }

  const control::Plan& plan_;
  std::vector<Block> blocks_;
  Eigen::Index joints_ = 0, coordinates_ = 0;
  Demand demand_;
};

}  // namespace

std::vector<Tied> tied_devices(const control::Plan& plan) {
  std::vector<std::size_t> root(plan.devices.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  for (const control::GroupPlan& group : plan.groups) {
    std::size_t least = plan.devices.size();
    const auto member = [&](std::size_t i) {
      return std::size_t{plan.contacts[plan.group_contacts[group.first_contact + i]].device};
    };
    for (std::size_t i = 0; i < group.contacts; ++i) least = std::min(least, root[member(i)]);
    for (std::size_t i = 0; i < group.contacts; ++i) root[member(i)] = least;
  }
  std::vector<Tied> sets(plan.devices.size());
  for (std::size_t d = 0; d < root.size(); ++d) sets[root[d]].push_back(d);
  std::erase_if(sets, [](const Tied& set) { return set.empty(); });
  return sets;
}

Demand demand(const control::Plan& plan, const Tied& devices) {
  return Collector(plan, devices).run();
}

Eigen::MatrixXd constant_jacobian(const control::Plan& plan, const Tied& devices) {
  const std::vector<Block> blocks = blocks_of(plan, devices);
  const Block& last = blocks.back();
  Matrix j = Matrix::Zero(last.coordinate + last.device.coordinates, last.joint + last.device.axes);
  for (const Block& block : blocks) {
    const Matrix own = jacobian(plan, block.device);
    j.block(block.coordinate, block.joint, own.rows(), own.cols()) = own;
  }
  return j;
}

}  // namespace hapticd::check
