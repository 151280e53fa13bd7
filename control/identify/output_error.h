// The sum of squares between predicted and measured positions, and its linearisation: normal
// equations with a block for each window's start, eliminated window by window.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "control/identify/motion.h"
#include "control/identify/record.h"
#include "control/identify/windows.h"

namespace hapticd::identify {

inline constexpr int kShared = 5;  ///< mass, viscous, coulomb, delay, bias
using Shared = Eigen::Matrix<double, kShared, 1>;
using SharedMatrix = Eigen::Matrix<double, kShared, kShared>;
Shared vector_of(const Dynamics& axis) noexcept;
Dynamics dynamics_of(const Shared& vector) noexcept;

/// J' e of one window for some residual e, by the shared parameters and by the start.
struct Gradient {
  Shared shared = Shared::Zero();
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
};

/// Normal equations of one window; J are the derivatives of its predictions.
struct Block {
  SharedMatrix shared = SharedMatrix::Zero();
  Eigen::Matrix<double, 2, kShared> cross = Eigen::Matrix<double, 2, kShared>::Zero();
  Eigen::Matrix2d start = Eigen::Matrix2d::Zero();
  Gradient residual{};  ///< of what was measured and not predicted
  Gradient lag{};       ///< of what friction would change that turns round a period late

  /// With the start eliminated.
  SharedMatrix information() const;
  Shared score(const Gradient& gradient) const;
  /// How a start that fits best follows a step of the shared parameters.
  Motion followed(const Motion& start, const Shared& step) const;
};

class OutputError {
 public:
  /// `high_Hz` only scales differences.
  OutputError(const Record& record, double high_Hz);

  /// Moves each window's start to where it fits best; the sum of squares that is left.
  double fit_starts(const Dynamics& axis, std::vector<Window>& windows);
  std::vector<Block> linearise(const Dynamics& axis, const std::vector<Window>& windows);

 private:
  double compare(const Dynamics& axis, const Window& window);
  double fit_start(const Dynamics& axis, Window& window);
  bool improve_start(const Dynamics& axis, Window& window, double& least);
  double push(const Dynamics& axis) const noexcept;
  void differentiate(const Dynamics& axis, const Window& window);
  Block block(const Window& window) const;

  const Record& record_;
  double rate_;    ///< highest, rad/s
  double effort_;  ///< root mean square
  std::vector<double> predicted_, moved_;
  Eigen::Matrix<double, Eigen::Dynamic, 3 + kShared> slopes_;  ///< by start, shared, lag
};

}  // namespace hapticd::identify
