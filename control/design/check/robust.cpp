#include "control/design/check/robust.h"

#include <algorithm>
#include <cstdio>

namespace hapticd::check {
namespace {

std::string eigenvalue_at(const WorstCase& worst) {
  char text[60];
  std::snprintf(text, sizeof text, "largest eigenvalue %.6g at ", worst.radius);
  return text + described(worst.at);
}

}  // namespace

RobustAnswer robust(const SampledLoop& loop, const LoopBox& box, const std::vector<Matrix>& P,
                    int per_side) {
  RobustAnswer answer;
  answer.why = malformed(loop, box);
  if (!answer.why.empty()) return answer;
  const std::vector<LoopCase> cases = cases_of(box, std::max(2, per_side));
  answer.cases = cases.size();
  answer.worst = worst_of(loop, cases);
  if (!(answer.worst.radius < kStableBelow)) {
    answer.why = eigenvalue_at(answer.worst);
    return answer;
  }
  if (P.size() == 1) answer.common = proves_common(loop, box, P.front());
  if (answer.common.holds) {
    answer.kind = Robust::proved;
    answer.why = answer.common.why;
    return answer;
  }
  if (!P.empty()) answer.common = proves_constant(loop, box, P);
  if (answer.common.holds) {
    answer.kind = Robust::proved_constant;
    answer.why = answer.common.why;
    return answer;
  }
  answer.kind = Robust::sampled;
  answer.why = std::to_string(answer.cases) + " cases; " + eigenvalue_at(answer.worst);
  if (!P.empty()) answer.why += "; " + answer.common.why;
  return answer;
}

}  // namespace hapticd::check
