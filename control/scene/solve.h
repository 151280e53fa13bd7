// Scene and coupling of one tick, solved together. The one idea: all proxies p (the coupling's y,
// each touched body's own z) minimise one energy
//
//   J(p; x) = sum |z_i - y|^2 / (2 c_i)  +  U_fields(y)  +  1/2 |y - y0(x)|^2_hold  +  F_max |s|
//
// over free z_i, and the force on the contact is its slope, f = -dJ/dx. x enters J as a quadratic
// whose second derivative is at most Q (K + 2 B/T of the coupling; the sum of 1/c_i where a body is
// rendered directly). Whatever the solver finds is accepted only if it went down,
//
//   J(p_k; x_k) <= J(p_{k-1}; x_k)                                                       (descent)
//
// else the old proxies stay. Then, with S_k = J(p_k; x_k),
//
//   S_{k+1} <= J(p_k; x_{k+1}) <= S_k - f_k.(x_{k+1} - x_k) + 1/2 |x_{k+1} - x_k|^2_Q
//
// which is Theorem A: with a damper Delta > (T/2) Q in the device, no hand that is passive can be
// made to shake, for any shape, friction, iteration cap or snap from one surface to another. The
// solver's error costs accuracy alone; it is recorded. With latency (B = 0) a step must also pay
// (g/2) |y - y_{k-1}|^2_K (Theorem A').
//
// The force limit is a proxy too: a slack s between the contact and the coupling that costs
// F_max |s| (the scene's potential with its slope cut at F_max), so a limited force is still a
// slope of J and does no net work around a loop.
//
// Method: a sweep visits every near body and solves its contact law exactly with all others held
// (block coordinate descent in the forces); where several bodies are touched, a Newton step on all
// of their normal forces at once follows (active set). A contact that is rendered directly has
// give = 0: one visit of each body is exact.
#pragma once
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// Of a contact that has no group: adds to state.scene_force [N].
void touch_directly(const Plan& plan, State& state, std::size_t contact) noexcept;

/// Of all contacts of a group.
void solve_group(const Plan& plan, State& state, std::size_t group) noexcept;

/// What the contact's share of coupling, bodies and fields would give back [J]; networks apart.
double stored_energy(const Plan& plan, const State& state, const ContactPlan& contact) noexcept;

}  // namespace hapticd::control
