#include "control/identify/output_error.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticd::identify {
namespace {

constexpr double kDifference = 1e-5;  // of a parameter's own scale
constexpr double kLag = 1e-3;         // periods, for a difference
constexpr int kMostStartSteps = 12;
constexpr int kMostShorter = 4;           // tries of a step, each a quarter as long
constexpr double kSettledShare = 0.9999;  // of the sum of squares that a step leaves

/// The start of an axis that friction holds has no effect: this lets it stay as it is.
Eigen::Matrix2d held_start(std::size_t samples, double period_s) {
  return Eigen::Vector2d(1e-9, 1e-6 * static_cast<double>(samples) * period_s * period_s)
      .asDiagonal();
}

double root_mean_square_effort(const Record& record) {
  double sum = 0;
  for (const Sample& sample : record.samples) sum += sample.effort * sample.effort;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, record.samples.size())));
}

}  // namespace

Shared vector_of(const Dynamics& axis) noexcept {
  return Shared(axis.mass, axis.viscous, axis.coulomb, axis.delay_s, axis.bias);
}

Dynamics dynamics_of(const Shared& v) noexcept {
  return {.mass = v(0), .viscous = v(1), .coulomb = v(2), .delay_s = v(3), .bias = v(4)};
}

SharedMatrix Block::information() const {
  return shared - cross.transpose() * start.inverse() * cross;
}

Shared Block::score(const Gradient& gradient) const {
  return gradient.shared - cross.transpose() * start.inverse() * gradient.start;
}

Motion Block::followed(const Motion& from, const Shared& step) const {
  const Eigen::Vector2d moved = start.inverse() * (cross * step);
  return {.position = from.position - moved(0), .velocity = from.velocity - moved(1)};
}

OutputError::OutputError(const Record& record, double high_Hz)
    : record_(record),
      rate_(2 * std::numbers::pi * high_Hz),
      effort_(root_mean_square_effort(record)) {}

/// Predicts a window; the sum of squares of what is left.
double OutputError::compare(const Dynamics& axis, const Window& window) {
  predicted_.resize(window.end - window.begin);
  predict(record_, axis, window, predicted_);
  double sum = 0;
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    const Sample& sample = record_.samples[window.begin + i];
    const double r = sample.fresh ? sample.position - predicted_[i] : 0;
    sum += r * r;
  }
  return sum;
}

double OutputError::fit_starts(const Dynamics& axis, std::vector<Window>& windows) {
  double sum = 0;
  for (Window& window : windows) sum += fit_start(axis, window);
  return sum;
}

/// Gauss and Newton over the two unknowns, from the velocity given and from rest: an axis that
/// friction holds does not tell of its velocity by small differences.
double OutputError::fit_start(const Dynamics& axis, Window& window) {
  Window resting = window;
  resting.start.velocity = 0;
  double least = compare(axis, window);
  const double least_resting = compare(axis, resting);
  if (least_resting < least) {
    window = resting;
    least = least_resting;
  }
  for (int i = 0; i < kMostStartSteps; ++i) {
    if (!improve_start(axis, window, least)) break;
  }
  return least;
}

/// False: no further step is worth while.
bool OutputError::improve_start(const Dynamics& axis, Window& window, double& least) {
  compare(axis, window);
  Window pushed = window;
  pushed.start.velocity += push(axis);
  moved_.resize(predicted_.size());
  predict(record_, axis, pushed, moved_);
  Eigen::Matrix2d normal = held_start(predicted_.size(), record_.period_s);
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < predicted_.size(); ++k) {
    const Sample& sample = record_.samples[window.begin + k];
    if (!sample.fresh) continue;
    const Eigen::Vector2d row(1, (moved_[k] - predicted_[k]) / push(axis));
    normal += row * row.transpose();
    right += row * (sample.position - predicted_[k]);
  }
  Eigen::Vector2d step = normal.inverse() * right;
  for (int tries = 0; tries < kMostShorter; ++tries, step *= 0.25) {
    Window next = window;
    next.start.position += step(0);
    next.start.velocity += step(1);
    const double squares = compare(axis, next);
    if (!(squares < least)) continue;
    const bool worth_while = squares < kSettledShare * least;
    window = next;
    least = squares;
    return worth_while;
  }
  return false;
}

double OutputError::push(const Dynamics& axis) const noexcept {
  return kDifference * effort_ / (axis.mass * rate_);
}

/// One-sided differences; each parameter in the scale in which it matters.
void OutputError::differentiate(const Dynamics& axis, const Window& window) {
  const std::size_t length = window.end - window.begin;
  predicted_.resize(length);
  moved_.resize(length);
  slopes_.resize(static_cast<Eigen::Index>(length), Eigen::NoChange);
  predict(record_, axis, window, predicted_);
  const auto column = [&](int index, double difference, const Dynamics& other, const Window& from) {
    predict(record_, other, from, moved_);
    for (std::size_t i = 0; i < length; ++i)
      slopes_(static_cast<Eigen::Index>(i), index) = (moved_[i] - predicted_[i]) / difference;
  };
  slopes_.col(0).setOnes();
  Window pushed = window;
  pushed.start.velocity += push(axis);
  column(1, push(axis), axis, pushed);
  const Shared difference = kDifference * Shared(axis.mass, axis.viscous + 0.1 * axis.mass * rate_,
                                                 effort_, record_.period_s, effort_);
  for (int p = 0; p < kShared; ++p) {
    Shared moved = vector_of(axis);
    moved(p) += difference(p);
    column(2 + p, difference(p), dynamics_of(moved), window);
  }
  Dynamics late = axis;
  late.lag_s = kLag * record_.period_s;
  column(2 + kShared, kLag, late, window);
}

Block OutputError::block(const Window& window) const {
  Block block;
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    const Sample& sample = record_.samples[window.begin + i];
    if (!sample.fresh) continue;
    const double r = sample.position - predicted_[i];
    const auto row = slopes_.row(static_cast<Eigen::Index>(i));
    const Eigen::Vector2d start = row.head<2>();
    const Shared shared = row.segment<kShared>(2);
    const double lag = row(2 + kShared);
    block.start += start * start.transpose();
    block.cross += start * shared.transpose();
    block.shared += shared * shared.transpose();
    block.residual.start += start * r;
    block.residual.shared += shared * r;
    block.lag.start += start * lag;
    block.lag.shared += shared * lag;
  }
  block.start += held_start(predicted_.size(), record_.period_s);
  return block;
}

std::vector<Block> OutputError::linearise(const Dynamics& axis,
                                          const std::vector<Window>& windows) {
  std::vector<Block> blocks;
  blocks.reserve(windows.size());
  for (const Window& window : windows) {
    differentiate(axis, window);
    blocks.push_back(block(window));
  }
  return blocks;
}

}  // namespace hapticd::identify
