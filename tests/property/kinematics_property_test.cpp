// Whatever the device, its pose and its scale: inverse undoes forward, no power is made on the way
// between joints and contact, and nothing that is not a number comes out.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>

#include "tests/support/generators.h"
#include "tests/support/linkage_fixture.h"

namespace hapticd::control {
namespace {

using Eigen::Vector3d;
using test::any_number;
using test::JointAngles;
using test::LinkageRig;
using test::Mount;

RC_GTEST_PROP(FiveBarProperty, InverseAndForwardUndoEachOther, ()) {
  const double l = any_number(0.05, 1);
  const FiveBar bars{.link_m = l, .base_m = l * any_number(0, 1)};
  const std::array<double, 3> tip{l * any_number(-0.7, 0.7), l * any_number(0.2, 1.9), 0};
  JointAngles q{}, again{};
  if (!joints_of(bars, tip, q.data())) RC_DISCARD("out of reach");
  LinkagePose pose;
  RC_ASSERT(pose_of(bars, q.data(), pose));
  // Near a singular pose a rounding error of the angles is a large one of the tip.
  const double sensitivity = l + test::jacobian_of(pose, 2).norm();
  RC_ASSERT((test::tip_of(pose) - Vector3d(tip.data())).norm() < 1e-13 * sensitivity);
  RC_ASSERT(joints_of(bars, pose.tip, again.data()));
  RC_ASSERT(std::cos(again[0] - q[0]) + std::cos(again[1] - q[1]) > 2 - 1e-12);
}

RC_GTEST_PROP(DeltaProperty, InverseAndForwardUndoEachOther, ()) {
  const std::array<double, 3> tip{any_number(-0.05, 0.05), any_number(-0.05, 0.05),
                                  any_number(0.08, 0.17)};
  JointAngles q{};
  if (!joints_of(test::falcon(), tip, q.data())) RC_DISCARD("out of reach");
  LinkagePose pose{.tip = {any_number(-0.1, 0.1), any_number(-0.1, 0.1), any_number(-0.1, 0.2)}};
  RC_ASSERT(pose_of(test::falcon(), q.data(), pose));
  RC_ASSERT((test::tip_of(pose) - Vector3d(tip.data())).norm() < 1e-12);
}

/// Angles beyond the box: a pose that is found is one that the closed inverse agrees with.
RC_GTEST_PROP(DeltaProperty, ForwardFindsOnlyPosesOfTheAssembledDevice, ()) {
  const JointAngles q{any_number(-1, 2), any_number(-1, 2), any_number(-1, 2)};
  LinkagePose pose{.tip = test::falcon().home};
  if (!pose_of(test::falcon(), q.data(), pose)) RC_DISCARD("no pose");
  JointAngles again{};
  RC_ASSERT(joints_of(test::falcon(), pose.tip, again.data()));
  for (std::size_t i = 0; i < 3; ++i) RC_ASSERT(std::abs(again[i] - q[i]) < 1e-9);
}

Mount any_mount(std::uint16_t axes, std::uint16_t coordinates) {
  const Eigen::Quaterniond turn(any_number(-1, 1), any_number(-1, 1), any_number(-1, 1),
                                any_number(0.001, 1));
  return {.axes = axes,
          .coordinates = coordinates,
          .turn = std::pow(10, any_number(-1, 1)) * turn.normalized().toRotationMatrix(),
          .origin = {any_number(-1, 1), any_number(-1, 1), any_number(-1, 1)}};
}

/// tau.qd = f.v, relative to the largest power that any joint takes part in.
template <class Kind>
void power_is_preserved(const Kind& kind, const Mount& mount, const JointAngles& q) {
  LinkageRig rig(kind, mount);
  JointAngles qd{};
  for (double& rate : qd) rate = any_number(-10, 10);
  if (rig.forward(q.data(), qd.data()).fault.code != Fault::none) RC_DISCARD("no pose");
  std::array<double, 4> force{};
  std::array<double, 1 + kMaxJoints> effort{};
  for (double& component : force) component = any_number(-10, 10);
  transpose(rig.plan(), rig.state(), force, effort);
  double at_joints = 0, at_contact = 0, scale = 0;
  for (std::size_t j = 1; j <= mount.axes; ++j) {
    at_joints += effort[j] * rig.state().qd[j];
    scale += std::abs(effort[j] * rig.state().qd[j]);
  }
  for (std::size_t i = 1; i <= mount.coordinates; ++i) {
    at_contact += force[i] * rig.state().v[i];
    scale += std::abs(force[i] * rig.state().v[i]);
  }
  RC_ASSERT(std::abs(at_joints - at_contact) <= 1e-12 * scale);
}

std::uint16_t any_count(int low, int high) {
  return static_cast<std::uint16_t>(*rc::gen::inRange(low, high + 1));
}

RC_GTEST_PROP(PowerProperty, OfTurnedCartesianAxesIsPreserved, ()) {
  LinearMap map;
  const std::uint16_t axes = any_count(1, 3);
  for (auto& row : map.columns) {
    for (std::size_t j = 0; j < axes; ++j) row[j] = any_number(-1, 1);
  }
  const JointAngles q{any_number(-1, 1), any_number(-1, 1), any_number(-1, 1)};
  power_is_preserved(map, any_mount(axes, any_count(1, 3)), q);
}

RC_GTEST_PROP(PowerProperty, OfAFiveBarIsPreserved, ()) {
  const JointAngles q{any_number(0, 2 * M_PI), any_number(-M_PI, M_PI)};
  power_is_preserved(test::five_bar(), any_mount(2, any_count(1, 3)), q);
}

RC_GTEST_PROP(PowerProperty, OfADeltaIsPreserved, ()) {
  const JointAngles q{any_number(-0.2, 1.3), any_number(-0.2, 1.3), any_number(-0.2, 1.3)};
  power_is_preserved(test::falcon(), any_mount(3, any_count(1, 3)), q);
}

RC_GTEST_PROP(PowerProperty, OfASerialChainIsPreserved, ()) {
  JointAngles q{};
  for (double& angle : q) angle = any_number(-3, 3);
  Serial chain = *rc::gen::arbitrary<bool>() ? test::six_joints() : test::mixed_joints();
  chain.joints = std::min(chain.joints, any_count(1, 6));
  power_is_preserved(chain, any_mount(chain.joints, any_count(1, 3)), q);
}

double any_joint() {
  const auto bits = *rc::gen::arbitrary<std::uint64_t>();
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return *rc::gen::weightedElement<double>({{3, value},
                                            {3, 1e-3 * static_cast<double>(bits % 3000)},
                                            {1, NAN},
                                            {1, HUGE_VAL},
                                            {1, 1e308}});
}

template <class Kind>
void stays_finite(const Kind& kind, const Mount& mount) {
  LinkageRig rig(kind, mount);
  for (int tick = 0; tick < 4; ++tick) {
    JointAngles q{};
    for (double& joint : q) joint = any_joint();
    rig.forward(q.data());
    for (std::size_t i = 1; i < 4; ++i) {
      RC_ASSERT(std::isfinite(rig.state().x[i]));
      RC_ASSERT(std::isfinite(rig.state().v[i]));
    }
    for (const double entry : rig.state().jacobian) RC_ASSERT(std::isfinite(entry));
    RC_ASSERT(rig.reach() >= 0 && rig.reach() <= 1);
  }
}

RC_GTEST_PROP(LinkageProperty, WhatIsNotANumberNeverComesOut, ()) {
  const LinearMap map{.columns = {{{0.6, -0.8, 0}, {0.8, 0.6, 0}, {0, 0, 1}}}};
  const Mount three{.axes = 3, .coordinates = 3}, two{.axes = 2, .coordinates = 3};
  stays_finite(map, three);
  stays_finite(test::five_bar(), two);
  stays_finite(test::falcon(), three);
  stays_finite(test::mixed_joints(), three);
  stays_finite(test::six_joints(), {.axes = 6, .coordinates = 3});
}

}  // namespace
}  // namespace hapticd::control
