// Contacts that are solved together: those that share a coupling's spring or a network of the
// scene. Everything linear about them - coupling, networks, fields that are linear everywhere - is
// folded at compile time into a few constant matrices; what is left for the loop is the bodies.
//
// With x the contacts' coordinates, s the slack of the force limit, xi the coupling's memory, eta
// the network's states, F the force of bodies and nonlinear fields on the proxies y:
//
//   x_free = x - s - lag xi
//   y0     = reach x_free - sway eta + rest               (without a network: y0 = x_free)
//   y      = y0 + give F
//   f      = F + push - pull y - swing eta                (without a network: f = F)
//   xi'    = x - s - y                                    (spring and damper: the stretch d)
//          = recall xi - learn f                          (general V: d = V(z) (-f))
//   eta'   = sway_on eta + drive y + drift
//
// f is the force on the contacts (the device gets +f). For a spring-damper K, B with Z = K + B/T:
// lag = Z^-1 B/T, give = (Z + D_E)^-1, hold = give^-1; for V = (A, B, C, D): Z = D^-1, lag = C,
// recall = A, learn = B. E = (A_E, B_E, C_E, D_E) is the network, displacement to force on it,
// backward Euler by default: pull = D_E, swing = C_E, sway_on = A_E, drive = B_E; push and drift
// are what its rest lengths and constant fields add; reach = give Z, sway = give C_E, rest = give
// push. A coordinate that no coupling names is rendered directly: its rows and columns in `give`
// and `hold` are zero (both are always there), its y is x: its row of `reach` is 1's, its column
// -give D_E. `reach` is empty where all are direct or there is no network: y0 = x_free. Without any
// damping a spring remembers nothing (n = 0).
//
// `hold` weighs the descent check: all the energy that is linear's is 1/2 |y - y0|^2_hold + const.
#pragma once
#include <cstdint>
#include <span>

namespace hapticd::control {

/// Rows times columns numbers of plan.gains, by rows. Empty: no such term.
struct Gain {
  std::uint32_t offset = 0;
  std::uint16_t rows = 0;
  std::uint16_t columns = 0;
  bool empty() const noexcept { return rows == 0 || columns == 0; }
};

/// m = coordinates, n = memory, p = states.
struct GroupPlan {
  std::uint32_t first_contact = 0;  ///< in plan.group_contacts; their coordinates are its rows
  std::uint16_t contacts = 0;
  std::uint16_t coordinates = 0;
  std::uint16_t memory = 0;
  std::uint16_t states = 0;
  std::uint32_t first_memory = 0;    ///< in state.coupling_memory
  std::uint32_t first_state = 0;     ///< in state.network
  bool remembers_stretch = false;    ///< xi' = x - s - y, n = m; else xi' = recall xi - learn f
  bool passive_network = true;       ///< E is none, or backward Euler's: passive by construction
  Gain lag{};                        ///< m x n
  Gain recall{}, learn{};            ///< n x n, n x m: general V only
  Gain give{}, hold{};               ///< m x m
  Gain reach{}, sway{}, rest{};      ///< m x m, m x p, m x 1
  Gain push{}, pull{}, swing{};      ///< m x 1, m x m, m x p
  Gain sway_on{}, drive{}, drift{};  ///< p x p, p x m, p x 1
  Gain begin{}, begin_rest{};        ///< p x m, p x 1: states at rest with the contacts at y
  Gain stiffness{}, damping{};       ///< m x m: K and B, for the energy that is stored
  /// g of the sharper descent check under latency, 0 to 1 (Theorem A', control/scene/solve.h).
  double sharpen = 0;
  std::uint16_t max_sweeps = 0;  ///< 0: the proxies stay where they are
  double tolerance = 0;          ///< N: sweeps end when no force changes by more
};

}  // namespace hapticd::control
