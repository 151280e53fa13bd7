#include "control/step.h"

#include <algorithm>

#include "control/guard/guard.h"
#include "control/kinematics/cartesian.h"
#include "control/motion/sense.h"
#include "control/scene/render.h"

namespace hapticd::control {

TickOutput step(const Plan& plan, State& state,
                const TickInput& input) noexcept HAPTICD_NONBLOCKING {
  Findings findings;
  sense(plan, state, input, findings);
  forward(plan, state);
  render(plan, state);
  decide_mode(state, input, findings);
  guard(plan, state, findings, input.enable);
  transpose(plan, state);
  limit_effort(plan, state, findings);
  return {
      .effort = state.effort, .mode = state.mode, .limits = findings.limits, .fault = state.fault};
}

void carry_over(const State& from, State& to) noexcept HAPTICD_NONBLOCKING {
  std::copy(from.axes.begin(), from.axes.end(), to.axes.begin());
  for (const auto part :
       {&State::q, &State::qd, &State::effort, &State::x, &State::force, &State::v, &State::ramp}) {
    std::copy((from.*part).begin(), (from.*part).end(), (to.*part).begin());
  }
  to.mode = from.mode;
  to.fault = from.fault;
  to.adopted = true;
}

}  // namespace hapticd::control
