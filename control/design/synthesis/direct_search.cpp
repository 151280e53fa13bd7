#include "control/design/synthesis/direct_search.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "control/design/check/frequency.h"
#include "control/design/check/latency.h"
#include "control/design/check/spring_damper.h"

namespace hapticd::synthesis {
namespace {

using check::Complex;
using check::ComplexMatrix;
using check::Vector;

constexpr double kStiffest = 1e9;  ///< N/m: no boundary is looked for beyond

struct Springs {
  Vector stiffness, damper;
};

/// The scene's response on a grid, and what a coupling makes of it there.
class Response {
 public:
  explicit Response(const DirectGoal& goal) : goal_(goal) {
    for (const double angle : check::frequency_grid(goal.scene.A, 40)) {
      if (angle == 0) continue;
      const Complex z = check::on_circle(angle);
      points_.push_back({angle, (1.0 - 1.0 / z) / goal.period_s, at(goal.scene, z),
                         at(goal.weights.left, z) * at(goal.scene, z), at(goal.weights.right, z)});
    }
  }

  double gamma(const Springs& springs) const {
    double most = 0;
    for (const Point& p : points_) {
      const ComplexMatrix gain = p.weighted * compliance(springs, p).asDiagonal() * p.right;
      const ComplexMatrix square = gain * gain.adjoint();
      most = std::max(most, -check::smallest_hermitian(-square));
    }
    return std::sqrt(most);
  }

  double margin(const Springs& springs) const {
    const Eigen::Index m = goal_.damping.size();
    double least = check::smallest_eigenvalue(goal_.damping.asDiagonal());
    for (const Point& p : points_) {
      const ComplexMatrix around =
          ComplexMatrix::Identity(m, m) + p.scene * compliance(springs, p).asDiagonal();
      const ComplexMatrix felt = around.partialPivLu().solve(p.scene);
      least = std::min(
          least, check::smallest_hermitian(check::exact_condition(
                     felt, goal_.damping.asDiagonal(), goal_.latency_s, goal_.period_s, p.angle)));
    }
    return least;
  }

 private:
  struct Point {
    double angle;
    Complex rate;  ///< (1 - 1/z)/T
    ComplexMatrix scene, weighted, right;
  };
  static Eigen::VectorXcd compliance(const Springs& springs, const Point& p) {
    return (springs.stiffness.cast<Complex>() + p.rate * springs.damper.cast<Complex>())
        .cwiseInverse();
  }
  const DirectGoal& goal_;
  std::vector<Point> points_;
};

using Room = std::function<double(const Springs&)>;  ///< >= 0: safe

/// Largest factor of the stiffness with room left, from `start` up or down; 0: none.
double to_boundary(const Springs& springs, double start, const Room& room) {
  const auto left = [&](double factor) {
    return room({factor * springs.stiffness, springs.damper});
  };
  double low = start, high = start;
  if (left(start) >= 0) {
    do {
      low = high;
      high *= 1.1;
      if (high * springs.stiffness.minCoeff() > kStiffest) return low;
    } while (left(high) >= 0);
  } else {
    do {
      high = low;
      low /= 1.1;
      if (low * springs.stiffness.maxCoeff() < 1e-3) return 0;
    } while (!(left(low) >= 0));
  }
  while (high - low > 1e-7 * low) {
    const double middle = 0.5 * (low + high);
    (left(middle) >= 0 ? low : high) = middle;
  }
  return low;
}

/// Columns: an orthogonal basis, another one for each `round`.
Matrix turned(Eigen::Index n, int round) {
  Vector v(n);
  std::uint32_t state = 12345u + 7919u * static_cast<std::uint32_t>(round);
  for (double& x : v) {
    state = 1664525u * state + 1013904223u;
    x = static_cast<double>(state >> 8) / 16777216.0 - 0.5;
  }
  if (round == 0) return Matrix::Identity(n, n);
  return Matrix::Identity(n, n) - 2 / v.squaredNorm() * v * v.transpose();
}

class Search {
 public:
  Search(const DirectGoal& goal, const Response& response, Room room)
      : goal_(goal), response_(response), room_(std::move(room)) {}

  /// Coordinates: logarithms of the stiffnesses, dampers over the device's damping.
  Springs best() {
    const Eigen::Index m = goal_.damping.size();
    Vector x(2 * m);
    x << (goal_.damping / goal_.period_s).array().log().matrix(), Vector::Zero(m);
    double value = evaluate(x);
    double stride = 0.2;
    for (int round = 0; stride > 2e-5 && round < 400; ++round) {
      const Matrix basis = turned(2 * m, round);
      bool better = false;
      for (Eigen::Index i = 0; i < 4 * m; ++i) {
        Vector y = x + (i % 2 == 0 ? stride : -stride) * basis.col(i / 2);
        y.tail(m) = y.tail(m).cwiseMax(0);
        const double found = evaluate(y);
        if (!(found < value * (1 - 1e-7))) continue;
        value = found;
        x = y;
        better = true;
      }
      stride *= better ? 1.3 : 0.7;
    }
    return scaled(x);
  }

 private:
  Springs scaled(const Vector& x) {
    const Eigen::Index m = goal_.damping.size();
    Springs springs{x.head(m).array().exp().matrix(), x.tail(m).cwiseProduct(goal_.damping)};
    const double factor = to_boundary(springs, factor_, room_);
    if (factor > 0) factor_ = factor;
    springs.stiffness *= factor;
    return springs;
  }
  double evaluate(const Vector& x) {
    const Springs springs = scaled(x);
    if (!(springs.stiffness.minCoeff() > 0)) return std::numeric_limits<double>::infinity();
    return response_.gamma(springs);
  }

  const DirectGoal& goal_;
  const Response& response_;
  Room room_;
  double factor_ = 1;  ///< the last boundary: the next is near
};

DirectDesign measured(const DirectGoal& goal, const Springs& springs) {
  DirectDesign design;
  if (!(springs.stiffness.size() > 0 && springs.stiffness.minCoeff() > 0)) {
    design.why = "no stiffness is safe";
    return design;
  }
  design.stiffness = springs.stiffness;
  design.damper = springs.damper;
  const System v = check::spring_damper(springs.stiffness.asDiagonal(), springs.damper.asDiagonal(),
                                        goal.period_s);
  design.gamma = loop_shaping_norm(goal.scene, v, goal.weights).upper;
  design.margin = check::exact_margin(check::feedback(goal.scene, v), goal.damping.asDiagonal(),
                                      goal.latency_s, goal.period_s);
  return design;
}

/// F; without dampers without the states that V then does not need.
System felt(const DirectGoal& goal, const Springs& springs) {
  if (springs.damper.isZero(0)) {
    const Matrix soft = springs.stiffness.cwiseInverse().asDiagonal();
    return check::feedback(goal.scene, check::constant(soft));
  }
  return check::feedback(
      goal.scene, check::spring_damper(springs.stiffness.asDiagonal(), springs.damper.asDiagonal(),
                                       goal.period_s));
}

/// Between the grid's points the margin may be smaller: step back until the refined one holds.
DirectDesign certified(const DirectGoal& goal, Springs springs, double margin) {
  DirectDesign design = measured(goal, springs);
  for (int step = 0; step < 40 && design.stiffness.size() > 0 && design.margin < margin; ++step) {
    springs.stiffness *= 1 - 1e-5 * (1 << std::min(step, 12));
    design = measured(goal, springs);
  }
  if (design.stiffness.size() == 0) return design;
  design.certificate = exact_certificate(felt(goal, springs), goal.damping.asDiagonal(),
                                         goal.latency_s, goal.period_s);
  design.why = design.certificate.why;
  return design;
}

std::string unusable(const DirectGoal& goal) {
  std::string problem = check::malformed(goal.scene);
  if (!problem.empty()) return problem;
  const bool damped = goal.damping.size() == goal.scene.inputs() && goal.damping.allFinite() &&
                      goal.damping.minCoeff() > 0;
  if (!damped) return "every axis needs a damping > 0";
  if (!(check::spectral_radius(goal.scene.A) < 1)) return "the scene is not stable";
  if (!(goal.period_s > 0 && goal.latency_s >= 0)) return "period or latency out of range";
  return check::rest(goal.scene).problem;
}

}  // namespace

DirectDesign most_transparent_for_any_scene(const DirectGoal& goal, double share) {
  DirectDesign none;
  none.why = unusable(goal);
  if (none.why.empty() && !(share > 0 && share < 1)) none.why = "the share must be in (0, 1)";
  if (none.why.empty() && goal.latency_s > goal.period_s)
    none.why = "latency of more than a period: no closed form";
  if (!none.why.empty()) return none;
  const Response response(goal);
  const Room room = [&](const Springs& springs) {
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < goal.damping.size(); ++i) {
      const double need = check::passive_scene_needs_damping(
          springs.stiffness(i), springs.damper(i), goal.latency_s, goal.period_s);
      least = std::min(least, share * goal.damping(i) - need);
    }
    return least;
  };
  DirectDesign design = measured(goal, Search(goal, response, room).best());
  if (design.why.empty()) design.why = "K and B keep the inequality for every passive scene";
  return design;
}

DirectDesign most_transparent_exact(const DirectGoal& goal, double margin_Ns_m) {
  DirectDesign none;
  none.why = unusable(goal);
  if (!none.why.empty()) return none;
  const Response response(goal);
  const Room room = [&](const Springs& s) { return response.margin(s) - margin_Ns_m; };
  return certified(goal, Search(goal, response, room).best(), margin_Ns_m);
}

DirectDesign stiffest_exact(const DirectGoal& goal, const check::Vector& pattern,
                            double margin_Ns_m) {
  DirectDesign none;
  none.why = unusable(goal);
  const bool positive = pattern.size() == goal.damping.size() && pattern.minCoeff() > 0;
  if (none.why.empty() && !positive) none.why = "the pattern must be > 0 on every axis";
  if (!none.why.empty()) return none;
  const Response response(goal);
  const Room room = [&](const Springs& s) { return response.margin(s) - margin_Ns_m; };
  Springs springs{pattern, Vector::Zero(pattern.size())};
  springs.stiffness *= to_boundary(springs, 1 / pattern.maxCoeff(), room);
  return certified(goal, springs, margin_Ns_m);
}

}  // namespace hapticd::synthesis
