#include "control/design/check/poses.h"

#include <numbers>

#include "control/design/check/pose_delta.h"
#include "control/design/check/pose_five_bar.h"
#include "control/design/check/pose_serial.h"

namespace hapticd::check {
namespace {

/// Cells that a proof may take: some 0.1 s.
constexpr std::size_t kBudget = 6'000;

const control::Linkage* linkage_of(const control::Plan& plan, std::size_t device) {
  for (const control::Linkage& at : plan.linkages)
    if (at.device == device) return &at;
  return nullptr;
}

template <class Kind>
const Kind* kind_of(const control::Plan& plan, std::span<const Kind> all,
                    const control::Linkage& at) {
  for (const Kind& kind : all)
    if (&plan.linkages[kind.linkage] == &at) return &kind;
  return nullptr;
}

/// Travel limits with the margin beyond which there is a fault, else a whole turn.
Cell joint_box(const control::Plan& plan, const control::Linkage& at, const bool* slides,
               std::string& problem) {
  Cell cell;
  for (std::size_t i = 0; i < at.axes; ++i) {
    cell.low[i] = -std::numbers::pi;
    cell.high[i] = std::numbers::pi;
    bool limited = false;
    for (const control::TravelPlan& travel : plan.travels) {
      if (travel.axis != at.first_axis + i) continue;
      cell.low[i] = travel.min - travel.margin;
      cell.high[i] = travel.max + travel.margin;
      limited = true;
    }
    if (!limited && slides[i])
      problem = "a sliding joint without travel limits can be anywhere: give it `travel`";
  }
  return cell;
}

PoseAnswer answer_of(const CellSearch& search) {
  PoseAnswer answer;
  answer.share = search.bound;
  answer.found = search.found;
  answer.bending = search.bending;
  answer.pose = search.pose;
  answer.met = search.met;
  return answer;
}

template <class Kind>
PoseAnswer over_joints(const PoseChart& chart, const Kind& kind, const Cell& root) {
  std::array<double, kMaxJoints> unit;
  for (std::size_t i = 0; i < kMaxJoints; ++i) unit[i] = std::max(root.half(i), 1e-12);
  return answer_of(
      search_cells(root, chart.at_.axes, unit, kBudget, JointChart<Kind>(chart, kind)));
}

}  // namespace

bool is_jointed(const control::Plan& plan, std::size_t device) {
  const control::Linkage* at = linkage_of(plan, device);
  return at && !kind_of(plan, plan.linear_maps, *at);
}

PoseAnswer largest_share(const control::Plan& plan, std::size_t device,
                         const Eigen::VectorXd& damping, const PoseDemand& demand) {
  const control::Linkage& at = *linkage_of(plan, device);
  const PoseChart chart(plan, at, damping, demand);
  PoseAnswer answer;
  if (const auto* bars = kind_of(plan, plan.five_bars, at)) {
    const std::array<bool, 2> slides{};
    return over_joints(chart, FiveBarCells(*bars),
                       joint_box(plan, at, slides.data(), answer.problem));
  }
  if (const auto* delta = kind_of(plan, plan.deltas, at)) {
    const DeltaChart legs(chart, *delta);
    std::array<double, kMaxJoints> unit;
    unit.fill(1);
    return answer_of(search_cells(legs.reachable(), 3, unit, kBudget, legs));
  }
  const control::Serial& chain = *kind_of(plan, plan.serials, at);
  std::array<bool, kMaxJoints> slides{};
  for (std::size_t i = 0; i < chain.joints; ++i) slides[i] = chain.joint[i].prismatic;
  const Cell root = joint_box(plan, at, slides.data(), answer.problem);
  return answer.problem.empty() ? over_joints(chart, SerialCells(chain), root) : answer;
}

}  // namespace hapticd::check
