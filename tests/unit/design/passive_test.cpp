// Which theorem proves a compiled plan, and what it says where none does.
#include <gtest/gtest.h>

#include <cmath>

#include "control/build/filters.h"
#include "control/design/check/stability.h"
#include "tests/support/couplings.h"
#include "tests/support/networks.h"
#include "tests/support/program_fixture.h"
#include "tests/support/scene_fixture.h"

namespace hapticd::check {
namespace {

using control::ObjectKind;

DeviceAssumption assumed(double damping, double latency_s = 0) {
  return {.name = "left", .latency_s = latency_s, .min_damping = {damping, damping, damping}};
}

PassiveAnswer answer(build::ProgramSpec spec, const DeviceAssumption& device,
                     const Certificate* certificate = nullptr) {
  const build::Program program(std::move(spec));
  return passive(program.plan(), {device}, certificate).at(0);
}

/// A sphere behind springs and dampers alike in all directions.
build::ProgramSpec behind_spring(double stiffness, double damping,
                                 control::Free free = control::Free::outside, double sharpen = 0) {
  build::ProgramSpec spec = test::scene_spec();
  test::add_object(spec, spec.spheres, ObjectKind::sphere, control::Sphere{{}, 0.05, free},
                   test::rigid(0.8, 0.4));
  spec.coupling = {
      test::spring_damper(0, {stiffness, stiffness, stiffness}, {damping, damping, damping})};
  spec.sharpen = {sharpen};
  return spec;
}

bool mentions(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

TEST(Theorems, TheOneThatProvesIsNamed) {
  EXPECT_EQ(answer(behind_spring(1000, 0.1), assumed(1.37)).theorem, Theorem::any_static_scene);
  const double g = 0.2 + 0.2 * 0.8e-3 * 1000 / 2;
  EXPECT_EQ(answer(behind_spring(1000, 0, control::Free::outside, g), assumed(2, 0.2e-3)).theorem,
            Theorem::any_static_scene_latency);
  const auto damped = answer(behind_spring(1000, 0.1, control::Free::inside), assumed(2, 0.2e-3));
  EXPECT_EQ(damped.theorem, Theorem::passive_scene) << damped.why;
  EXPECT_EQ(answer(behind_spring(4000, 0), assumed(1.37)).theorem, Theorem::none);
}

TEST(Theorems, StiffnessOf2735IsRefusedAtAFifthOfAPeriod) {
  for (const control::Free free : {control::Free::outside, control::Free::inside}) {
    EXPECT_TRUE(answer(behind_spring(2735, 0, free, 1), assumed(1.37)).proved);
    EXPECT_FALSE(answer(behind_spring(2735, 0, free, 1), assumed(1.37, 0.2e-3)).proved);
  }
}

TEST(Theorems, DampingUnderLatencyIsProvedForConvexScenesOnly) {
  const auto yes = answer(behind_spring(1000, 0.3, control::Free::inside), assumed(1.4, 0.5e-3));
  EXPECT_TRUE(yes.proved) << yes.why;
  EXPECT_EQ(yes.longest_hold_s, 0);
  const auto no = answer(behind_spring(1000, 0.3), assumed(1.4, 0.5e-3));
  EXPECT_FALSE(no.proved);
  EXPECT_TRUE(mentions(no.why, "not convex")) << no.why;
  // K = T = 1 at half a period: B = 0 needs (1 + 4/2)/2 = 1.5 with jitter, and some B helps.
  const auto used = [&](double damping) {
    return answer(behind_spring(1000, damping, control::Free::inside), assumed(1.6, 0.5e-3))
        .damping_used;
  };
  EXPECT_LT(used(0.3), used(0.01));
  EXPECT_FALSE(answer(behind_spring(10, 0.01, control::Free::inside), assumed(1.4, 1.1e-3)).proved);
}

TEST(Theorems, NegativeDampingIsTheoremBsAndNamesWhatIsNotConvex) {
  // K T/2 + B > (K T/2)^2 / Delta is what the paper asks of B < 0: 0.0132 of 1.37 here.
  EXPECT_EQ(answer(behind_spring(1000, -0.01, control::Free::inside), assumed(1.37)).theorem,
            Theorem::passive_scene);
  DeviceAssumption device = assumed(1.37);
  device.nonconvex = {"sphere 'ball'"};
  const auto no = answer(behind_spring(1000, -0.01), device);
  EXPECT_FALSE(no.proved);
  EXPECT_TRUE(mentions(no.why, "sphere 'ball'")) << no.why;
  ASSERT_EQ(no.uncertified.size(), 1U);
  EXPECT_EQ(no.uncertified[0].object, "sphere 'ball'");
  // a = 1.3, 1/(a + B) > Delta / a^2 needs a + B > a^2/Delta = 1.2336: B > -0.0664.
  EXPECT_TRUE(answer(behind_spring(2600, -0.06, control::Free::inside), assumed(1.37)).proved);
  EXPECT_FALSE(answer(behind_spring(2600, -0.07, control::Free::inside), assumed(1.37)).proved);
}

TEST(Theorems, ObjectsThatMoveAreNamedWithTheReason) {
  DeviceAssumption device = assumed(1.37);
  device.active = {{"box 'lid'", "moves: what it gives is booked, not bounded beforehand"}};
  const auto no = answer(behind_spring(100, 0), device);
  EXPECT_FALSE(no.proved);
  EXPECT_TRUE(mentions(no.why, "box 'lid' moves")) << no.why;
  ASSERT_EQ(no.uncertified.size(), 1U);
}

TEST(Theorems, APendulumsWeightIsASpringOfItsJoint) {
  build::ProgramSpec spec = behind_spring(1000, 0);
  const double without = answer(spec, assumed(1)).damping_used;
  spec.gravity_axes = {{.axis = 0, .swing = -900}};
  const auto with = answer(spec, assumed(1));
  EXPECT_NEAR(with.damping_used, without + 0.5e-3 * 900, 1e-9) << with.why;
  spec.gravity_axes[0].swing = 1100;
  EXPECT_FALSE(answer(spec, assumed(1)).proved);
}

TEST(Theorems, WhatIsNoNumberIsNoProof) {
  build::ProgramSpec spec = behind_spring(1000, 0);
  spec.gravity_axes = {{.axis = 0, .swing = std::nan("")}};
  EXPECT_FALSE(answer(spec, assumed(1)).proved);
}

TEST(Theorems, MissedTicksFollowFromTheHold) {
  const auto yes = answer(behind_spring(1000, 0), assumed(1.6));  // 0.5 of 1.6: held 3.2 periods
  EXPECT_NEAR(yes.longest_hold_s, 3.2e-3, 1e-12);
  EXPECT_EQ(yes.missed_ticks, 2);
}

TEST(Theorems, WhatNoCertificateCoversIsSaid) {
  build::ProgramSpec spec = behind_spring(1000, 0.1);
  for (control::AxisPlan& axis : spec.axes) axis.unit_per_raw = -1e-4;
  const auto yes = answer(std::move(spec), assumed(1.6));
  ASSERT_GE(yes.uncovered.size(), 3U);
  EXPECT_TRUE(mentions(yes.uncovered[0], "0.06 N")) << yes.uncovered[0];  // (1000 + 200) 5e-5
}

TEST(Theorems, TravelSpringsBesideACouplingAskForASharperDescentCheckUnderLatency) {
  constexpr double kLatency = 0.2e-3, kWeight = 0.891e-3;  // s_tau at a fifth of a period
  const auto with_travel = [](double sharpen) {
    build::ProgramSpec spec = behind_spring(500, 0, control::Free::outside, sharpen);
    spec.travels = {
        {.axis = 0, .min = -1, .max = 1, .stiffness = 900, .max_effort = 9, .margin = 0.1}};
    return spec;
  };
  // Enough for the coupling's own rate, not for the fastest that a proof allows.
  const double own = 0.2 + 0.2 * 0.8e-3 * 500 / 2, fastest = 0.2 + 0.2 * 0.8e-3 / kWeight;
  EXPECT_TRUE(
      answer(behind_spring(500, 0, control::Free::outside, own), assumed(2, kLatency)).proved);
  const auto blunt = answer(with_travel(own), assumed(2, kLatency));
  EXPECT_FALSE(blunt.proved);
  EXPECT_TRUE(mentions(blunt.why, "too blunt")) << blunt.why;
  const auto yes = answer(with_travel(1.001 * fastest), assumed(2, kLatency));
  EXPECT_TRUE(yes.proved) << yes.why;
}

TEST(Theorems, ANetworkInSeveralStepsAPeriodIsNotPassiveByConstruction) {
  const auto stepped = [](std::size_t substeps) {
    build::ProgramSpec spec = behind_spring(1000, 0, control::Free::inside);
    build::Network network;
    network.nodes.push_back({.mass = 0.1});
    network.elements.push_back(test::element(test::coordinate(0), test::node(0), 300, 0.1));
    spec.networks = {network};
    spec.network_substeps = substeps;
    return spec;
  };
  EXPECT_TRUE(answer(stepped(1), assumed(1.37)).proved);
  const auto no = answer(stepped(2), assumed(1.37));
  EXPECT_FALSE(no.proved);
  EXPECT_TRUE(mentions(no.why, "not passive by construction")) << no.why;
}

TEST(Observers, TakeTheirShareOfTheDamping) {
  build::ProgramSpec spec = behind_spring(1000, 0);
  spec.axis_observers = {build::observer(0, 0,
                                         {.mode = build::ObserverMode::model,
                                          .nominal_mass_kg = 0.09,
                                          .nominal_damping_Ns_m = 1,
                                          .mass_kg = 0.1,
                                          .damping_Ns_m = 1,
                                          .cutoff_Hz = 10,
                                          .max_output = 5},
                                         1e-3)};
  const auto yes = answer(spec, assumed(1));  // 10 g at 10 Hz: 0.314
  EXPECT_NEAR(yes.damping_used, 0.5 + 0.314, 0.01) << yes.why;
  EXPECT_TRUE(yes.proved);
  EXPECT_EQ(yes.longest_hold_s, 0);
  EXPECT_FALSE(answer(spec, assumed(0.8)).proved);
  EXPECT_FALSE(answer(spec, assumed(10, 1e-4)).proved);
  spec.axis_observers[0].command_share = 1;
  const auto no = answer(spec, assumed(10));
  EXPECT_FALSE(no.proved);
  EXPECT_TRUE(mentions(no.why, "classic")) << no.why;
}

/// A spring to ground of k behind a coupling of K: F is both in series, a constant.
build::ProgramSpec series(double K, double k) {
  build::ProgramSpec spec = test::scene_spec();
  spec.coupling = {test::spring(0, K)};
  spec.networks = {
      {.nodes = {}, .elements = {test::element(test::coordinate(0), test::ground(), k)}}};
  return spec;
}

Certificate of(CertificateKind kind) {
  Certificate certificate;
  certificate.kind = kind;
  certificate.P = certificate.P_coupling = Matrix(0, 0);
  return certificate;
}

TEST(Certificates, ExactProofIsForTheLinearSceneAlone) {
  const Certificate certificate = of(CertificateKind::sampled_exact);
  // 4000 alone asks 2 N s/m; with 1000 behind it 800, so 0.4 of 0.98 * 0.5.
  EXPECT_FALSE(answer(series(4000, 1000), assumed(0.5)).proved);
  const auto yes = answer(series(4000, 1000), assumed(0.5), &certificate);
  EXPECT_TRUE(yes.proved) << yes.why;
  EXPECT_EQ(yes.theorem, Theorem::this_scene);
  EXPECT_TRUE(mentions(yes.why, "void once the scene changes")) << yes.why;
  EXPECT_FALSE(answer(series(4000, 1000), assumed(0.407), &certificate).proved);
  EXPECT_TRUE(answer(series(4000, 1000), assumed(0.409), &certificate).proved);

  auto spec = series(4000, 1000);
  test::add_object(spec, spec.spheres, ObjectKind::sphere,
                   control::Sphere{{}, 0.05, control::Free::inside}, test::surface(100));
  const auto body = answer(std::move(spec), assumed(0.5), &certificate);
  EXPECT_FALSE(body.proved);
  EXPECT_TRUE(mentions(body.why, "not linear")) << body.why;
}

TEST(Certificates, ExactProofIsForOneLatencyOfAllThatIsTied) {
  build::ProgramSpec spec = test::scene_spec(2);
  spec.networks = {
      {.nodes = {}, .elements = {test::element(test::coordinate(0), test::coordinate(3), 500)}}};
  const build::Program program(std::move(spec));
  const Certificate certificate = of(CertificateKind::sampled_exact);
  const auto proof = [&](double left_s, double right_s) {
    return passive(program.plan(), {assumed(5, left_s), assumed(5, right_s)}, &certificate).at(0);
  };
  EXPECT_TRUE(proof(0, 0).proved) << proof(0, 0).why;
  EXPECT_FALSE(proof(0, 1e-3).proved);
  EXPECT_TRUE(mentions(proof(0, 1e-3).why, "one latency")) << proof(0, 1e-3).why;
}

TEST(Certificates, ExactProofCoversANetworkWithoutCoupling) {
  auto spec = series(4000, 1000);
  spec.coupling.clear();
  const Certificate certificate = of(CertificateKind::sampled_exact);
  EXPECT_FALSE(answer(spec, assumed(0.6)).proved);
  EXPECT_TRUE(answer(spec, assumed(0.6), &certificate).proved);
  EXPECT_FALSE(answer(spec, assumed(0.5), &certificate).proved);
}

/// V = 1/K in each direction as a general V(z).
build::ProgramSpec yielding_by(double K, control::Free free = control::Free::inside) {
  build::ProgramSpec spec = behind_spring(1, 0, free);
  spec.coupling = {
      test::general({0, 1, 2}, {.A = {},
                                .B = {.rows = 0, .columns = 3, .values = {}},
                                .C = {.rows = 3, .columns = 0, .values = {}},
                                .D = test::matrix({{1 / K, 0, 0}, {0, 1 / K, 0}, {0, 0, 1 / K}})})};
  return spec;
}

TEST(Certificates, GeneralCouplingNeedsOneAndAPassiveScene) {
  EXPECT_TRUE(mentions(answer(yielding_by(1000), assumed(1.37)).why, "certificate"));
  Certificate certificate = of(CertificateKind::passive_lmi);
  // Delta_V = K T / (2 p), p = 1 - K T / (2 Delta) with 0.98 of the damping.
  const double p = 1 - 0.5 / (0.98 * 1.37);
  certificate.Delta_coupling = 0.999 * 0.5 / p * Matrix::Identity(3, 3);
  const auto yes = answer(yielding_by(1000), assumed(1.37), &certificate);
  EXPECT_TRUE(yes.proved) << yes.why;
  EXPECT_EQ(yes.theorem, Theorem::passive_scene);
  EXPECT_FALSE(
      answer(yielding_by(1000, control::Free::outside), assumed(1.37), &certificate).proved);
  certificate.Delta_coupling *= 1.01;
  EXPECT_FALSE(answer(yielding_by(1000), assumed(1.37), &certificate).proved);
  certificate.Delta_coupling = 1e-6 * Matrix::Identity(3, 3);
  EXPECT_FALSE(answer(yielding_by(2741), assumed(1.37), &certificate).proved);
  certificate.Delta_coupling = Matrix::Constant(3, 3, NAN);
  EXPECT_FALSE(answer(yielding_by(1000), assumed(1.37), &certificate).proved);
  certificate.Delta_coupling = Matrix::Identity(2, 2);
  EXPECT_FALSE(answer(yielding_by(1000), assumed(1.37), &certificate).proved);
}

TEST(Certificates, SceneThatIsNotPassiveNeedsStiffnessBetweenTwoBounds) {
  // Another integrator is not passive by construction. A spring is all the same, with any level.
  Certificate certificate = of(CertificateKind::passive_lmi);
  certificate.P_scene = Matrix(0, 0);
  certificate.Phi_scene = Matrix::Constant(1, 1, 0.4);
  auto spec = series(1000, 100);
  spec.integrator = build::Integrator::trapezoid;
  const auto accepted = [&](double K) {
    auto made = series(K, 100);
    made.integrator = build::Integrator::trapezoid;
    return answer(std::move(made), assumed(1.37), &certificate).proved;
  };
  EXPECT_FALSE(answer(spec, assumed(1.37)).proved);
  // 2 Phi/T < K < 2 * 0.98 * 1.37 / T: 800 to 2685.
  EXPECT_FALSE(accepted(799));
  EXPECT_TRUE(accepted(801));
  EXPECT_TRUE(accepted(2680));
  EXPECT_FALSE(accepted(2690));
}

}  // namespace
}  // namespace hapticd::check
