// The parts of the loop of one axis as linear systems, read from the plans that the loop runs
// (control/motion/estimators.h, control/observer/observer.h): no gaps, no limits, blends at their end.
// The first-order adaptive window (Foaw) has no linear model.
#pragma once
#include <optional>

#include "control/design/check/linear.h"
#include "control/motion/estimators.h"
#include "control/observer/observer.h"

namespace hapticd::check {

/// Position -> velocity, each with the tick's own delay and no other.
System backward_difference(double period_s);
System velocity_of(const control::LowPassPlan& plan, double period_s);
System velocity_of(const control::LeastSquaresPlan& plan);
System velocity_of(const control::AlphaBetaGammaPlan& plan, double period_s);

/// (x_k, v_k) -> force on the device with a minus sign: a wall that is rendered directly, K x + B_c v.
/// `velocity`: from x; nothing: v is known as it is.
System direct_wall(double stiffness_N_m, double damper_Ns_m, const std::optional<System>& velocity);
/// The same of a scene F(z) on x alone (models.h).
System rendered_scene(const System& f);
/// F of a scene E behind a spring and a damper: f = (K + B (1 - 1/z)/T)(x - y), f = E y.
System behind_spring_damper(const System& e, double stiffness_N_m, double damping_Ns_m,
                            double period_s);

/// (x_k, u_{k-1}, h_k) -> d_hat: what the observer takes off the command; h: measured hand's force.
System observer_of(const control::ObserverPlan& plan);

}  // namespace hapticd::check
