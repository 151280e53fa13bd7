#include "control/design/check/loop_parts.h"

#include "control/design/check/spring_damper.h"

namespace hapticd::check {
namespace {

System gain(double value) {
  return constant(Matrix::Constant(1, 1, value));
}

/// 1 - 1/z.
System step_back() {
  return sum(gain(1), scaled(delay(1), -1));
}

/// a / (1 - (1 - a)/z).
System lag(double share) {
  const double keep = 1 - share;
  return {Matrix::Constant(1, 1, keep), Matrix::Constant(1, 1, share), Matrix::Constant(1, 1, keep),
          Matrix::Constant(1, 1, share)};
}

/// Of one of three inputs.
System of_input(const System& g, Eigen::Index input) {
  return series(g, constant(Matrix::Identity(3, 3).row(input)));
}

}  // namespace

System backward_difference(double period_s) {
  return scaled(step_back(), 1 / period_s);
}

System velocity_of(const control::LowPassPlan& plan, double period_s) {
  return series(lag(plan.share), backward_difference(period_s));
}

System velocity_of(const control::LeastSquaresPlan& plan) {
  const Eigen::Index n = plan.window - 1;  // positions 1, 2, .. ticks old
  System g{Matrix::Zero(n, n), Matrix::Zero(n, 1), Matrix(1, n), Matrix::Zero(1, 1)};
  g.A.diagonal(-1).setOnes();
  g.B(0, 0) = 1;
  for (Eigen::Index i = 0; i < n; ++i) {
    g.C(0, i) = plan.weights[static_cast<std::size_t>(i + 1)];
    g.D(0, 0) -= g.C(0, i);
  }
  return g;
}

System velocity_of(const control::AlphaBetaGammaPlan& plan, double period_s) {
  Eigen::Matrix3d predict;
  predict << 1, period_s, 0.5 * period_s * period_s, 0, 1, period_s, 0, 0, 1;
  const Eigen::Vector3d correct(plan.alpha, plan.beta, plan.gamma);
  System g;
  g.A = predict - correct * predict.row(0);
  g.B = correct;
  g.C = g.A.row(1);
  g.D = Matrix::Constant(1, 1, plan.beta);
  return g;
}

System direct_wall(double stiffness_N_m, double damper_Ns_m,
                   const std::optional<System>& velocity) {
  if (!velocity) return constant(Eigen::RowVector2d(stiffness_N_m, damper_Ns_m));
  return rendered_scene(sum(gain(stiffness_N_m), scaled(*velocity, damper_Ns_m)));
}

System rendered_scene(const System& f) {
  return series(f, constant(Eigen::RowVector2d(1, 0)));
}

System behind_spring_damper(const System& e, double stiffness_N_m, double damping_Ns_m,
                            double period_s) {
  const Matrix K = Matrix::Constant(1, 1, stiffness_N_m);
  return feedback(e, spring_damper(K, Matrix::Constant(1, 1, damping_Ns_m), period_s));
}

System observer_of(const control::ObserverPlan& plan) {
  const System motion =
      series(sum(scaled(step_back(), plan.inertia), gain(plan.damping)), step_back());
  System command = scaled(sum(gain(1), delay(1)), -0.5 * plan.command_share);
  for (int i = 0; i < plan.extra_delay; ++i) command = series(command, delay(1));
  const System hand = series(scaled(sum(gain(1), delay(1)), -0.5 * plan.hand_share), delay(1));
  System residual = of_input(motion, 0);
  if (plan.command_share != 0) residual = sum(residual, of_input(command, 1));
  if (plan.hand_share != 0) residual = sum(residual, of_input(hand, 2));
  const System once = series(lag(plan.share), residual);
  return plan.second_share == 1 ? once : series(lag(plan.second_share), once);
}

}  // namespace hapticd::check
