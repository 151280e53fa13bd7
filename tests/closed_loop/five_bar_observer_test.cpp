// Paper 2's two-degree-of-freedom device: 0.2 N commanded along x drags the tip along y too, as the
// links' inertia is not the same in all directions; the observer at the contact makes it feel like
// the nominal masses. Whole ticks around a five-bar model of its own; expected figures were computed
// elsewhere.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <vector>

#include "control/build/filters.h"
#include "tests/support/period.h"
#include "tests/support/program_fixture.h"

namespace hapticd::test {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector4d;

constexpr double kLink_m = 0.2, kBase_m = 0.1;
constexpr double kInner_kg = 0.010, kOuter_kg = 0.006, kTip_kg = 0.003, kMotor_kgm2 = 1e-5;
constexpr double kJoint_Nms = 8e-4;

Vector2d elbow(int i, const Vector2d& q) {
  const double base = i == 0 ? -kBase_m / 2 : kBase_m / 2;
  return Vector2d(base, 0) + kLink_m * Vector2d(std::cos(q[i]), std::sin(q[i]));
}

Vector2d tip(const Vector2d& q) {
  const Vector2d d = elbow(1, q) - elbow(0, q);
  const double height = std::sqrt(kLink_m * kLink_m - d.squaredNorm() / 4);
  return (elbow(0, q) + elbow(1, q)) / 2 + height / d.norm() * Vector2d(-d.y(), d.x());
}

Matrix2d elbow_jacobian(int i, const Vector2d& q) {
  Matrix2d result = Matrix2d::Zero();
  result.col(i) = kLink_m * Vector2d(-std::sin(q[i]), std::cos(q[i]));
  return result;
}

Matrix2d tip_jacobian(const Vector2d& q) {
  Matrix2d outer, drive = Matrix2d::Zero();
  for (int i = 0; i < 2; ++i) {
    const Vector2d r = tip(q) - elbow(i, q);
    outer.row(i) = r.transpose();
    drive(i, i) = r.dot(elbow_jacobian(i, q).col(i));
  }
  return outer.inverse() * drive;
}

/// Uniform rods; an outer one moves by a at its elbow and b at the tip: m/6 (a.a + a.b + b.b).
Matrix2d mass_matrix(const Vector2d& q) {
  const Matrix2d j = tip_jacobian(q);
  Matrix2d m = (kInner_kg * kLink_m * kLink_m / 3 + kMotor_kgm2) * Matrix2d::Identity() +
               kTip_kg * j.transpose() * j;
  for (int i = 0; i < 2; ++i) {
    const Matrix2d g = elbow_jacobian(i, q);
    const Matrix2d mixed = (g.transpose() * j + j.transpose() * g) / 2;
    m += kOuter_kg / 3 * (g.transpose() * g + mixed + j.transpose() * j);
  }
  return m;
}

/// State (q, q'): M q'' = tau - b q' - dM/dt q' + d/dq (q' M q' / 2).
Vector4d derivative(const Vector4d& state, const Vector2d& tau) {
  const Vector2d q = state.head<2>(), qd = state.tail<2>();
  constexpr double kStep = 1e-5;
  Vector2d bias = Vector2d::Zero();
  for (int k = 0; k < 2; ++k) {
    const Vector2d h = kStep * Vector2d::Unit(k);
    const Matrix2d slope = (mass_matrix(q + h) - mass_matrix(q - h)) / (2 * kStep);
    bias += qd[k] * slope * qd;
    bias[k] -= 0.5 * qd.dot(slope * qd);
  }
  Vector4d result;
  result << qd, mass_matrix(q).inverse() * (tau - kJoint_Nms * qd - bias);
  return result;
}

void advance(Vector4d& state, const Vector2d& tau) {
  constexpr int kSteps = 5;
  constexpr double h = kPeriod_s / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const Vector4d a = derivative(state, tau), b = derivative(state + h / 2 * a, tau);
    const Vector4d c = derivative(state + h / 2 * b, tau), d = derivative(state + h * c, tau);
    state += h / 6 * (a + 2 * b + 2 * c + d);
  }
}

Vector2d joints_at(const Vector2d& p) {
  const Vector2d left = p + Vector2d(kBase_m / 2, 0), right = p - Vector2d(kBase_m / 2, 0);
  return {std::atan2(left.y(), left.x()) + std::acos(left.norm() / (2 * kLink_m)),
          std::atan2(right.y(), right.x()) - std::acos(right.norm() / (2 * kLink_m))};
}

/// 0.2 N along x: a spring so long and soft that the way of the tip does not change it.
control::PlaneContact constant_push() {
  return {.coordinates = 2, .normal = {1, 0, 0}, .offset = 2e6, .stiffness = 1e-7};
}

build::ProgramSpec five_bar_spec(int order, double cutoff_Hz) {
  build::ProgramSpec spec = spec_of(2);
  spec.axes.assign(2, {.unit_per_raw = 1, .max_effort = 1e3, .max_velocity = 1e3, .max_step = 1e3});
  spec.devices[0].ramp_per_tick = 1;
  spec.linkages = {
      {.axes = 2, .coordinates = 2, .turn = {{{1, 0, 0}, {0, 1, 0}, {}}}, .rotary = true}};
  spec.five_bars = {{.link_m = kLink_m, .base_m = kBase_m}};
  spec.planes = {constant_push()};
  const double mass_kg[] = {0.0185, 0.0113};
  for (std::uint16_t i = 0; i < 2 && order > 0; ++i) {
    spec.contact_observers.push_back(build::observer(i, 0,
                                                     {.mode = build::ObserverMode::classic,
                                                      .nominal_mass_kg = mass_kg[i],
                                                      .nominal_damping_Ns_m = 0.02,
                                                      .cutoff_Hz = cutoff_Hz,
                                                      .order = order,
                                                      .max_output = 1e3},
                                                     kPeriod_s));
  }
  return spec;
}

/// mm, of the tip in 60 ms of the push.
Vector2d displacement_mm(const Vector2d& start, int order, double cutoff_Hz) {
  Rig rig(five_bar_spec(order, cutoff_Hz));
  Vector4d state = Vector4d::Zero();
  state.head<2>() = joints_at(start);
  for (int pushed = 0, tick = 0; pushed < 60; ++tick) {
    rig.samples[0].raw = state[0];
    rig.samples[1].raw = state[1];
    rig.input.enable = tick >= 5;
    const control::TickOutput output = rig.again();
    const Vector2d tau(output.effort[0], output.effort[1]);
    if (tau.isZero(0)) {
      if (tick > 20) return Vector2d::Zero();
      continue;
    }
    advance(state, tau);
    ++pushed;
  }
  return 1e3 * (tip(state.head<2>()) - start);
}

TEST(FiveBarObserver, ContactObserverTakesTheCouplingOfTheAxesAway) {
  struct Row {
    double x, y;
    int order;
    double cutoff_Hz, dx_mm, dy_mm;
  };
  for (const Row& row : {Row{0.05, 0.25, 0, 0, 19.5181026, 2.30335362},
                         Row{0.05, 0.25, 1, 30, 19.0935727, 0.43555007},
                         Row{0.05, 0.25, 1, 100, 19.0603183, 0.193948264},
                         Row{0.05, 0.25, 2, 30, 19.1400521, 0.730254316},
                         Row{-0.06, 0.22, 0, 0, 17.7646398, -4.27270289},
                         Row{-0.06, 0.22, 1, 30, 18.6452924, -0.772202917},
                         Row{-0.06, 0.22, 1, 100, 18.8534321, -0.341228642},
                         Row{-0.06, 0.22, 2, 30, 18.4124962, -1.30111966}}) {
    const Vector2d found = displacement_mm({row.x, row.y}, row.order, row.cutoff_Hz);
    SCOPED_TRACE(testing::Message() << row.x << ", " << row.y << ", order " << row.order << ", "
                                    << row.cutoff_Hz << " Hz");
    EXPECT_NEAR(found.x(), row.dx_mm, 1e-3 * row.dx_mm);
    EXPECT_NEAR(found.y(), row.dy_mm, 5e-3 * std::abs(row.dy_mm));
  }
}

TEST(FiveBarObserver, ModelHasThePublishedInertia) {
  const Vector2d q = joints_at({0, 0.25});
  EXPECT_NEAR(q[0], 2.25310712343, 1e-10);
  EXPECT_NEAR(mass_matrix(q)(0, 0), 0.0006980999576992, 1e-12);
  EXPECT_NEAR(mass_matrix(q)(0, 1), -0.000231311639409, 1e-12);
}

}  // namespace
}  // namespace hapticd::test
