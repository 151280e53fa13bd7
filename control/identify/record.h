// What was measured of one axis: a sample a tick, without gaps.
#pragma once
#include <cstddef>
#include <vector>

namespace hapticd::identify {

/// m and N of a linear axis, rad and N m of a rotary one; so everywhere in this folder.
struct Sample {
  double position = 0;  ///< as sampled in this tick
  double effort = 0;    ///< as delivered in this tick; it acts one delay later, and is held
  bool fresh = true;    ///< the position is of this tick; else only the effort counts
};

struct Record {
  double period_s = 0;
  std::vector<Sample> samples;
};

}  // namespace hapticd::identify
