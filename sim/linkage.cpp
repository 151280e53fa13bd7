#include "sim/linkage.h"

namespace hapticd::sim {
namespace {

std::vector<Segment> segments_of(const DeviceOptions& options) {
  std::vector<double> delays_s;
  for (const AxisOptions& axis : options.axes) delays_s.push_back(axis.delay_s);
  return cut_period({options.period_s, options.substeps}, delays_s);
}

std::array<double, 3> array_of(const Eigen::Vector3d& vector) noexcept {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

Linkage::Linkage(const DeviceOptions& options)
    : plant_(options),
      script_(options.hand.script, 0, TimeGrid{options.period_s, options.substeps}.substep_s()),
      segments_(segments_of(options)) {
  for (const AxisOptions& axis : options.axes) {
    Truth truth;
    truth.position_m = truth.min_position_m = truth.max_position_m = axis.position_m;
    truth_.push_back(truth);
    trace_.emplace_back(static_cast<std::size_t>(options.substeps), axis.position_m);
  }
  observe_tip();
}

void Linkage::run_tick(std::span<Wires> wires, std::int64_t script_substep) noexcept {
  for (Wires& joint : wires) joint.next_period();
  std::size_t substep = 0;
  ScriptValue hand;
  for (const Segment& segment : segments_) {
    if (segment.begin_s == 0)
      hand = script_.at(script_substep + static_cast<std::int64_t>(substep));
    run_segment(segment, hand, wires);
    if (segment.last) observe_substep(substep++);
  }
  observe_tip();
}

void Linkage::run_segment(const Segment& segment, const ScriptValue& hand,
                          std::span<Wires> wires) noexcept {
  const Joints before = plant_.q();
  for (std::size_t i = 0; i < wires.size(); ++i)
    input_.effort[static_cast<int>(i)] = wires[i].effort_N(segment.effort_age[i]);
  input_.force_N = hand.force_N;
  input_.rest_m = hand.rest_m + hand.rest_rate_m_s * segment.begin_s;
  input_.rest_rate_m_s = hand.rest_rate_m_s;
  const double length_s = segment.end_s - segment.begin_s;
  plant_.advance(length_s, input_);
  input_.rest_m += hand.rest_rate_m_s * length_s;
  for (std::size_t i = 0; i < wires.size(); ++i)
    wires[i].moved(before[static_cast<int>(i)], plant_.q()[static_cast<int>(i)]);
}

void Linkage::observe_substep(std::size_t substep) noexcept {
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    const auto joint = static_cast<int>(i);
    Truth& truth = truth_[i];
    truth.observe(plant_.q()[joint], plant_.qd()[joint]);
    trace_[i][substep] = truth.position_m;
    truth.effort_N = input_.effort[joint];
    truth.script_force_N = input_.force_N;
    truth.rest_m = input_.rest_m;
    truth.effort_work_J = plant_.effort_work_J(i);
  }
}

void Linkage::observe_tip() noexcept {
  tip_.position_m = array_of(plant_.tip());
  tip_.velocity_m_s = array_of(plant_.tip_velocity());
  tip_.hand_work_J = plant_.hand_work_J();
  tip_.lost_J = plant_.lost_J();
  tip_.energy_J = plant_.energy_J(input_.rest_m);
}

std::array<double, 3> Linkage::hand_force_N(std::int64_t script_substep) noexcept {
  const ScriptValue hand = script_.at(script_substep);
  LinkageInput now = input_;
  now.force_N = hand.force_N;
  now.rest_m = hand.rest_m;
  now.rest_rate_m_s = hand.rest_rate_m_s;
  return array_of(plant_.hand_force_N(now));
}

}  // namespace hapticd::sim
