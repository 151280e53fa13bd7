#include "control/design/check/pose_delta.h"

namespace hapticd::check {

using Eigen::Matrix3d;
using Eigen::Vector3d;

DeltaChart::DeltaChart(const PoseChart& chart, const control::Delta& delta)
    : PoseChart(chart), delta_(delta), longest_step_(steps_.norm()) {
  weigh_.setZero();
  weigh_.topRows(S_.rows()) = S_ * turn_;
}

DeltaChart::Legs DeltaChart::legs(const std::array<Interval, 3>& tip) const {
  Legs out;
  const Jet3 x = Jet3::variable(tip[0], 0), y = Jet3::variable(tip[1], 1),
             w = Jet3::variable(tip[2], 2);
  const control::Delta& d = delta_;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [c, s] = d.leg[i];
    const Jet3 across = c * y - s * x + Jet3(d.f - d.s);
    const Jet3 flat = Jet3(d.b * d.b) - square(across);
    const Jet3 rod = Jet3(d.d + d.e) + root(flat);
    const Jet3 u = c * x + s * y + Jet3(d.c - d.r);
    const Jet3 rho2 = square(u) + square(w);
    const Jet3 along =
        (1 / (2 * d.a)) * ((rho2 + Jet3(d.a * d.a) - square(rod)) * inverse(root(rho2)));
    out.no_pose =
        out.no_pose || flat.value.high < 0 || along.value.low > 1 || along.value.high < -1;
    out.angle[i] = direction(w, u) - arc_cosine(along);
  }
  return out;
}

/// A by the equation of each leg, g(p, q) = 0: dq/dp = -g_p / g_q. Not finite where there is no pose.
Matrix3d DeltaChart::middle_slopes(const std::array<double, 3>& tip) const {
  const control::Delta& d = delta_;
  Matrix3d slopes;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [c, s] = d.leg[i];
    const double across = c * tip[1] - s * tip[0] + d.f - d.s,
                 flat = std::sqrt(d.b * d.b - across * across);
    const double rod = d.d + d.e + flat, u = c * tip[0] + s * tip[1] + d.c - d.r, w = tip[2];
    const double rho = std::hypot(u, w);
    const double along = (rho * rho + d.a * d.a - rod * rod) / (2 * d.a * rho);
    const double q = std::atan2(w, u) - std::acos(along);
    const double by_u = u - d.a * std::cos(q), by_w = w - d.a * std::sin(q);
    const double by_v = rod * across / flat, by_q = d.a * (u * std::sin(q) - w * std::cos(q));
    slopes.row(static_cast<int>(i)) << c * by_u - s * by_v, s * by_u + c * by_v, by_w;
    slopes.row(static_cast<int>(i)) /= -by_q;
  }
  return slopes;
}

Cell DeltaChart::reachable() const {
  const control::Delta& d = delta_;
  const double far = d.a + d.b + std::abs(d.d + d.e) + std::abs(d.c) + std::abs(d.r) +
                     std::abs(d.f) + std::abs(d.s);
  Cell cell;
  for (std::size_t i = 0; i < 3; ++i) cell.low[i] = -far, cell.high[i] = far;
  if (!box_ || at_.coordinates != 3) return cell;
  // p = turn^-1 (x - origin): a box around the corners of the workspace box.
  const Matrix3d back = Matrix3d(turn_).inverse();
  for (int i = 0; i < 3; ++i) {
    double middle = 0, half = 0;
    for (int j = 0; j < 3; ++j) {
      const auto k = static_cast<std::size_t>(j);
      middle += back(i, j) * (0.5 * (box_->min[k] + box_->max[k]) - at_.origin[k]);
      half += std::abs(back(i, j)) * 0.5 * (box_->max[k] - box_->min[k]);
    }
    const auto k = static_cast<std::size_t>(i);
    cell.low[k] = std::max(cell.low[k], middle - half * kDenseMargin);
    cell.high[k] = std::min(cell.high[k], middle + half * kDenseMargin);
  }
  return cell;
}

CellVerdict DeltaChart::operator()(const Cell& cell) const {
  CellVerdict verdict;
  std::array<Interval, 3> range;
  std::array<double, 3> middle;
  ChartVector half(3);
  for (std::size_t i = 0; i < 3; ++i) {
    range[i] = {cell.low[i], cell.high[i]};
    middle[i] = cell.middle(i);
    half[static_cast<Eigen::Index>(i)] = cell.half(i);
  }
  verdict.outside = !(cell.low[0] <= cell.high[0] && cell.low[1] <= cell.high[1] &&
                      cell.low[2] <= cell.high[2]) ||
                    !may_be_in_box(contact_of(range));
  if (!verdict.outside) judge(middle, half, verdict);
  return verdict;
}

void DeltaChart::judge(const std::array<double, 3>& tip, const ChartVector& half,
                       CellVerdict& verdict) const {
  const Matrix3d a = middle_slopes(tip);
  const bool known = a.allFinite();
  const Matrix3d j = known ? Matrix3d(a.inverse()) : Matrix3d::Zero();
  const double stretch = spectral3(j);
  const double margin = known ? 1.5 * stretch * longest_step_ : 0;
  std::array<Interval, 3> wide;
  for (std::size_t i = 0; i < 3; ++i) {
    const double reach = half[static_cast<Eigen::Index>(i)] + margin;
    wide[i] = {tip[i] - reach, tip[i] + reach};
  }
  const Legs around = legs(wide);
  verdict.outside = around.no_pose;
  if (verdict.outside || !known || !j.allFinite()) return;

  Matrix3d change;
  double curved2 = 0;  // of D^(1/2) d2q/dp2, Frobenius
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (std::size_t k = 0; k < 3; ++k) {
      double sum = 0;
      for (std::size_t l = 0; l < 3; ++l) {
        const double bend = around.angle[i].bend[Jet3::pair(k, l)].size();
        sum += bend * (half[static_cast<Eigen::Index>(l)] + margin);
        curved2 += squared(bend / spread_[row]);
      }
      change(row, static_cast<Eigen::Index>(k)) = sum;
    }
  }
  const double error = change.norm() * kDenseMargin;
  std::array<Interval, 3> place;
  for (std::size_t i = 0; i < 3; ++i) place[i] = tip[i];
  const std::array<Interval, 3> contact = contact_of(place);
  std::array<double, 3> x{};
  for (std::size_t i = 0; i < 3; ++i) x[i] = 0.5 * (contact[i].low + contact[i].high);
  const Matrix3d scaled = j * spread_.asDiagonal();
  const double asked = spectral3(weigh_ * scaled);
  std::array<double, 3> q{};
  const bool assembled = control::joints_of(delta_, tip, q.data());
  // J is regular all over the cell, so the device is assembled in it everywhere or nowhere.
  const bool regular = error * stretch * kDenseMargin < 1;
  const bool guarded = assembled && is_guarded(x, turn_ * j);
  if (guarded) {
    verdict.found = squared(asked);
    verdict.pose = x;
  }
  verdict.outside =
      (regular && !assembled) || (!guarded && at_.coordinates == 3 && is_surely_singular(a, error));
  if (verdict.outside) return;
  const Eigen::Vector3d opening = Vector3d(spread_).cwiseInverse();
  const double e = (opening.asDiagonal() * change).norm() * spectral3(scaled) * kDenseMargin;
  const double longest = stretch / (1 - error * stretch * kDenseMargin);
  if (!regular || !(e < 1) || !(longest * longest_step_ <= margin || longest_step_ == 0)) return;
  const double yields = spectral3(scaled) / (1 - e);
  verdict.bending =
      bending_ * scale_ * yields * yields * yields * std::sqrt(curved2) * kDenseMargin;
  verdict.bound = squared(asked / (1 - e)) * kDenseMargin + verdict.bending;
}

}  // namespace hapticd::check
