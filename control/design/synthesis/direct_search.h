// Couplings of one spring and one damper an axis, by direct search over their numbers.
//
// A stiffer coupling is nearer to the scene, so the best ones lie on the boundary of what is safe:
// the search goes over the ratios of the stiffnesses and over the dampers, and each point is scaled
// to the boundary. It polls along the axes of a basis that is turned in every round (the goal has
// kinks where two frequencies are equally bad), keeps what is better and shrinks where nothing is.
// Deterministic: the turns come from a fixed sequence. The scene's response is computed once, on a
// grid that knows its poles; what comes out is verified by the checks, not by the grid.
#pragma once
#include "control/design/synthesis/exact_certificate.h"
#include "control/design/synthesis/transparency.h"

namespace hapticd::synthesis {

struct DirectGoal {
  System scene;           ///< E: m to N, m x m, stable, E(1) symmetric >= 0
  check::Vector damping;  ///< of the device on each axis, N s/m
  double latency_s = 0;
  double period_s = 1e-3;
  Weights weights;  ///< for the loop-shaping norm
};

struct DirectDesign {
  check::Vector stiffness, damper;  ///< N/m, N s/m; empty: none found
  double gamma = 0;                 ///< loop-shaping norm, upper bound
  double margin = 0;                ///< exact_margin with this scene, N s/m
  StorageAnswer certificate;        ///< of the exact test, where that is what was asked
  std::string why;
};

/// Most transparent coupling that is safe with every passive scene: K T/2 + B < share Delta, with
/// latency (up to one period) Theorem B's quadratic (check/latency.h). 0 < share < 1.
DirectDesign most_transparent_for_any_scene(const DirectGoal& goal, double share);

/// Most transparent coupling, B >= 0, with exact_margin >= margin_Ns_m for this scene alone.
DirectDesign most_transparent_exact(const DirectGoal& goal, double margin_Ns_m);

/// Springs `pattern` (> 0) times the largest factor with exact_margin >= margin_Ns_m, B = 0.
DirectDesign stiffest_exact(const DirectGoal& goal, const check::Vector& pattern,
                            double margin_Ns_m);

}  // namespace hapticd::synthesis
