// Couplings that the closed form accepts, with random passive hands: none is ever unstable. Couplings
// that it refuses: enough of them are, with the same hands, or this would prove nothing.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "tests/support/linear_systems.h"

namespace hapticd::test {
namespace {

struct Sweep {
  int couplings = 500, hands = 100;
};
/// HAPTICD_LONG=1 (tests/run.sh --long): two hundred times as many loops.
Sweep sweep() {
#ifdef HAPTICD_SANITIZED
  return {40, 12};
#else
  return std::getenv("HAPTICD_LONG") != nullptr ? Sweep{10'000, 1000} : Sweep{};
#endif
}

class PassiveHands {
 public:
  explicit PassiveHands(unsigned seed) : random_(seed) {}

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double decades(double low, double high) { return std::pow(10.0, uniform(low, high)); }

  /// Symmetric, eigenvalues over some decades.
  Matrix spread(Index m, double low, double high) {
    Matrix g(m, m);
    for (Index i = 0; i < m; ++i)
      for (Index j = 0; j < m; ++j) g(i, j) = uniform(-1, 1);
    const Matrix q = Eigen::HouseholderQR<Matrix>(g).householderQ();
    Vector d(m);
    for (Index i = 0; i < m; ++i) d[i] = decades(low, high);
    return q * d.asDiagonal() * q.transpose();
  }

  /// Devices of m axes with damping delta, held by masses (one more behind each axis), springs and
  /// dampers between everything: [x; v] of 2m points in continuous time, force on the first m.
  System device_and_hand(const Matrix& delta) {
    const Index m = delta.rows(), n = 2 * m;
    Matrix stiffness = Matrix::Zero(n, n), damping = Matrix::Zero(n, n);
    damping.topLeftCorner(m, m) = delta;
    const auto tie = [&](Matrix& to, Index i, Index j, double value) {
      to(i, i) += value;
      if (j < 0) return;
      to(j, j) += value;
      to(i, j) -= value;
      to(j, i) -= value;
    };
    Vector mass(n);
    for (Index i = 0; i < n; ++i) mass[i] = decades(-2.5, 0.5);
    for (Index i = m; i < n; ++i) tie(stiffness, i, i - m, decades(0, 5.5));  // none drifts away
    for (Index i = 0; i < n; ++i) {
      for (Index j = -1; j < i; ++j) {
        if (uniform(0, 1) < 0.5) tie(stiffness, i, j, decades(0, 5.5));
        if (uniform(0, 1) < 0.2) tie(damping, i, j, decades(-4, 1));
      }
    }
    System g;
    g.A = Matrix::Zero(2 * n, 2 * n);
    g.A.topRightCorner(n, n).setIdentity();
    g.A.bottomLeftCorner(n, n) = -(mass.cwiseInverse().asDiagonal() * stiffness);
    g.A.bottomRightCorner(n, n) = -(mass.cwiseInverse().asDiagonal() * damping);
    g.B = Matrix::Zero(2 * n, m);
    for (Index i = 0; i < m; ++i) g.B(n + i, i) = 1 / mass[i];
    g.C = Matrix::Zero(m, 2 * n);
    g.C.leftCols(m).setIdentity();
    g.D = Matrix::Zero(m, m);
    return g;
  }

 private:
  std::mt19937_64 random_;
};

/// Exact over a period in which the force is held.
System held(const System& g) {
  const Index n = g.states(), m = g.inputs();
  Matrix both = Matrix::Zero(n + m, n + m);
  both.topLeftCorner(n, n) = g.A * kPeriod;
  both.topRightCorner(n, m) = g.B * kPeriod;
  const Matrix step = algebra::exponential(both);
  return {step.topLeftCorner(n, n), step.topRightCorner(n, m), g.C, g.D};
}

/// Spring K and damper B between x and a wall that nothing moves: the hardest passive scene at the
/// sampling frequency.
System against_a_wall(const Matrix& K, const Matrix& B) {
  const Matrix last = B / kPeriod;
  return {Matrix::Zero(K.rows(), K.rows()), identity(K.rows()), -last, K + last};
}

/// Radius of the loop of device and hand against that wall. Many hands have modes that lose nothing, on the
/// unit circle up to rounding: where doubles cannot tell, long doubles do.
double radius_at_the_wall(const System& device, const Matrix& K, const Matrix& B) {
  const double quick =
      check::spectral_radius(check::feedback(held(device), against_a_wall(K, B)).A);
  if (quick < 1 + 1e-9) return quick;
  using Exact = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Index n = device.states(), m = device.inputs();
  const long double period = kPeriod;
  Exact both = Exact::Zero(n + m, n + m);
  both.topLeftCorner(n, n) = device.A.cast<long double>() * period;
  both.topRightCorner(n, m) = device.B.cast<long double>() * period;
  const Exact step = both.exp(), last = B.cast<long double>() / period;
  const Exact now = K.cast<long double>() + last, seen = device.C.cast<long double>();
  Exact loop = Exact::Zero(n + m, n + m);
  loop.topLeftCorner(n, n) = step.topLeftCorner(n, n) - step.topRightCorner(n, m) * now * seen;
  loop.topRightCorner(n, m) = step.topRightCorner(n, m) * last;
  loop.bottomLeftCorner(m, n) = seen;
  // In units of energy: velocities come some 1000 times as large as places.
  for (Index i = n / 2; i < n; ++i) loop.row(i) *= period, loop.col(i) /= period;
  const Eigen::EigenSolver<Exact> modes(loop, false);
  return static_cast<double>(modes.eigenvalues().cwiseAbs().maxCoeff());
}

TEST(PassiveHands, NoneShakesAnAcceptedCouplingAndSomeShakeRefusedOnes) {
  PassiveHands random(20100712);
  const auto [couplings, hands] = sweep();
  int accepted = 0, refused = 0, shaken = 0;
  for (int n = 0; n < couplings; ++n) {
    const Index m = 1 + n % 3;
    const Matrix delta = random.spread(m, -0.5, 0.5);
    Matrix K = random.spread(m, 0, 3),
           B = n % 2 == 0 ? Matrix(random.spread(m, -4, 0)) : Matrix(Matrix::Zero(m, m));
    // A share of the damping between what is far from the limit and three times as much.
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> share(K * kPeriod / 2 + B, delta);
    const double wanted = n % 2 == 0 ? random.uniform(0.5, 0.9999) : random.uniform(1.0001, 3);
    K *= wanted / share.eigenvalues().maxCoeff();
    B *= wanted / share.eigenvalues().maxCoeff();
    const bool accept = (delta - K * kPeriod / 2 - B).llt().info() == Eigen::Success;
    double largest = 0;
    for (int h = 0; h < hands; ++h) {
      largest = std::max(largest, radius_at_the_wall(random.device_and_hand(delta), K, B));
    }
    accept ? ++accepted : ++refused;
    if (accept) {
      EXPECT_LT(largest, 1 + 1e-9)
          << "coupling " << n << ", share " << wanted << ", radius - 1 = " << largest - 1;
    }
    shaken += !accept && largest > 1 + 1e-9;
  }
  EXPECT_GT(accepted, couplings / 3);
  EXPECT_GT(refused, couplings / 3);
  EXPECT_GT(shaken, refused / 100) << "these hands never shake anything";
  std::printf("%d accepted, none shakes; %d refused, %d of them shake\n", accepted, refused,
              shaken);
}

TEST(PassiveHands, TheBoundIsTightAtAWall) {
  // A device in the open, one axis: stable just below 2 delta / T, shaking just above.
  for (const double mass : {0.02, 0.5, 50.}) {
    System device{Matrix(2, 2), Matrix(2, 1), Matrix(1, 2), Matrix::Zero(1, 1)};
    device.A << 0, 1, 0, -kDamping / mass;
    device.B << 0, 1 / mass;
    device.C << 1, 0;
    const auto radius = [&](double K) {
      const System wall = against_a_wall(K * identity(1), Matrix::Zero(1, 1));
      return check::spectral_radius(check::feedback(held(device), wall).A);
    };
    EXPECT_LT(radius(2735), 1) << mass;
    if (mass == 50.) {
      EXPECT_GT(radius(2745), 1);
    }
  }
}

}  // namespace
}  // namespace hapticd::test
