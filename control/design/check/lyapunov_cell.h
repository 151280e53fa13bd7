// One cell of the proof in common_lyapunov.h: is |A z|_P < |z|_P for every loop of it?
#pragma once
#include <cstddef>
#include <vector>

#include "control/design/check/common_lyapunov.h"
#include "control/design/check/held_box.h"

namespace hapticd::check {

/// P > 0 in the forms that the cells need it in: P = L L'.
struct Metric {
  explicit Metric(const Matrix& given);
  Matrix P, L, inverse;  ///< inverse: of L
  /// Largest value of a row over |z|_P = 1.
  double size(const Matrix& row) const { return (row * inverse.transpose()).norm(); }
};

class CellCheck {
 public:
  /// `box`: lumped, and not excluded.
  CellCheck(const SampledLoop& loop, const LoopBox& box);
  HeldBox whole() const;
  /// Least margin of the dissipation inequalities, without unit; -1: one is not shown.
  double margin(const HeldRange& range, const Metric& metric) const;
  /// The same for the loop in the middle of the range alone.
  double middle_margin(const HeldRange& range, const Metric& metric) const;
  /// The side along which the loop changes most, of `first` .. `end` - 1.
  std::size_t longest(const HeldRange& range, const Metric& metric, std::size_t first,
                      std::size_t end) const;
  /// The loops of a cell.
  LoopBox box_of(const HeldBox& cell) const;
  /// The loop in the middle of a cell, with all of the contact.
  LoopCase middle(const HeldBox& cell) const;

 private:
  /// Rows of the loop that do not depend on the device, at one share of contact.
  struct Rows {
    Matrix q;     ///< 4 x n: x, v, command before and after
    Matrix kept;  ///< (n - 2) x n
  };
  double margin_at(const HeldRange::Gains& gains, const HeldRange::Gains& remainder,
                   const Rows& rows, const Metric& metric) const;

  LoopBox box_;
  double period_s_, slot_s_;
  std::vector<Rows> rows_;
};

}  // namespace hapticd::check
