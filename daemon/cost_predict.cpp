#include "daemon/cost_predict.h"

#include "daemon/cost_table.h"

namespace hapticd::daemon {
namespace {

KindCost of_kind(const std::string& kind) {
  for (const KindCost& cost : kKindCosts) {
    if (cost.kind == kind) return cost;
  }
  return {};
}

}  // namespace

double predicted_loop_ns(const build::ProgramSpec& spec) {
  return kLoop_ns + kLoopDevice_ns * static_cast<double>(spec.devices.size()) +
         kLoopAxis_ns * static_cast<double>(spec.axes.size()) +
         kLinkage_ns * static_cast<double>(spec.linkages.size()) +
         kDelta_ns * static_cast<double>(spec.deltas.size());
}

double predicted_observers_ns(const build::ProgramSpec& spec) {
  return kObserver_ns *
         static_cast<double>(spec.axis_observers.size() + spec.contact_observers.size());
}

double predicted_coupling_ns(const control::Plan& plan) {
  return kContact_ns * static_cast<double>(plan.contacts.size()) +
         kGroup_ns * static_cast<double>(plan.groups.size()) +
         kGain_ns * static_cast<double>(plan.gains.size());
}

double predicted_broad_phase_ns(const control::Plan& plan) {
  double sum = 0;
  for (const control::ContactPlan& contact : plan.contacts) {
    if (contact.margin > 0) sum += kBroadPhase_ns;
  }
  return sum;
}

double predicted_distant_ns(const std::string& kind, const control::Plan& plan) {
  double sum = kPlainPlane_ns * static_cast<double>(plan.planes.size());
  for (const control::Encounter& encounter : plan.encounters)
    sum += of_kind(kind).distant_ns + (encounter.path == control::kNoPath ? 0 : kMotion_ns);
  return sum;
}

double predicted_touched_ns(const std::string& kind, const control::Plan& plan) {
  const double distant = predicted_distant_ns(kind, plan);
  if (plan.encounters.empty()) return distant;
  const control::Encounter& first = plan.encounters.front();
  const bool coupled = plan.contacts[first.contact].group != control::ContactPlan::kNoGroup;
  const KindCost cost = of_kind(kind);
  return distant - cost.distant_ns + (coupled ? cost.coupled_ns : cost.touched_ns) +
         (first.surface.static_friction > 0 ? kFriction_ns : 0);
}

}  // namespace hapticd::daemon
