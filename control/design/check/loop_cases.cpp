#include "control/design/check/loop_cases.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace hapticd::check {
namespace {

using Field = double LoopCase::*;
using Edge = Side LoopBox::*;
constexpr std::array<std::pair<Edge, Field>, 7> kSides = {{
    {&LoopBox::mass_kg, &LoopCase::mass_kg},
    {&LoopBox::damping_Ns_m, &LoopCase::damping_Ns_m},
    {&LoopBox::hand_kg, &LoopCase::hand_kg},
    {&LoopBox::hand_Ns_m, &LoopCase::hand_Ns_m},
    {&LoopBox::hand_N_m, &LoopCase::hand_N_m},
    {&LoopBox::latency_s, &LoopCase::latency_s},
    {&LoopBox::contact, &LoopCase::contact},
}};

void append(std::string& text, const char* format, double value) {
  char part[60];
  std::snprintf(part, sizeof part, format, value);
  text += part;
}

}  // namespace

std::string malformed(const SampledLoop& loop, const LoopBox& box) {
  for (const auto& [edge, field] : kSides)
    if (!((box.*edge).low <= (box.*edge).high)) return "a side of the box has no low <= high";
  if (box.contact.high > 1) return "a share of contact is above 1";
  LoopCase low, high;
  for (const auto& [edge, field] : kSides) {
    low.*field = (box.*edge).low;
    high.*field = (box.*edge).high;
  }
  const std::string why = malformed(loop, low);
  return why.empty() ? malformed(loop, high) : why;
}

std::vector<LoopCase> cases_of(const LoopBox& box, int per_side) {
  std::vector<LoopCase> cases(1);
  for (const auto& [edge, field] : kSides) {
    const Side side = box.*edge;
    const int count = side.low == side.high ? 1 : per_side;
    std::vector<LoopCase> more;
    for (const LoopCase& one : cases) {
      for (int i = 0; i < count; ++i) {
        more.push_back(one);
        // The ends as they are, without rounding.
        const double share = count == 1 ? 0 : static_cast<double>(i) / (count - 1);
        more.back().*field =
            i + 1 == count && count > 1 ? side.high : side.low + share * (side.high - side.low);
      }
    }
    cases = std::move(more);
  }
  return cases;
}

std::vector<LoopCase> scaled_devices(const LoopCase& one, double alpha, double beta,
                                     const std::vector<double>& deltas) {
  std::vector<LoopCase> cases;
  for (const double delta : deltas) {
    cases.push_back(one);
    cases.back().mass_kg *= 1 + alpha * delta;
    cases.back().damping_Ns_m *= 1 + beta * delta;
  }
  return cases;
}

std::string described(const LoopCase& one) {
  std::string text;
  append(text, "mass %.4g kg", one.mass_kg);
  append(text, ", damping %.4g N s/m", one.damping_Ns_m);
  if (one.hand_kg > 0) append(text, ", hand %.4g kg", one.hand_kg);
  if (one.hand_Ns_m > 0) append(text, ", hand %.4g N s/m", one.hand_Ns_m);
  if (one.hand_N_m > 0) append(text, ", hand %.4g N/m", one.hand_N_m);
  if (one.contact == 1)
    text += ", contact closed";
  else if (one.contact == 0)
    text += ", contact open";
  else
    append(text, ", contact %.3g closed", one.contact);
  append(text, ", latency %.4g us", one.latency_s * 1e6);
  return text;
}

WorstCase worst_of(const SampledLoop& loop, const std::vector<LoopCase>& cases) {
  WorstCase worst;
  for (const LoopCase& one : cases) {
    const double radius = loop_radius(loop, one);
    if (std::isnan(radius)) return {radius, one};
    if (radius >= worst.radius) worst = {radius, one};
  }
  return worst;
}

bool all_stable(const SampledLoop& loop, const std::vector<LoopCase>& cases) {
  for (const LoopCase& one : cases)
    if (!(loop_radius(loop, one) < 1)) return false;
  return true;
}

}  // namespace hapticd::check
