#include "control/identify/first_guess.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticd::identify {
namespace {

constexpr int kUnknowns = 4;            // m, b, c, bias
constexpr double kDelayStep = 0.25;     // of a period
constexpr std::size_t kLeastTicks = 8;  // of a bump

using Row = Eigen::Matrix<double, kUnknowns, 1>;

/// sin^4(a s) over [0, L], a = pi/L, in ticks.
class Bump {
 public:
  explicit Bump(std::size_t ticks)
      : ticks_(static_cast<double>(ticks)), a_(std::numbers::pi / ticks_) {}

  double value(double s) const { return std::pow(std::sin(a_ * s), 4); }
  double slope(double s) const { return 4 * a_ * std::pow(std::sin(a_ * s), 3) * std::cos(a_ * s); }
  double curvature(double s) const {
    const double sine = std::sin(a_ * s), cosine = std::cos(a_ * s);
    return 4 * a_ * a_ * sine * sine * (3 * cosine * cosine - sine * sine);
  }
  /// Integral from 0 to s.
  double area(double s) const {
    const double x = std::clamp(s, 0.0, ticks_);
    return 0.375 * x - std::sin(2 * a_ * x) / (4 * a_) + std::sin(4 * a_ * x) / (32 * a_);
  }

 private:
  double ticks_, a_;
};

/// Sign of the velocity in each tick; 0 where the axis hardly moves.
std::vector<double> directions(const Record& record, std::size_t reach) {
  const auto& samples = record.samples;
  std::vector<double> step(samples.size(), 0);
  double largest = 0;
  for (std::size_t i = reach; i + reach < samples.size(); ++i) {
    step[i] = samples[i + reach].position - samples[i - reach].position;
    largest = std::max(largest, std::abs(step[i]));
  }
  for (double& s : step) s = std::clamp(50 * s / std::max(largest, 1e-300), -1.0, 1.0);
  return step;
}

/// The equations of all bumps of one length; the left sides do not depend on the delay.
class Equations {
 public:
  Equations(const Record& record, const std::vector<double>& direction, std::size_t ticks)
      : record_(record), bump_(ticks), ticks_(ticks), weight_(1 / std::sqrt(norm())) {
    const std::size_t stride = std::max<std::size_t>(1, ticks / 4);
    for (std::size_t at = 0; at + ticks < record.samples.size(); at += stride) {
      if (!whole(at)) continue;
      begins_.push_back(at);
      rows_.push_back(weight_ * left_side(at, direction));
    }
  }

  /// Adds to the normal equations.
  void add(double delay_ticks, Eigen::Matrix4d& normal, Row& right, double& square) const {
    const auto reach = static_cast<std::size_t>(std::ceil(delay_ticks));
    std::vector<double> share(ticks_ + reach + 1);  // of the effort of tick at - reach + i
    for (std::size_t i = 0; i < share.size(); ++i) {
      const double s = static_cast<double>(i) - static_cast<double>(reach) + delay_ticks;
      share[i] = weight_ * record_.period_s * (bump_.area(s + 1) - bump_.area(s));
    }
    for (std::size_t n = 0; n < begins_.size(); ++n) {
      if (begins_[n] < reach) continue;
      double effort = 0;
      for (std::size_t i = 0; i < share.size(); ++i)
        effort += share[i] * record_.samples[begins_[n] - reach + i].effort;
      normal += rows_[n] * rows_[n].transpose();
      right += rows_[n] * effort;
      square += effort * effort;
    }
  }

 private:
  /// Of the noise of an equation: sum of curvature^2.
  double norm() const {
    double sum = 0;
    for (std::size_t i = 0; i < ticks_; ++i) {
      const double c = bump_.curvature(static_cast<double>(i)) / record_.period_s;
      sum += c * c;
    }
    return sum;
  }
  bool whole(std::size_t at) const {
    const auto* first = &record_.samples[at];
    return std::all_of(first, first + ticks_, [](const Sample& s) { return s.fresh; });
  }
  Row left_side(std::size_t at, const std::vector<double>& direction) const {
    const double period = record_.period_s, origin = record_.samples[at].position;
    Row row = Row::Zero();
    for (std::size_t i = 0; i < ticks_; ++i) {
      const auto s = static_cast<double>(i);
      const double x = record_.samples[at + i].position - origin;
      row += Row(bump_.curvature(s) * x / period, -bump_.slope(s) * x,
                 bump_.value(s) * direction[at + i] * period, -bump_.value(s) * period);
    }
    return row;
  }

  const Record& record_;
  Bump bump_;
  std::size_t ticks_;
  double weight_;
  std::vector<std::size_t> begins_;
  std::vector<Row> rows_;
};

}  // namespace

std::optional<Dynamics> first_guess(const Record& record, const GuessOptions& options) {
  const auto fast = std::max(
      kLeastTicks, static_cast<std::size_t>(std::lround(1 / (options.high_Hz * record.period_s))));
  const std::vector<double> direction = directions(record, std::max<std::size_t>(2, fast / 8));
  const Equations equations[] = {{record, direction, fast}, {record, direction, 4 * fast}};
  double least = INFINITY;
  std::optional<Dynamics> best;
  const double longest = options.longest_delay_s / record.period_s;
  for (double delay = 0; delay <= longest; delay += kDelayStep) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Row right = Row::Zero();
    double square = 0;
    for (const Equations& of : equations) of.add(delay, normal, right, square);
    const Row scale = normal.diagonal().cwiseSqrt();
    if (scale(0) == 0) return {};
    const Row inverse = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0; });
    const Eigen::Matrix4d scaled = inverse.asDiagonal() * normal * inverse.asDiagonal();
    const Row p = inverse.asDiagonal() * scaled.ldlt().solve(inverse.asDiagonal() * right);
    const double residual = square - right.dot(p);
    if (!(residual < least) || !(p(0) > 0)) continue;
    least = residual;
    best = {.mass = p(0),
            .viscous = std::max(p(1), 0.0),
            .coulomb = std::max(p(2), 0.0),
            .delay_s = delay * record.period_s,
            .bias = p(3)};
  }
  return best;
}

}  // namespace hapticd::identify
