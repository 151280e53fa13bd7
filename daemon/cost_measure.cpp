#include "daemon/cost_measure.h"

#include <algorithm>
#include <cmath>

#include "daemon/monotonic.h"

namespace hapticd::daemon {
namespace {

constexpr std::size_t kWarmTicks = 200;  // the walk ten times: contacts made, caches filled
constexpr int kFloorTries = 5;

double batch_ns(CostRig& rig, std::size_t ticks) {
  const std::int64_t began = monotonic_ns();
  rig.run(ticks);
  return static_cast<double>(monotonic_ns() - began) / static_cast<double>(ticks);
}

std::size_t batch_ticks(std::size_t ticks) {
  return std::max<std::size_t>(1, ticks / kBatches);
}

}  // namespace

Figure median_figure(std::vector<double>& values, double floor_ns) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const double quartiles = values[3 * n / 4] - values[n / 4];
  constexpr double kSigmaPerQuartiles = 1 / 1.349;  // of a normal distribution
  const double error = 1.253 * kSigmaPerQuartiles * quartiles / std::sqrt(static_cast<double>(n));
  return {.ns = std::max(0.0, values[n / 2]), .resolution_ns = std::max(floor_ns, 3 * error)};
}

Figure tick_time(CostRig& rig, std::size_t ticks) {
  rig.run(kWarmTicks);
  std::vector<double> times(kBatches);
  for (double& time : times) time = batch_ns(rig, batch_ticks(ticks));
  return median_figure(times, 0);
}

Figure difference(CostRig& with, CostRig& without, std::size_t ticks, double floor_ns) {
  with.run(kWarmTicks);
  without.run(kWarmTicks);
  std::vector<double> more(kBatches);
  for (std::size_t i = 0; i < kBatches; ++i) {
    // Who goes first changes, so that a clock that speeds up favours neither.
    const bool first = i % 2 == 0;
    const double one = batch_ns(first ? with : without, batch_ticks(ticks));
    const double other = batch_ns(first ? without : with, batch_ticks(ticks));
    more[i] = first ? one - other : other - one;
  }
  return median_figure(more, floor_ns);
}

double resolution_floor_ns(const build::ProgramSpec& spec, const Walk& walk, std::size_t ticks) {
  double floor = 0;
  for (int i = 0; i < kFloorTries; ++i) {
    CostRig one(spec), other(spec);
    one.walk(walk);
    other.walk(walk);
    one.run(kWarmTicks);
    floor = std::max(floor, difference(one, other, ticks, 0).ns);
  }
  return floor;
}

}  // namespace hapticd::daemon
