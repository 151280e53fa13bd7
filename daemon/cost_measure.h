// How long a tick of a rig takes, and how much longer than that of another one. Two rigs take turns
// in short batches, so that a busy machine slows both alike; medians over the batches.
#pragma once
#include <cstddef>

#include "daemon/cost_rig.h"

namespace hapticd::daemon {

inline constexpr std::size_t kBatches = 101;

/// Nanoseconds per tick.
struct Figure {
  double ns = 0;
  double resolution_ns = 0;  ///< > 0: a difference below it may be none
  bool seen() const noexcept { return ns > resolution_ns; }
};

/// Of a whole tick of `rig`; `ticks` of them in all, at least one a batch.
Figure tick_time(CostRig& rig, std::size_t ticks);

/// What a tick of `with` takes more than one of `without`, never below zero.
///   ns          median of the differences of neighbouring batches
///   resolution  three standard errors of that median (1.253 sigma / sqrt(n), sigma of the quartiles),
///               at least `floor_ns`
Figure difference(CostRig& with, CostRig& without, std::size_t ticks, double floor_ns);

/// What two rigs of one program differ by: less than this says nothing. Of several tries the
/// largest.
double resolution_floor_ns(const build::ProgramSpec& spec, const Walk& walk, std::size_t ticks);

/// The median of figures and its resolution as above; `values` are put in order.
Figure median_figure(std::vector<double>& values, double floor_ns);

}  // namespace hapticd::daemon
