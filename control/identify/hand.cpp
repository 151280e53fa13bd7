#include "control/identify/hand.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "control/identify/student.h"

namespace hapticd::identify {
namespace {

constexpr int kHandUnknowns = 4;  // mass, viscous, stiffness, share of the steps
constexpr std::size_t kLeastTones = kHandUnknowns;

using HandRow = Eigen::Matrix<double, kHandUnknowns, 1>;
using HandNormal = Eigen::Matrix<double, kHandUnknowns, kHandUnknowns>;

/// Held effort at the sample, less its mean with the weights of a second difference, per effort. With
/// a delay of n periods and the share q of one: in the period before the sample the effort of n + 2
/// ticks ago acts for q and then that of n + 1, in the one after it that of n + 1 and then of n.
std::complex<double> steps(double turn, double delay_periods) {
  const double n = std::floor(delay_periods), q = delay_periods - n;
  const auto ago = [&](double ticks) { return std::polar(1.0, -turn * ticks); };
  const double oldest = q * q / 2, newest = (1 - q) * (1 - q) / 2;
  return ago(n + 1) * (oldest + newest) - oldest * ago(n + 2) - newest * ago(n);
}

/// Equations of all blocks of one frequency, weighted by the ticks behind them.
struct Tone {
  std::vector<HandRow> rows;
  std::vector<double> right;

  void add(const std::complex<double> (&left)[kHandUnknowns], std::complex<double> force,
           double weight) {
    HandRow real, imaginary;
    for (int i = 0; i < kHandUnknowns; ++i) {
      real(i) = weight * left[i].real();
      imaginary(i) = weight * left[i].imag();
    }
    rows.insert(rows.end(), {real, imaginary});
    right.insert(right.end(), {weight * force.real(), weight * force.imag()});
  }
};

Tone tone_of(const Record& record, const Signal& position, const Signal& effort,
             const Signal& force, const Measured& at, double delay_s) {
  const double period = record.period_s;
  const double turn = 2 * std::numbers::pi * at.frequency_Hz * period;
  const double second = -2 * (1 - std::cos(turn)) / (period * period);
  const std::complex<double> first(0, std::sin(turn) / period);
  const std::complex<double> step = steps(turn, delay_s / period);
  Tone tone;
  for (int block = 0; block < at.blocks; ++block) {
    const auto part = [&](const Signal& signal) {
      return coefficient(block_of(signal, at, block), at.periods, false);
    };
    if (block_of(force, at, block).empty()) break;
    const std::complex<double> x = part(position), u = part(effort);
    tone.add({second * x, first * x, x, step * u}, -part(force),
             std::sqrt(static_cast<double>(at.block_ticks)));
  }
  return tone;
}

/// Least squares over all tones, and the covariance by tones as clusters or by residuals, whichever
/// is larger.
struct Solution {
  HandRow value = HandRow::Zero();
  HandRow half_width = HandRow::Zero();
};

Solution solve(const std::vector<Tone>& tones) {
  HandNormal normal = HandNormal::Zero();
  HandRow right = HandRow::Zero();
  double equations = 0;
  for (const Tone& tone : tones) {
    for (std::size_t i = 0; i < tone.rows.size(); ++i, ++equations) {
      normal += tone.rows[i] * tone.rows[i].transpose();
      right += tone.rows[i] * tone.right[i];
    }
  }
  const HandRow scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const HandNormal scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const HandNormal inverse = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  Solution found{.value = inverse * right};
  HandNormal scatter = HandNormal::Zero();
  double squares = 0;
  for (const Tone& tone : tones) {
    HandRow score = HandRow::Zero();
    for (std::size_t i = 0; i < tone.rows.size(); ++i) {
      const double r = tone.right[i] - tone.rows[i].dot(found.value);
      score += tone.rows[i] * r;
      squares += r * r;
    }
    scatter += score * score.transpose();
  }
  const auto count = static_cast<double>(tones.size());
  const double left = std::max(1.0, count - kHandUnknowns);
  const HandRow robust = (count / left * inverse * scatter * inverse).diagonal();
  const HandRow plain = squares / std::max(1.0, equations - kHandUnknowns) * inverse.diagonal();
  found.half_width =
      student_99(std::max(4.0, left)) * robust.cwiseMax(plain).cwiseMax(0).cwiseSqrt();
  return found;
}

}  // namespace

Result<HandFit> fit_hand(const Record& record, const Signal& force,
                         std::span<const Measured> measured, const HandOptions& options) {
  const Signal position = positions(record), effort = efforts(record);
  std::vector<Tone> tones;
  for (const Measured& at : measured) {
    Tone tone = tone_of(record, position, effort, force, at, options.delay_s);
    if (!tone.rows.empty()) tones.push_back(std::move(tone));
  }
  if (tones.size() <= kLeastTones)
    return fail(ExitCode::no, "too few frequencies were measured to tell what the hand is");
  const bool silent =
      std::all_of(force.begin(), force.end(), [&](double f) { return f == force.front(); });
  if (silent) return fail(ExitCode::no, "the force sensor never changed: is a hand on the axis?");
  const Solution found = solve(tones);
  const auto impedance = [](const HandRow& row) { return HandImpedance{row(0), row(1), row(2)}; };
  return HandFit{.value = impedance(found.value),
                 .half_width = impedance(found.half_width),
                 .force_per_position = stepped_response(force, position, measured)};
}

}  // namespace hapticd::identify
