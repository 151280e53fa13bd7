#include "sim/shared_plant.h"

#include "sim/matrix_exponential.h"

namespace hapticd::sim {
namespace {

/// From rows as they stand in the options.
auto matrix(const std::vector<double>& values, Eigen::Index rows, Eigen::Index columns) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const Rows>(values.data(), rows, columns);
}

}  // namespace

SharedPlant::SharedPlant(std::span<const AxisOptions> axes, const SharedHandOptions& hand,
                         std::span<const std::size_t> held)
    : axes_(index(axes.size())),
      states_(index(hand.states)),
      mass_kg_(axes_),
      damping_Ns_m_(axes_),
      force_(Eigen::MatrixXd::Zero(axes_, axes_ + states_)),
      memory_(Eigen::MatrixXd::Zero(states_, axes_ + states_)),
      state_(Eigen::VectorXd::Zero(3 * axes_ + states_)),
      change_(Eigen::VectorXd::Zero(2 * axes_ + states_)) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    mass_kg_[index(i)] = axes[i].mass_kg;
    damping_Ns_m_[index(i)] = axes[i].damping_Ns_m;
    state_[index(i)] = axes[i].position_m;
  }
  const Index columns = index(held.size());
  const auto C = matrix(hand.C, columns, states_), D = matrix(hand.D, columns, columns);
  const auto B = matrix(hand.B, states_, columns);
  memory_.rightCols(states_) = matrix(hand.A, states_, states_);
  for (Index j = 0; j < columns; ++j) {
    const Index axis = index(held[static_cast<std::size_t>(j)]);
    state_[axes_ + axis] = hand.axes[static_cast<std::size_t>(j)].velocity_m_s;
    memory_.col(axis) = B.col(j);
    force_.row(axis).tail(states_) = C.row(j);
    for (Index k = 0; k < columns; ++k)
      force_(axis, index(held[static_cast<std::size_t>(k)])) = D(j, k);
  }
}

// d/dt (x, v, xi, u) by (x, v, xi, u).
Eigen::MatrixXd SharedPlant::rates() const {
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(state_.size(), state_.size());
  const Eigen::VectorXd mobility = mass_kg_.cwiseInverse();
  rates.block(0, axes_, axes_, axes_).setIdentity();
  rates.block(axes_, axes_, axes_, axes_ + states_) = -(mobility.asDiagonal() * force_);
  rates.block(axes_, axes_, axes_, axes_).diagonal() -= mobility.cwiseProduct(damping_Ns_m_);
  rates.block(axes_, 2 * axes_ + states_, axes_, axes_) = mobility.asDiagonal();
  rates.block(2 * axes_, axes_, states_, axes_ + states_) = memory_;
  return rates;
}

// In units of the interval's own length h and of M, (x, v h, xi, u h^2/M), what motors and motion
// do is of order one, however short the interval.
SharedPropagator SharedPlant::propagator(double length_s) const {
  const double h = length_s;
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(state_.size());
  unit.segment(axes_, axes_).setConstant(h);
  unit.tail(axes_) = h * h * mass_kg_.cwiseInverse();
  const Eigen::VectorXd per_unit = unit.cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * (h * rates()) * per_unit.asDiagonal();
  const Eigen::MatrixXd change =
      per_unit.asDiagonal() * exp_minus_identity(scaled) * unit.asDiagonal();
  return {h, change.topRightCorner(change_.size(), state_.size() - axes_)};
}

// Column by column: every sum runs in the order of the state, whatever the vector unit.
void SharedPlant::advance(const SharedPropagator& propagator) noexcept {
  change_.setZero();
  for (Index column = 0; column < propagator.change.cols(); ++column)
    change_ += propagator.change.col(column) * state_[axes_ + column];
  state_.head(change_.size()) += change_;
}

double SharedPlant::kinetic_J(std::size_t axis) const noexcept {
  const double v = velocity_m_s(axis);
  return 0.5 * mass_kg_[index(axis)] * v * v;
}

double SharedPlant::hand_force_N(std::size_t axis) const noexcept {
  return -force_.row(index(axis)).dot(state_.segment(axes_, axes_ + states_));
}

}  // namespace hapticd::sim
