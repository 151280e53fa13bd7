// Theorem A' on a linkage: its closed form for one turning link, and its inequality against the energy of many motions.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "control/design/check/stability.h"
#include "control/design/check/weights.h"
#include "tests/support/couplings.h"
#include "tests/support/linkage_fixture.h"

namespace hapticd::check {
namespace {

using Eigen::Vector2d;

constexpr double kPeriod_s = 1e-3, kLink_m = 0.2, kForce_N = 10;

/// One turning link of 0.2 m, its tip held to a proxy by springs.
build::ProgramSpec turning_link(double stiffness, double damping, double sharpen) {
  build::ProgramSpec spec;
  spec.axes = {{.max_effort = 1, .max_velocity = 0, .max_step = 1}};
  spec.devices = {{.axes = 1, .coordinates = 2, .max_force = kForce_N}};
  control::Linkage linkage{.axes = 1, .coordinates = 2, .rotary = true};
  linkage.turn = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  spec.linkages = {linkage};
  spec.serials = {{.joints = 1, .joint = {test::revolute(0, 0, kLink_m, 0)}}};
  spec.contacts = {{.device = 0, .coordinates = 2, .direction = {0, 1, 2}, .max_force = kForce_N}};
  spec.device_names = {"arm"};
  spec.axis_names = {"arm.q"};
  spec.coordinate_names = {"arm.x", "arm.y"};
  spec.coupling = {test::springs({0, 1}, test::matrix({{stiffness, 0}, {0, stiffness}}),
                                 test::matrix({{damping, 0}, {0, damping}}))};
  spec.sharpen = {sharpen};
  return spec;
}

PassiveAnswer answer(double stiffness, double latency_s, double joint_damping, double damping = 0,
                     double sharpen = 1) {
  const build::Program program(turning_link(stiffness, damping, sharpen));
  return passive(program.plan(),
                 {{.name = "arm", .latency_s = latency_s, .min_damping = {joint_damping}}})[0];
}

TEST(JointLatency, OneTurningLinkIsItsClosedForm) {
  for (const double share : {0.2, 0.5, 1.0}) {
    const double tau = share * kPeriod_s, s = coupled_weight(tau, kPeriod_s);
    const PassiveAnswer found = answer(300, tau, 0.1);
    ASSERT_TRUE(found.proved) << found.why;
    EXPECT_EQ(found.theorem, Theorem::any_static_scene_latency);
    const double exact = s * (300 * kLink_m * kLink_m + 2 * kForce_N * kLink_m) / 0.1;
    EXPECT_GE(found.damping_used, exact * (1 - 1e-9));
    EXPECT_LE(found.damping_used, 1.03 * exact);
  }
}

TEST(JointLatency, WhatTheProofIsNotAboutIsRefused) {
  EXPECT_TRUE(answer(300, 5e-4, 0.1).proved);
  EXPECT_FALSE(answer(300, 1.1e-3, 0.1).proved);               // longer than a period
  EXPECT_FALSE(answer(300, 5e-4, 0.1, 0.01).proved);           // dampers
  const PassiveAnswer blunt = answer(300, 5e-4, 0.1, 0, 0.3);  // descent check
  EXPECT_FALSE(blunt.proved);
  EXPECT_NE(blunt.why.find("too blunt"), std::string::npos);
  EXPECT_FALSE(answer(300, 5e-4, 0.01).proved);  // too little damping
}

/// The link before a wall at y = 0 or around a disc, rendered as the loop does: exact proxies that have to pass the
/// sharpened check, forces that end at 10 N; every torque one latency late.
class Link {
 public:
  Link(double stiffness, double tau_s, bool disc) : k_(stiffness), tau_(tau_s), disc_(disc) {}

  /// Energy that the virtual side took, and what the joint's damper took, by a motion a before and b after the torque
  /// changes.
  double move(double damping, double a, double b) {
    const double before = torque_;
    torque_ = render();
    q_ += a + b;
    return before * a + torque_ * b + damping * (a * a / tau_ + b * b / (kPeriod_s - tau_));
  }
  double stored() const { return potential(tip() - proxy_); }
  double angle() const { return q_; }

 private:
  Vector2d tip() const { return kLink_m * Vector2d(std::cos(q_), std::sin(q_)); }
  double potential(const Vector2d& d) const {
    const double f = k_ * d.norm();
    return f <= kForce_N ? 0.5 * f * f / k_ : kForce_N * (d.norm() - 0.5 * kForce_N / k_);
  }
  Vector2d nearest(const Vector2d& x) const {
    if (!disc_) return {x.x(), std::max(x.y(), 0.0)};
    const Vector2d from = x - kCentre;
    return from.norm() >= kRadius ? x : Vector2d(kCentre + kRadius / from.norm() * from);
  }
  /// dJ/dq at the accepted proxy.
  double render() {
    const Vector2d x = tip(), next = nearest(x);
    const double sharper = 0.5 * k_ * (next - proxy_).squaredNorm();
    if (potential(x - next) + sharper <= potential(x - proxy_)) proxy_ = next;
    const Vector2d d = x - proxy_;
    const double size = k_ * d.norm();
    const Vector2d force = (size > kForce_N ? kForce_N / size : 1.0) * k_ * d;
    return force.dot(kLink_m * Vector2d(-std::sin(q_), std::cos(q_)));
  }

  static inline const Vector2d kCentre{0.2, -0.03};
  static constexpr double kRadius = 0.03;
  double k_, tau_;
  bool disc_;
  double q_ = 0.02, torque_ = 0;
  Vector2d proxy_ = tip();
};

/// The most that shaking takes out of the virtual side and the damper together.
double most_taken(double stiffness, double tau, double damping, bool disc, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  double most = 0;
  for (int run = 0; run < 60; ++run) {
    Link link(stiffness, tau, disc);
    double taken = 0;
    const double step = std::pow(10, -4 + 2 * uniform(random)), turn = 0.05 + 3 * uniform(random);
    const double centre = -0.04 * uniform(random), noise = uniform(random) < 0.5 ? 0 : 0.3;
    for (int k = 0; k < 3000; ++k) {
      const double wanted =
          centre + step / turn * std::sin(turn * k) + noise * step * (uniform(random) - 0.5);
      const double move = std::clamp(wanted - link.angle(), -step, step);
      const double part = tau / kPeriod_s * (0.7 + 0.6 * uniform(random));
      taken -= link.move(damping, std::min(part, 1.0) * move, (1 - std::min(part, 1.0)) * move);
      most = std::max(most, taken - link.stored());
    }
  }
  return most;
}

TEST(JointLatency, NoMotionTakesEnergyOutOfWhatIsProvedAndSomeDoBeyond) {
  std::mt19937 random(3);
  constexpr double kStiffness = 2000;
  for (const bool disc : {false, true}) {
    for (const double share : {0.3, 0.7}) {
      SCOPED_TRACE(std::to_string(share) + (disc ? " disc" : " wall"));
      const double tau = share * kPeriod_s, s = coupled_weight(tau, kPeriod_s);
      const double bound = s * (kStiffness * kLink_m * kLink_m + 2 * kForce_N * kLink_m);
      EXPECT_LT(most_taken(kStiffness, tau, bound, disc, random), 1e-3);
      EXPECT_GT(most_taken(kStiffness, tau, 0.2 * bound, disc, random), 0.1);
    }
  }
}

}  // namespace
}  // namespace hapticd::check
