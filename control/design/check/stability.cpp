#include "control/design/check/stability.h"

#include <algorithm>
#include <cmath>

#include "control/design/check/certified.h"
#include "control/design/check/closed_form.h"
#include "control/design/check/uncovered.h"

namespace hapticd::check {
namespace {

/// What one device lacks.
std::string missing_premise(const control::DevicePlan& device, const DeviceAssumption& assumed) {
  std::vector<std::string> reasons = assumed.obstacles;
  for (const ObjectNote& note : assumed.active) reasons.push_back(note.object + " " + note.reason);
  if (!reasons.empty()) {
    std::string text = reasons.front();
    for (std::size_t i = 1; i < reasons.size(); ++i) text += "; " + reasons[i];
    return text;
  }
  if (assumed.min_damping.size() != device.axes)
    return "no `model` with a damping for every axis: nothing can be proved";
  for (const double damping : assumed.min_damping) {
    if (!(damping > 0) || !std::isfinite(damping))
      return "the smallest damping of an axis is zero: a passive spring needs damping in the "
             "device";
  }
  return {};
}

std::string missing_premises(const control::Plan& plan,
                             const std::vector<DeviceAssumption>& assumed, const Tied& devices) {
  for (const std::size_t d : devices) {
    std::string text = missing_premise(plan.devices[d], assumed.at(d));
    if (text.empty()) continue;
    return devices.size() == 1 ? text : assumed[d].name + ": " + text;
  }
  return {};
}

/// What is left, for people: how much stiffer the scene may get, how many ticks in a row may be missed.
std::string margin(const PassiveAnswer& answer) {
  const bool unknown = answer.stiffness_factor == 1 && answer.longest_hold_s == 0;
  if (!(answer.damping_used > 0) || unknown) return {};
  if (!answer.proved)
    return worded("; it would hold up to %.3g times this stiffness", answer.stiffness_factor);
  if (answer.longest_hold_s == 0)
    return worded("; holds up to %.3g times this stiffness", answer.stiffness_factor);
  return worded(
      "; holds up to %.3g times this stiffness, and while a force is held less than %.3g ms, "
      "so with %.0f missed ticks in a row",
      answer.stiffness_factor, 1e3 * answer.longest_hold_s, answer.missed_ticks);
}

/// What the certificate adds to closed forms that do not hold.
void take_certificate(const TiedCase& given, const Certificate& certificate,
                      PassiveAnswer& answer) {
  if (certificate.kind == CertificateKind::passive_closed_form) return;
  const Certified proof = certified(given, certificate);
  if (!proof.verdict.holds) {
    answer.why += "; the coupling's certificate does not prove it either: " + proof.verdict.why;
    return;
  }
  answer.proved = true;
  answer.theorem = proof.theorem;
  answer.damping_used = certificate.damping_share;
  answer.stiffness_factor = 1;
  answer.longest_hold_s = 0;
  answer.why = proof.theorem == Theorem::this_scene
                   ? "the certificate proves this one linear scene passive, at this latency held "
                     "constant and below the force limit; void once the scene changes"
                   : "the certificate proves Theorem 3: any scene that is passive";
  answer.why += worded("; it may use %.1f %% of the damping", 100 * certificate.damping_share);
}

int missed_ticks(double hold_s, double period_s) {
  constexpr double kMost = 1e6;
  return static_cast<int>(std::clamp(std::ceil(hold_s / period_s) - 2, 0.0, kMost));
}

/// Theorem A' holds for any latency up to the stated one in every tick; what else is proved here holds for one that stays
/// as it is.
void refuse_varying_latency(const std::vector<DeviceAssumption>& assumed, const Tied& devices,
                            PassiveAnswer& answer) {
  const bool varies = std::ranges::any_of(devices, [&](std::size_t d) {
    return assumed[d].latency_varies && assumed[d].latency_s > 0;
  });
  if (!answer.proved || !varies || answer.theorem == Theorem::any_static_scene_latency) return;
  answer.proved = false;
  answer.why +=
      "; but that is for samples of one age, and those of this device come now older, "
      "now younger: a coupling of springs alone is proved for that (Theorem A')";
}

PassiveAnswer answer_of(const control::Plan& plan, const std::vector<DeviceAssumption>& assumed,
                        const Tied& devices, const Certificate* certificate) {
  PassiveAnswer answer;
  answer.why = missing_premises(plan, assumed, devices);
  if (!answer.why.empty()) {
    answer.uncertified = active_objects(assumed, devices);
    return answer;
  }
  const TiedCase given(plan, assumed, devices);
  const double limit = certificate ? std::min(1.0, certificate->damping_share) : 1;
  answer = given.jointed ? joint_space_form(given, limit) : closed_form(given, limit);
  if (!answer.proved && certificate && !given.jointed && given.needs.problem.empty())
    take_certificate(given, *certificate, answer);
  refuse_varying_latency(assumed, devices, answer);
  if (answer.longest_hold_s > 0)
    answer.missed_ticks = missed_ticks(answer.longest_hold_s, plan.period_s);
  if (devices.size() > 1 && answer.damping_used > 0)
    answer.why += ", of " + given.names() + " together";
  answer.why += margin(answer);
  answer.uncertified = uncertified_objects(given, answer);
  answer.uncovered = uncovered(given, answer);
  return answer;
}

}  // namespace

const char* name_of(Theorem theorem) noexcept {
  switch (theorem) {
    case Theorem::any_static_scene:
      return "A";
    case Theorem::any_static_scene_latency:
      return "A'";
    case Theorem::passive_scene:
      return "B";
    case Theorem::this_scene:
      return "exact";
    case Theorem::none:
      break;
  }
  return "none";
}

std::vector<PassiveAnswer> passive(const control::Plan& plan,
                                   const std::vector<DeviceAssumption>& assumed,
                                   const Certificate* certificate) {
  std::vector<PassiveAnswer> answers(plan.devices.size());
  for (const Tied& devices : tied_devices(plan)) {
    const PassiveAnswer answer = answer_of(plan, assumed, devices, certificate);
    for (const std::size_t d : devices) answers[d] = answer;
  }
  return answers;
}

}  // namespace hapticd::check
