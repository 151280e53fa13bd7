#include "control/design/check/h_infinity.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "control/design/check/balance.h"
#include "control/design/check/frequency.h"

namespace hapticd::check {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostSteps = 30;
/// An eigenvalue this near to the imaginary axis, relative to its size, counts as on it: a false
/// crossing costs one look at the response there, a missed one a wrong norm.
constexpr double kOnAxis = 1e-6;

System continuous(const System& g) {
  const Eigen::Index n = g.states();
  const Matrix identity = Matrix::Identity(n, n);
  const Eigen::PartialPivLU<Matrix> lu(g.A + identity);
  const Matrix b = lu.solve(g.B);
  const Matrix c = g.C * lu.inverse();
  return {lu.solve(g.A - identity), std::sqrt(2.0) * b, std::sqrt(2.0) * c, g.D - g.C * b};
}

/// Angles at which a singular value of the response is `level`.
std::vector<double> crossings(const System& c, double level) {
  const Eigen::Index n = c.states();
  const Matrix input = Matrix::Identity(c.inputs(), c.inputs());
  const Matrix output = Matrix::Identity(c.outputs(), c.outputs());
  const Matrix D = c.D / level;
  const Matrix C = c.C / level;
  const Matrix R = (input - D.transpose() * D).ldlt().solve(input);
  const Matrix Q = (output - D * D.transpose()).ldlt().solve(output);
  const Matrix A = c.A + c.B * R * D.transpose() * C;
  Matrix hamiltonian(2 * n, 2 * n);
  hamiltonian << A, c.B * R * c.B.transpose(), -C.transpose() * Q * C, -A.transpose();
  const Vector d = balance(hamiltonian);
  const Matrix balanced = d.cwiseInverse().asDiagonal() * hamiltonian * d.asDiagonal();
  std::vector<double> angles;
  const Eigen::VectorXcd roots = eigenvalues(balanced);
  for (const Complex& s : roots)
    if (std::abs(s.real()) <= kOnAxis * std::abs(s) && s.imag() >= 0)
      angles.push_back(2 * std::atan(s.imag()));
  std::sort(angles.begin(), angles.end());
  return angles;
}

}  // namespace

Norm h_infinity(const System& g, double tolerance) {
  const bool finite = g.A.allFinite() && g.B.allFinite() && g.C.allFinite() && g.D.allFinite();
  if (!finite) return {std::nan(""), std::nan(""), 0};
  const auto response = [&](double angle) { return largest_singular(at(g, on_circle(angle))); };
  if (g.states() == 0) return {response(0), response(0), 0};
  if (!(spectral_radius(g.A) < 1)) return {0, kInfinity, 0};
  const Extreme peak = largest(response, frequency_grid(g.A));
  Norm norm{peak.value, kInfinity, peak.angle};
  if (norm.lower == 0) return {0, 0, 0};
  const System c = continuous(g);
  for (int step = 0; step < kMostSteps; ++step) {
    const double level = (1 + tolerance) * norm.lower;
    std::vector<double> angles = crossings(c, level);
    angles.insert(angles.begin(), 0);
    angles.push_back(std::acos(-1.0));
    double most = 0, where = 0;
    for (std::size_t i = 0; i < angles.size(); ++i) {
      for (const double angle :
           {angles[i], i == 0 ? angles[i] : 0.5 * (angles[i] + angles[i - 1])}) {
        const double value = response(angle);
        if (value > most) most = value, where = angle;
      }
    }
    if (!(most > level)) {
      norm.upper = level;
      return norm;
    }
    norm = {most, kInfinity, where};
  }
  return norm;
}

}  // namespace hapticd::check
