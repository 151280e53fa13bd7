#include "control/scene/cuts.h"

#include <cmath>
#include <limits>

namespace hapticd::control {
namespace {

/// Planes whose normals enclose less than this (sine squared, or volume squared) count as parallel.
constexpr double kParallel = 1e-20;
/// A point lies on a plane to this share of its distance from the origin.
constexpr double kOnPlane = 1e-9;
/// A cut is fulfilled to this share of the longest step that a single cut asks for.
constexpr double kFulfilled = 1e-12;

/// Cuts relative to a point: a step s fulfils cut i if normal.s >= step[i].
struct Steps {
  const Cuts& cuts;
  std::array<double, 4> step{};
  double tolerance = 0;
  Vec3 best{};
  double best_squared = std::numeric_limits<double>::infinity();

  void propose(const Vec3& s) noexcept {
    const double squared = squared_norm(s);
    if (!(squared < best_squared)) return;
    for (std::size_t i = 0; i < cuts.count; ++i)
      if (!(dot(cuts.cut[i].normal, s) >= step[i] - tolerance)) return;
    best = s;
    best_squared = squared;
  }
};

/// The shortest step onto two planes.
void propose_line(Steps& steps, std::size_t i, std::size_t j) noexcept {
  const Vec3 &n = steps.cuts.cut[i].normal, &m = steps.cuts.cut[j].normal;
  const Vec3 along = cross(n, m);
  const double sine_squared = squared_norm(along);
  if (sine_squared <= kParallel) return;
  steps.propose((1 / sine_squared) *
                (steps.step[i] * cross(m, along) + steps.step[j] * cross(along, n)));
}

/// The step onto three planes.
void propose_corner(Steps& steps, std::size_t i, std::size_t j, std::size_t k) noexcept {
  const Vec3 &l = steps.cuts.cut[i].normal, &m = steps.cuts.cut[j].normal;
  const Vec3& n = steps.cuts.cut[k].normal;
  const Vec3 mn = cross(m, n);
  const double volume = dot(l, mn);
  if (volume * volume <= kParallel) return;
  steps.propose((1 / volume) *
                (steps.step[i] * mn + steps.step[j] * cross(n, l) + steps.step[k] * cross(l, m)));
}

}  // namespace

bool project(const Cuts& cuts, const Vec3& p, Vec3& to) noexcept {
  Steps steps{.cuts = cuts};
  for (std::size_t i = 0; i < cuts.count; ++i) {
    steps.step[i] = cuts.cut[i].offset - dot(cuts.cut[i].normal, p);
    steps.tolerance = std::fmax(steps.tolerance, kFulfilled * std::fabs(steps.step[i]));
  }
  steps.propose({});
  for (std::size_t i = 0; i < cuts.count; ++i) {
    steps.propose(steps.step[i] * cuts.cut[i].normal);
    for (std::size_t j = i + 1; j < cuts.count; ++j) {
      propose_line(steps, i, j);
      for (std::size_t k = j + 1; k < cuts.count; ++k) propose_corner(steps, i, j, k);
    }
  }
  if (!(steps.best_squared < std::numeric_limits<double>::infinity())) return false;
  to = p + steps.best;
  return true;
}

void keep_active(Cuts& cuts, const Vec3& at) noexcept {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cuts.count; ++i) {
    const Cut cut = cuts.cut[i];
    const double above = dot(cut.normal, at) - cut.offset;
    if (above <= kOnPlane * (std::fabs(cut.offset) + norm(at))) cuts.cut[kept++] = cut;
  }
  cuts.count = kept < 3 ? kept : 3;
  if (kept > 3) cuts.cut = {cuts.cut[1], cuts.cut[2], cuts.cut[3]};
}

}  // namespace hapticd::control
