// Where axes and contacts may be.
//
//   travel      a bounded spring from each end of an axis' free range outwards, and a fault `margin`
//               further out
//   workspace   a box of the world that the contact may be in, else a fault
//
// Both only once every axis is homed: before that nobody knows where anything is.
#pragma once
#include <array>
#include <cstdint>

#include "control/core/capacity.h"
#include "control/core/findings.h"

namespace hapticd::control {

struct Plan;
struct State;

struct TravelPlan {
  std::uint16_t axis = 0;
  double min = 0, max = 0;  ///< m or rad: the free range
  double stiffness = 0;     ///< N/m or N m/rad, >= 0
  double max_effort = 0;    ///< N or N m: the spring never pushes more
  double margin = 0;        ///< m or rad, > 0: so far beyond an end is Fault::travel
};

struct WorkspacePlan {
  std::uint16_t device = 0;
  std::array<double, kMaxContactCoordinates> min{}, max{};  ///< m
};

/// state.travel [N or N m]; sets Limit::travel where a spring pushes, reports Fault::travel and
/// Fault::workspace.
void bound(const Plan& plan, State& state, Findings& findings) noexcept;

}  // namespace hapticd::control
