// Spectral radii of paper 2's loop with a classic observer: the rows of tests/data/paper2.
#pragma once

namespace hapticd::test {

struct ObserverRadii {
  int order;
  double wall_Ns_m;  ///< 0: free device, else a wall of 1000 N/m
  bool late;
  double radius[11];  ///< by cut-off
};
inline constexpr double kObserverCutoff_Hz[] = {2, 5, 10, 20, 30, 50, 80, 100, 150, 200, 300};
inline constexpr ObserverRadii kObserverRadii[] = {
#include "tests/data/paper2/observer_spectral_radius.inc"
};

}  // namespace hapticd::test
