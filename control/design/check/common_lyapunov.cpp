#include "control/design/check/common_lyapunov.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "control/design/check/lyapunov_cell.h"

namespace hapticd::check {
namespace {

constexpr std::size_t kLatencySide = 3;

enum class Outcome { holds, refuted, undecided };

/// Cuts boxes of loops into cells until all are proved.
class Prover {
 public:
  Prover(const SampledLoop& loop, const LoopBox& box, std::vector<Matrix>& P,
         std::size_t most_cells)
      : cells_(loop, lumped(box)), period_s_(loop.period_s), most_cells_(most_cells), P_(P) {
    for (const Matrix& one : P) metrics_.emplace_back(one);
  }

  /// The first P for all.
  CommonVerdict common() {
    HeldBox at = cells_.whole();
    return worded(prove(at, metrics_.front(), 0, most_cells_), at);
  }

  /// For every device and hand one P of all.
  CommonVerdict constant(const FindP& find) {
    std::vector<HeldBox> open = {cells_.whole()};
    while (!open.empty()) {
      const HeldBox cell = open.back();
      open.pop_back();
      if (some_proves(cell) || (find && found(find, cell) && some_proves(cell))) continue;
      const bool fits = middle_fits(cell, find);
      const std::optional<HeldRange> range = held_range(cell, period_s_);
      if (!range || used_ > most_cells_) return worded(Outcome::undecided, cell);
      if (!fits) return worded(Outcome::refuted, cell);
      halve(cell, cells_.longest(*range, metrics_.front(), 0, kLatencySide), open);
    }
    return worded(Outcome::holds, {});
  }

 private:
  /// Does a P hold for all of a box? Cut across sides from `first` on. `at`: the box, then where not.
  /// `known`: range of the box.
  Outcome prove(HeldBox& at, const Metric& metric, std::size_t first, std::size_t most,
                const std::optional<HeldRange>& known = std::nullopt) {
    std::vector<HeldBox> open = {at};
    double least = margin_;
    for (std::size_t cells = 0; !open.empty(); ++cells) {
      at = open.back();
      open.pop_back();
      if (cells == most || ++used_ > most_cells_) return Outcome::undecided;
      const std::optional<HeldRange> range =
          cells == 0 && known ? known : held_range(at, period_s_);
      if (!range) return Outcome::undecided;
      const double margin = cells_.margin(*range, metric);
      if (margin > 0) {
        least = std::min(least, margin);
        continue;
      }
      const std::size_t side = cells_.longest(*range, metric, first, 4);
      const bool divisible = at[side].high > at[side].low;
      if (!divisible || !(cells_.middle_margin(*range, metric) > 0)) return Outcome::refuted;
      halve(at, side, open);
    }
    margin_ = least;
    return Outcome::holds;
  }

  /// The last that did is asked first.
  bool some_proves(const HeldBox& cell) {
    constexpr std::size_t kLatencies = 64;  // cells across the latency alone
    const std::optional<HeldRange> range = held_range(cell, period_s_);
    if (!range) return false;
    for (std::size_t k = 0; k < metrics_.size(); ++k) {
      const std::size_t i = (last_ + k) % metrics_.size();
      HeldBox at = cell;
      if (prove(at, metrics_[i], kLatencySide, kLatencies, range) != Outcome::holds) continue;
      last_ = i;
      return true;
    }
    return false;
  }

  bool found(const FindP& find, const HeldBox& cell) {
    const Matrix P = find(cells_.box_of(cell));
    if (P.size() == 0 || !positive_definite(P)) return false;
    P_.push_back(P);
    metrics_.emplace_back(P);
    last_ = metrics_.size() - 1;
    return true;
  }

  /// Is there a P for the device in the middle of a cell? What it holds by is no part of the proof.
  bool middle_fits(HeldBox cell, const FindP& find) {
    const double margin = margin_;
    for (std::size_t i = 0; i < kLatencySide; ++i)
      cell[i] = Interval(0.5 * (cell[i].low + cell[i].high));
    const bool fits = some_proves(cell) || (find && found(find, cell) && some_proves(cell));
    margin_ = margin;
    return fits;
  }

  static void halve(const HeldBox& cell, std::size_t side, std::vector<HeldBox>& open) {
    const double middle = 0.5 * (cell[side].low + cell[side].high);
    open.insert(open.end(), 2, cell);
    open.back().at(side).high = open[open.size() - 2].at(side).low = middle;
  }

  CommonVerdict worded(Outcome outcome, const HeldBox& at) {
    CommonVerdict verdict;
    verdict.cells = used_;
    verdict.holds = outcome == Outcome::holds;
    verdict.refuted = outcome == Outcome::refuted;
    if (!verdict.holds) {
      verdict.at = cells_.middle(at);
      verdict.why = (verdict.refuted ? "no P holds at " : "undecided after too many cells at ") +
                    described(verdict.at);
      return verdict;
    }
    verdict.margin = margin_;
    char text[120];
    std::snprintf(text, sizeof text, "%zu quadratic Lyapunov function%s, %zu cells, margin %.3g",
                  metrics_.size(), metrics_.size() == 1 ? "" : "s", used_, margin_);
    verdict.why = text;
    return verdict;
  }

  CellCheck cells_;
  double period_s_ = 0;
  std::size_t most_cells_ = 0, used_ = 0, last_ = 0;
  std::vector<Matrix>& P_;
  std::vector<Metric> metrics_;
  double margin_ = std::numeric_limits<double>::infinity();
};

Eigen::Index order_of(const SampledLoop& loop, const LoopBox& box) {
  return 2 + loop.force.states() + remembered_in(loop, box) +
         (loop.observer ? observer_of(*loop.observer).states() : 0);
}

/// Each costs about the cube of the order.
std::size_t affordable(std::size_t cells, Eigen::Index order) {
  constexpr std::size_t kLeast = 40;
  const double share = std::pow(4.0 / static_cast<double>(std::max<Eigen::Index>(order, 4)), 3);
  return std::max(std::min(cells, kLeast),
                  static_cast<std::size_t>(share * static_cast<double>(cells)));
}

}  // namespace

LoopBox lumped(const LoopBox& box) {
  LoopBox sum = box;
  sum.mass_kg = {box.mass_kg.low + box.hand_kg.low, box.mass_kg.high + box.hand_kg.high};
  sum.damping_Ns_m = {box.damping_Ns_m.low + box.hand_Ns_m.low,
                      box.damping_Ns_m.high + box.hand_Ns_m.high};
  sum.hand_kg = sum.hand_Ns_m = {};
  return sum;
}

int remembered_in(const SampledLoop& loop, const LoopBox& box) {
  return split_latency(box.latency_s.low, loop.period_s).ticks + 1;
}

std::string excluded(const SampledLoop& loop, const LoopBox& box) {
  if (std::string why = malformed(loop, box); !why.empty()) return why;
  if (loop.observer && loop.observer->hand_share != 0)
    return "what an observer of mode sensor reads depends on the device";
  const int ticks = split_latency(box.latency_s.low, loop.period_s).ticks;
  if (box.latency_s.high > (ticks + 1) * loop.period_s)
    return "the latency's range is not within one period";
  if (box.contact.low == 0 && box.hand_N_m.low == 0)
    return "with the contact open nothing holds the device in its place: the hand's spring may be "
           "0";
  return {};
}

std::string unfit(const SampledLoop& loop, const LoopBox& box, const std::vector<Matrix>& P) {
  if (std::string why = excluded(loop, box); !why.empty()) return why;
  const Eigen::Index order = order_of(loop, box);
  if (order > kMostStates)
    return "the loop has " + std::to_string(order) + " states, and proofs are looked for up to " +
           std::to_string(kMostStates);
  for (const Matrix& one : P) {
    if (std::string why = malformed(one, order, "P"); !why.empty()) return why;
    if (!positive_definite(symmetric_part(one))) return "P is not positive definite";
  }
  return {};
}

CommonVerdict proves_common(const SampledLoop& loop, const LoopBox& box, const Matrix& P,
                            std::size_t most_cells) {
  CommonVerdict verdict;
  std::vector<Matrix> list = {P};
  verdict.why = unfit(loop, box, list);
  if (!verdict.why.empty()) return verdict;
  return Prover(loop, box, list, affordable(most_cells, order_of(loop, box))).common();
}

CommonVerdict proves_constant(const SampledLoop& loop, const LoopBox& box,
                              const std::vector<Matrix>& P, std::size_t most_cells) {
  std::vector<Matrix> list = P;
  return completes_constant(loop, box, list, nullptr, most_cells);
}

CommonVerdict completes_constant(const SampledLoop& loop, const LoopBox& box,
                                 std::vector<Matrix>& P, const FindP& find,
                                 std::size_t most_cells) {
  CommonVerdict verdict;
  verdict.why = unfit(loop, box, P);
  if (!verdict.why.empty()) return verdict;
  return Prover(loop, box, P, affordable(most_cells, order_of(loop, box))).constant(find);
}

}  // namespace hapticd::check
