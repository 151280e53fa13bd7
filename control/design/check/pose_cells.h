// Branch and bound over boxes ("cells") of poses, best first.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <queue>
#include <vector>

#include "control/core/capacity.h"
#include "control/design/check/interval.h"

namespace hapticd::check {

/// A box of poses, over joints or over places of the tip.
struct Cell {
  std::array<double, kMaxJoints> low{}, high{};
  double middle(std::size_t i) const { return 0.5 * (low[i] + high[i]); }
  double half(std::size_t i) const { return 0.5 * (high[i] - low[i]); }
};

/// What is known of a cell.
struct CellVerdict {
  bool outside = false;      ///< none of it is in the guarded workspace
  double bound = kInfinite;  ///< share of the damping that any pose of it asks, at most
  double bending = 0;        ///< of that
  double found = 0;          ///< what its middle asks, if that is in the workspace
  std::array<double, 3> pose{};
};

struct CellSearch {
  double bound = 0, bending = 0, found = 0;
  std::array<double, 3> pose{};
  bool met = false;
};

/// Largest share over `root`. `judge(cell)` -> CellVerdict. Ends when bound and what was found are
/// within 2 %, or after `budget` cells: the bound holds all the same. Cells are cut in two where
/// they are longest, lengths compared after dividing by `unit`.
template <class Judge>
CellSearch search_cells(const Cell& root, std::size_t dimensions,
                        const std::array<double, kMaxJoints>& unit, std::size_t budget,
                        const Judge& judge) {
  constexpr double kNear = 1.02;
  struct Entry {
    Cell cell;
    CellVerdict verdict;
    bool operator<(const Entry& other) const { return verdict.bound < other.verdict.bound; }
  };
  std::priority_queue<Entry> open;
  CellSearch best;
  const auto look_at = [&](const Cell& cell) {
    CellVerdict verdict = judge(cell);
    if (verdict.outside) return;
    if (!(verdict.bound >= 0)) verdict.bound = kInfinite;  // not a number: nothing is known
    if (verdict.found > best.found || (verdict.found > 0 && !best.met)) {
      best.found = verdict.found;
      best.pose = verdict.pose;
      best.met = true;
    }
    open.push({cell, verdict});
  };
  look_at(root);
  while (!open.empty() && budget > 0) {
    const Entry top = open.top();
    if (top.verdict.bound - top.verdict.bending <= kNear * best.found) break;
    open.pop();
    std::size_t longest = 0;
    for (std::size_t i = 1; i < dimensions; ++i)
      if (top.cell.half(i) / unit[i] > top.cell.half(longest) / unit[longest]) longest = i;
    Cell lower = top.cell, upper = top.cell;
    lower.high[longest] = upper.low[longest] = top.cell.middle(longest);
    look_at(lower);
    look_at(upper);
    budget -= std::min<std::size_t>(budget, 2);
  }
  if (!open.empty()) {
    best.bound = open.top().verdict.bound;
    best.bending = open.top().verdict.bending;
  }
  return best;
}

}  // namespace hapticd::check
