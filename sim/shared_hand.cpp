#include "sim/shared_hand.h"

#include <algorithm>
#include <array>
#include <utility>

#include "sim/check_shared_hand.h"

namespace hapticd::sim {

SharedHand::SharedHand(SharedHandOptions options, std::vector<DeviceOptions> devices)
    : options_(std::move(options)), devices_(std::move(devices)) {}

bool SharedHand::holds(std::size_t device) const noexcept {
  return std::any_of(options_.axes.begin(), options_.axes.end(),
                     [&](const HeldAxis& held) { return held.device == device; });
}

std::string SharedHand::problem() const {
  return shared_hand_problem(options_, devices_);
}

void SharedHand::restart() {
  lay_out();
  std::vector<std::size_t> held;
  for (const HeldAxis& axis : options_.axes) held.push_back(first_[axis.device] + axis.axis);
  plant_.emplace(axes_, options_, held);
  cut_time();
  truth_.assign(axes_.size(), Truth{});
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double at_m = axes_[i].position_m;
    truth_[i].min_position_m = truth_[i].max_position_m = truth_[i].rest_m = at_m;
    truth_[i].observe(at_m, plant_->velocity_m_s(i));
    truth_[i].energy_J = plant_->kinetic_J(i);
  }
  started_ = false;
}

void SharedHand::lay_out() {
  axes_.clear();
  first_.clear();
  wires_.clear();
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    const DeviceOptions& device = devices_[i];
    first_.push_back(axes_.size());
    if (!holds(i)) continue;
    axes_.insert(axes_.end(), device.axes.begin(), device.axes.end());
    for (std::size_t axis = 0; axis < device.axes.size(); ++axis)
      wires_.emplace_back(device.axes[axis], device.period_s, device.seed, axis);
  }
  first_.push_back(axes_.size());
}

void SharedHand::cut_time() {
  const DeviceOptions& any = devices_[options_.axes[0].device];
  std::vector<double> delays_s;
  for (const AxisOptions& axis : axes_) delays_s.push_back(axis.delay_s);
  pieces_.clear();
  propagators_.clear();
  for (const Segment& segment : cut_period({any.period_s, any.substeps}, delays_s))
    pieces_.push_back({segment, propagator_for(segment.end_s - segment.begin_s)});
  trace_.clear();
  for (const AxisOptions& axis : axes_)
    trace_.emplace_back(static_cast<std::size_t>(any.substeps), axis.position_m);
}

std::size_t SharedHand::propagator_for(double length_s) {
  const auto same = [&](const SharedPropagator& p) { return p.length_s == length_s; };
  const auto found = std::find_if(propagators_.begin(), propagators_.end(), same);
  const auto number = static_cast<std::size_t>(found - propagators_.begin());
  if (found == propagators_.end()) propagators_.push_back(plant_->propagator(length_s));
  return number;
}

void SharedHand::run_until(std::int64_t tick) noexcept {
  if (!started_) tick_ = tick;
  started_ = true;
  for (std::int64_t left = owed_ticks(tick_, tick); left > 0; --left) run_tick();
  tick_ = std::max(tick_, tick);
}

std::span<Wires> SharedHand::wires(std::size_t device) noexcept {
  if (wires_.empty()) return {};
  return std::span(wires_).subspan(first_[device], first_[device + 1] - first_[device]);
}

void SharedHand::run_tick() noexcept {
  for (Wires& axis : wires_) axis.next_period();
  std::size_t substep = 0;
  for (const Piece& piece : pieces_) {
    run_piece(piece);
    if (piece.segment.last) observe_substep(substep++);
  }
}

void SharedHand::run_piece(const Piece& piece) noexcept {
  std::array<double, kMaxAxes> before_m;
  for (std::size_t i = 0; i < wires_.size(); ++i) {
    before_m[i] = plant_->position_m(i);
    truth_[i].effort_N = wires_[i].effort_N(piece.segment.effort_age[i]);
    plant_->set_effort(i, truth_[i].effort_N);
  }
  plant_->advance(propagators_[piece.propagator]);
  for (std::size_t i = 0; i < wires_.size(); ++i) {
    const double after_m = plant_->position_m(i);
    truth_[i].effort_work_J += truth_[i].effort_N * (after_m - before_m[i]);
    wires_[i].moved(before_m[i], after_m);
  }
}

void SharedHand::observe_substep(std::size_t substep) noexcept {
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    truth_[i].observe(plant_->position_m(i), plant_->velocity_m_s(i));
    truth_[i].energy_J = plant_->kinetic_J(i);
    trace_[i][substep] = truth_[i].position_m;
  }
}

}  // namespace hapticd::sim
