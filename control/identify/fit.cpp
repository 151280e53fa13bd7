#include "control/identify/fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "control/identify/first_guess.h"
#include "control/identify/output_error.h"
#include "control/identify/student.h"
#include "control/identify/windows.h"

namespace hapticd::identify {
namespace {

constexpr int kMostIterations = 30;
constexpr int kMostTries = 10;             // of one step, each ten times as damped
constexpr double kSettledStep = 0.05;      // standard errors
constexpr double kNearStep = 1;            // likewise, after all iterations
constexpr std::size_t kLeastWindows = 12;  // that intervals may rest on
constexpr double kUselessShare = 0.5;      // half-width of the mass: it is then not known
constexpr std::size_t kGroups = 16;        // of windows, see variances()
constexpr double kConsideredLag = 0.1;     // of a period: see fit.h

struct State {
  Dynamics axis;
  std::vector<Window> windows;
  double squares = 0;
};

/// S and its inverse, scaled so that units do not matter.
SharedMatrix inverse_of(const SharedMatrix& information) {
  const Shared scale =
      information.diagonal().unaryExpr([](double s) { return s > 0 ? 1 / std::sqrt(s) : 0; });
  SharedMatrix scaled = scale.asDiagonal() * information * scale.asDiagonal();
  scaled.diagonal().array() = 1 + 1e-12;
  return scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
}

class Descent {
 public:
  Descent(const Record& record, const FitOptions& options, State start)
      : error_(record, options.high_Hz), options_(options), at_(std::move(start)) {
    at_.squares = error_.fit_starts(at_.axis, at_.windows);
    for (const Window& window : at_.windows) {
      for (std::size_t i = window.begin; i < window.end; ++i) samples_ += record.samples[i].fresh;
    }
  }

  /// Where the sum of squares has a kink in the parameters, because a window sticks or slips, steps
  /// may go back and forth for ever: then it is enough that they are short against how well the
  /// parameters are known.
  Result<void> run() {
    for (iterations_ = 1; iterations_ <= kMostIterations; ++iterations_) {
      if (options_.proceed && !options_.proceed(iterations_))
        return fail(ExitCode::try_again, "the fit was interrupted");
      blocks_ = error_.linearise(at_.axis, at_.windows);
      if (!improve() || step_ <= kSettledStep) return {};
    }
    if (step_ <= kNearStep) return {};
    return fail(ExitCode::no,
                "the fit does not settle: the axis is no mass with damper and dry friction");
  }

  const State& at() const { return at_; }
  /// Of a linearisation at() or one settled step before it.
  const std::vector<Block>& blocks() const { return blocks_; }
  int iterations() const { return iterations_; }
  /// Of the measurement.
  double variance() const {
    const double unknowns = kShared + 2 * static_cast<double>(at_.windows.size());
    return at_.squares / std::max(1.0, samples_ - unknowns);
  }

 private:
  /// One step. False: no step, however short, makes it better.
  bool improve() {
    for (int tries = 0; tries < kMostTries; ++tries) {
      State next = stepped();
      next.squares = error_.fit_starts(next.axis, next.windows);
      if (next.squares < at_.squares) {
        step_ = relative_step(next);
        at_ = std::move(next);
        damping_ = std::max(damping_ / 10, 1e-9);
        return true;
      }
      damping_ *= 10;
    }
    return false;
  }

  State stepped() const {
    SharedMatrix normal = SharedMatrix::Zero();
    Shared gradient = Shared::Zero();
    for (const Block& block : blocks_) {
      normal += block.information();
      gradient += block.score(block.residual);
    }
    normal.diagonal() *= 1 + damping_;
    const Shared before = vector_of(at_.axis);
    State next = at_;
    next.axis = in_range(before + inverse_of(normal) * gradient, before(0) / 3);
    const Shared step = vector_of(next.axis) - before;
    for (std::size_t w = 0; w < blocks_.size(); ++w)
      next.windows[w].start = blocks_[w].followed(at_.windows[w].start, step);
    return next;
  }

  /// Of the parameter that moves most, in its standard errors.
  double relative_step(const State& next) const {
    SharedMatrix information = SharedMatrix::Zero();
    for (const Block& block : blocks_) information += block.information();
    const Shared error = (variance() * inverse_of(information).diagonal()).cwiseMax(0).cwiseSqrt();
    const Shared step = (vector_of(next.axis) - vector_of(at_.axis)).cwiseAbs();
    return (step.array() <= 1e-12 * vector_of(at_.axis).array().abs())
        .select(0, step.array() / error.array().max(1e-300))
        .maxCoeff();
  }

  Dynamics in_range(const Shared& v, double least_mass) const {
    return {.mass = std::max(v(0), least_mass),
            .viscous = std::max(v(1), 0.0),
            .coulomb = std::max(v(2), 0.0),
            .delay_s = std::clamp(v(3), 0.0, options_.longest_delay_s),
            .bias = v(4)};
  }

  OutputError error_;
  FitOptions options_;
  State at_;
  std::vector<Block> blocks_;
  double samples_ = 0;
  double damping_ = 1e-3;
  double step_ = 0;  ///< the last one, in standard errors
  int iterations_ = 0;
};

/// Scatter of the windows' scores, summed up over `together` windows in a row. The factor is for the
/// parameters that were fitted to them.
SharedMatrix scatter_of(const std::vector<Block>& blocks, std::size_t together) {
  SharedMatrix scatter = SharedMatrix::Zero();
  Shared score = Shared::Zero();
  double groups = 0;
  for (std::size_t w = 0; w < blocks.size(); ++w) {
    score += blocks[w].score(blocks[w].residual);
    if ((w + 1) % together != 0 && w + 1 != blocks.size()) continue;
    scatter += score * score.transpose();
    score.setZero();
    ++groups;
  }
  return groups / std::max(1.0, groups - kShared) * scatter;
}

/// Degrees of freedom of each parameter's variance, by the shares that windows have in it.
Shared degrees_of_freedom(const std::vector<Block>& blocks, const SharedMatrix& inverse) {
  Shared sum = Shared::Zero(), squares = Shared::Zero();
  for (const Block& block : blocks) {
    const Shared share = (inverse * block.information() * inverse).diagonal();
    sum += share;
    squares += share.cwiseAbs2();
  }
  return (sum.cwiseAbs2().array() / squares.array().max(1e-300) - 1).max(4.0);
}

/// What lags of up to one period, of whatever sign in each window, could do at worst.
Shared lag_bound(const std::vector<Block>& blocks, const SharedMatrix& inverse) {
  Shared sum = Shared::Zero();
  for (const Block& block : blocks) sum += (inverse * block.score(block.lag)).cwiseAbs();
  return sum;
}

/// Variances by single windows, by long groups of them and by the residuals; the largest counts. A
/// steady sine may repeat its errors from window to window, but not from one frequency to the next.
Shared variances(const std::vector<Block>& blocks, const SharedMatrix& inverse, double variance) {
  const std::size_t group = std::max<std::size_t>(1, blocks.size() / kGroups);
  Shared largest = variance * inverse.diagonal();
  for (const std::size_t together : {std::size_t{1}, group})
    largest = largest.cwiseMax((inverse * scatter_of(blocks, together) * inverse).diagonal());
  return largest.cwiseMax(0);
}

/// Half-widths of the 99 % intervals.
Shared half_widths(const std::vector<Block>& blocks, double variance) {
  SharedMatrix information = SharedMatrix::Zero();
  for (const Block& block : blocks) information += block.information();
  const SharedMatrix inverse = inverse_of(information);
  const Shared error = variances(blocks, inverse, variance).cwiseSqrt();
  const Shared lag = kConsideredLag * lag_bound(blocks, inverse);
  const Shared dof = degrees_of_freedom(blocks, inverse);
  Shared widths;
  for (int p = 0; p < kShared; ++p) widths(p) = std::hypot(student_99(dof(p)) * error(p), lag(p));
  return widths;
}

}  // namespace

Result<Fit> fit(const Record& record, const FitOptions& options) {
  const auto skip =
      static_cast<std::size_t>(std::ceil(options.longest_delay_s / record.period_s)) + 1;
  const auto guess = first_guess(record, {options.high_Hz, options.longest_delay_s});
  if (!guess)
    return fail(ExitCode::no,
                "the axis hardly moved, so nothing can be told of it; allow more force");
  State start{.axis = *guess, .windows = cut(record, options.window_s, skip)};
  if (start.windows.size() < kLeastWindows)
    return fail(ExitCode::no, "the record is too short to tell how well the figures are known");
  Descent descent(record, options, std::move(start));
  if (auto done = descent.run(); !done) return tl::unexpected(done.error());
  const Dynamics widths = dynamics_of(half_widths(descent.blocks(), descent.variance()));
  if (!(widths.mass < kUselessShare * descent.at().axis.mass)) {
    return fail(ExitCode::no,
                "the axis hardly moved, or not by the force: its mass cannot be told; allow more "
                "force");
  }
  return Fit{.value = descent.at().axis,
             .half_width = widths,
             .residual = std::sqrt(descent.variance()),
             .windows = descent.at().windows.size(),
             .iterations = descent.iterations()};
}

}  // namespace hapticd::identify
