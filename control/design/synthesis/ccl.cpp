#include "control/design/synthesis/ccl.h"

#include <cmath>

#include "control/design/synthesis/ccl_program.h"

namespace hapticd::synthesis {

bool consider(const HapticLoop& loop, const Merit& merit, DesignedCoupling coupling,
              CclDesign& best) {
  const double value = merit ? merit(coupling) : 0;
  if (!std::isfinite(value) || (best.found && !(value < best.merit))) return false;
  Theorem3 proof = theorem3(loop, coupling.V);
  if (!proof.stable) {
    best.why = proof.why;
    return false;
  }
  best.found = true;
  best.coupling = std::move(coupling);
  best.proof = std::move(proof);
  best.merit = value;
  return true;
}

CclDesign design_by_ccl(const HapticLoop& loop, const Form& form, const CclOptions& options) {
  CclDesign best;
  CclProgram program(loop, form, options);
  best.why = program.problem();
  while (best.why.empty() || best.iterations > 0) {
    if (best.iterations == options.max_iterations) break;
    const SdpAnswer answer = program.step();
    if (answer.x.size() == 0 || answer.infeasible) {
      if (!best.found) best.why = "no coupling of this form satisfies Theorem 4: " + answer.why;
      break;
    }
    ++best.iterations;
    CclStep step{best.iterations, answer.objective, program.complementarity(), false, 0};
    auto coupling = coupling_at(program.form(), answer.x, form, program.unit(), loop.period_s);
    if (coupling) step.verified = consider(loop, options.merit, std::move(*coupling), best);
    step.merit = best.merit;
    if (options.progress && !options.progress(step)) break;
    if (best.found && !options.merit) break;
    if (step.complementarity < options.tolerance) break;
  }
  if (best.found) {
    best.why.clear();
  } else if (best.why.empty()) {
    best.why = "no iterate was verified";
  }
  return best;
}

}  // namespace hapticd::synthesis
