#include "control/design/synthesis/ccl_h_infinity.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "control/design/synthesis/balance.h"
#include "control/design/synthesis/ccl_program.h"

namespace hapticd::synthesis {

using Eigen::Index;

namespace {

/// The inequality of the header; returns g.
Affine bounded_real(CclProgram& program, const System& m, const System& w2) {
  const FormVariables& v = program.form();
  const Index n1 = m.states(), n = v.a.rows(), n2 = w2.states();
  const Index size = n1 + n + n2, inputs = w2.inputs(), outputs = m.outputs();
  const Affine a = blocks({{Affine(m.A), m.B * v.c, m.B * v.d * w2.C},
                           {Affine(n, n1), v.a, v.b * w2.C},
                           {Affine(n2, n1), Affine(n2, n), Affine(w2.A)}});
  const Affine b = blocks({{m.B * v.d * w2.D}, {v.b * w2.D}, {Affine(w2.B)}});
  const Affine c = blocks({{Affine(m.C), m.D * v.c, m.D * v.d * w2.C}});
  const Affine d = m.D * v.d * w2.D;
  Lmi& lmi = program.lmi();
  const Affine x = lmi.symmetric(size), xi = lmi.symmetric(size), g = lmi.isotropic(outputs);
  program.at_least(
      symmetric_blocks({{xi, Affine(size, inputs), a.transpose(), c.transpose()},
                        {Affine(Matrix::Identity(inputs, inputs)), b.transpose(), d.transpose()},
                        {x, Affine(size, outputs)},
                        {g}}));
  program.complementary(x, xi);
  Affine price(1, 1);
  price.add(g.terms().front().variable, 0, 0, 1);
  return price;
}

constexpr double kUnwanted = std::numeric_limits<double>::infinity();

}  // namespace

System shaped_loop(const LoopShaping& shaping, const HapticLoop& loop, const System& coupling) {
  return check::series(shaping.W1, check::series(loop.scene, check::series(coupling, shaping.W2)));
}

CclDesign design_transparent(const HapticLoop& loop, const Form& form, const LoopShaping& shaping,
                             const CclOptions& options) {
  CclDesign best;
  CclProgram program(loop, form, options);
  best.why = program.problem();
  if (!best.why.empty()) return best;
  const double unit_norm =
      shaping.norm(shaped_loop(shaping, loop, check::constant(half_compliance(loop))));
  const double scale = loop.period_s / program.unit() / unit_norm;
  const auto m = balanced(check::scaled(check::series(shaping.W1, loop.scene), scale));
  const auto w2 = balanced(shaping.W2);
  if (!(unit_norm > 0) || !m || !w2) {
    best.why = "the weighted scene is not stable, or zero";
    return best;
  }
  const Affine g = bounded_real(program, *m, *w2);
  const Merit norm = [&](const DesignedCoupling& coupling) {
    if (!(check::spectral_radius(coupling.V.A) < 1)) return kUnwanted;
    return shaping.norm(shaped_loop(shaping, loop, coupling.V));
  };
  double reached = kUnwanted;
  int idle = 0;
  while (best.iterations < options.max_iterations && idle < shaping.patience) {
    const SdpAnswer answer = program.step(&g, shaping.penalty);
    if (answer.x.size() == 0 || answer.infeasible) {
      best.why = "no coupling of this form satisfies Theorem 4: " + answer.why;
      break;
    }
    ++best.iterations;
    CclStep step{best.iterations, answer.objective, program.complementarity(), false, 0};
    auto coupling = coupling_at(program.form(), answer.x, form, program.unit(), loop.period_s);
    if (coupling) step.verified = consider(loop, norm, std::move(*coupling), best);
    step.merit = best.merit;
    const bool gained = best.found && best.merit < reached * (1 - 1e-4);
    if (gained) reached = best.merit;
    if (best.found) idle = gained ? 0 : idle + 1;
    if (options.progress && !options.progress(step)) break;
  }
  if (best.found) {
    best.why.clear();
  } else if (best.why.empty()) {
    best.why = "no iterate was verified";
  }
  return best;
}

}  // namespace hapticd::synthesis
