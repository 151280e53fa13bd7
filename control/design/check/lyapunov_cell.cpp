#include "control/design/check/lyapunov_cell.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hapticd::check {
namespace {

using Gains = HeldRange::Gains;

/// A side, wider by the rounding of what it was computed from. One without length stays so, and its
/// rounding counts among the slips of margin_at().
Interval range_of(Side side) {
  return side.low == side.high ? Interval(side.low) : widened(side.low, side.high);
}

double middle_of(const Interval& side) {
  return 0.5 * (side.low + side.high);
}

}  // namespace

Metric::Metric(const Matrix& given)
    : P(given), L(Eigen::LLT<Matrix>(symmetric_part(given)).matrixL()) {
  inverse = L.triangularView<Eigen::Lower>().solve(Matrix::Identity(P.rows(), P.rows()));
}

CellCheck::CellCheck(const SampledLoop& loop, const LoopBox& box)
    : box_(box), period_s_(loop.period_s) {
  LoopCase one = cases_of(box).front();
  const int remembered = remembered_in(loop, box);
  slot_s_ = split_latency(one.latency_s, loop.period_s).ticks * loop.period_s;
  for (const double contact : {box.contact.low, box.contact.high}) {
    one.contact = contact;
    const Tick tick = tick_of(loop, one, remembered);
    const Eigen::Index n = tick.kept.rows() + 2;
    Rows rows{Matrix::Zero(4, n), tick.kept.leftCols(n)};
    rows.q.topLeftCorner(2, 2).setIdentity();
    rows.q.row(2) = tick.before.leftCols(n);
    rows.q.row(3) = tick.after.leftCols(n);
    rows_.push_back(rows);
    if (box.contact.low == box.contact.high) break;
  }
}

HeldBox CellCheck::whole() const {
  const double first = std::max(0.0, box_.latency_s.low - slot_s_);
  const double last = std::min(period_s_, std::max(first, box_.latency_s.high - slot_s_));
  return {range_of({1 / box_.mass_kg.high, 1 / box_.mass_kg.low}), range_of(box_.damping_Ns_m),
          range_of(box_.hand_N_m), Interval(first, last)};
}

double CellCheck::margin(const HeldRange& range, const Metric& metric) const {
  double least = std::numeric_limits<double>::infinity();
  for (unsigned corner = 0; corner < 16; ++corner) {
    Gains gains = range.centre;
    bool repeated = false;
    for (unsigned i = 0; i < 4; ++i) {
      const bool high = (corner >> i & 1u) != 0;
      repeated = repeated || (high && range.half[i].isZero(0));
      gains += (high ? 1 : -1) * range.half[i];
    }
    if (repeated) continue;
    for (const Rows& rows : rows_) {
      const double margin = margin_at(gains, range.remainder, rows, metric);
      if (!(margin > 0)) return -1;
      least = std::min(least, margin);
    }
  }
  return least;
}

double CellCheck::middle_margin(const HeldRange& range, const Metric& metric) const {
  HeldRange point = range;
  for (Gains& half : point.half) half.setZero();
  point.remainder = 1e-13 * range.centre.cwiseAbs();
  return margin(point, metric);
}

double CellCheck::margin_at(const Gains& gains, const Gains& remainder, const Rows& rows,
                            const Metric& metric) const {
  const Eigen::Index n = rows.q.cols();
  Dissipation d;
  d.A.resize(n, n);
  d.A << gains * rows.q, rows.kept;
  // F: q over its own sizes s_j. E = diag(e): D = remainder s_j / e_i then has |D|^2 <= 1, half of it
  // from each row.
  Matrix F = rows.q;
  Eigen::Vector4d sizes;
  for (Eigen::Index j = 0; j < 4; ++j) {
    sizes[j] = std::max(metric.size(rows.q.row(j)), 1e-300);
    F.row(j) /= sizes[j];
  }
  d.B = Matrix::Zero(n, 2);
  for (Eigen::Index i = 0; i < 2; ++i)
    d.B(i, i) =
        std::sqrt(2.0) * (1 + 1e-12) * remainder.row(i).transpose().cwiseProduct(sizes).norm() +
        1e-300;
  const double lambda =
      (metric.L.transpose() * d.B).norm() / (F * metric.inverse.transpose()).norm();
  d.S = Matrix::Zero(2, n);
  d.R = lambda * Matrix::Identity(2, 2);
  d.Y = std::sqrt(lambda) * F;
  d.error_Y = 1e-15 * d.Y.cwiseAbs();
  const Verdict verdict = proves(d, metric.P);
  // A's first rows were rounded, and the sides of the box were: by less than this, in coordinates in
  // which P = I.
  const Matrix slips = 1e-12 * (gains.cwiseAbs() * rows.q.cwiseAbs());
  const double slip =
      (metric.L.cwiseAbs().transpose().leftCols(2) * slips * metric.inverse.cwiseAbs().transpose())
          .norm();
  return verdict.holds ? verdict.margin - 4 * slip : -1;
}

std::size_t CellCheck::longest(const HeldRange& range, const Metric& metric, std::size_t first,
                               std::size_t end) const {
  std::size_t worst = first;
  double most = -1;
  for (std::size_t i = first; i < end; ++i) {
    double owed = 0;
    for (Eigen::Index j = 0; j < 4; ++j) {
      const double size = metric.size(rows_.back().q.row(j));
      for (Eigen::Index row = 0; row < 2; ++row)
        owed += std::abs(range.half[i](row, j)) * size * metric.L.row(row).norm();
    }
    if (owed > most) most = owed, worst = i;
  }
  return worst;
}

LoopBox CellCheck::box_of(const HeldBox& cell) const {
  LoopBox box = box_;
  box.mass_kg = {1 / cell[0].high, 1 / cell[0].low};
  box.damping_Ns_m = {cell[1].low, cell[1].high};
  box.hand_N_m = {cell[2].low, cell[2].high};
  return box;
}

LoopCase CellCheck::middle(const HeldBox& cell) const {
  return {.mass_kg = 1 / middle_of(cell[0]),
          .damping_Ns_m = middle_of(cell[1]),
          .hand_N_m = middle_of(cell[2]),
          .latency_s = slot_s_ + middle_of(cell[3]),
          .contact = box_.contact.high};
}

}  // namespace hapticd::check
