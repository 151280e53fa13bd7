// What the observer does to the stability of a device, by the real kernel: its frequency response
// is taken from its impulse response, and closed loops are assembled by probing it with unit states.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>
#include <numbers>
#include <vector>

#include "tests/support/observed_loop.h"
#include "tests/support/observer_radii.h"

namespace hapticd::control {
namespace {

using build::ObserverMode;
using test::kPeriod_s;
using test::paper_observer;

/// d_hat after a unit impulse of position; its own output is the only command.
std::vector<double> impulse_response(const ObserverPlan& plan) {
  ObserverState state;
  double output = observe(plan, state, Motion::reseeded, 0, 0, 0);
  std::vector<double> result;
  for (int k = 0; k < 8000; ++k) {
    output = observe(plan, state, Motion::advanced, k == 0 ? 1 : 0, output, 0);
    result.push_back(state.s2);
  }
  return result;
}

/// b_eff(w) = b - (T/2) / (1 - cos wT) Re{(1 - e^{-jwT}) H}: the damper that the device with
/// observer H is worth at a frequency.
double effective_damping(const std::vector<double>& response, double b_Ns_m, double frequency_Hz) {
  const double angle = 2 * M_PI * frequency_Hz * kPeriod_s;
  const std::complex<double> back = std::polar(1.0, -angle);
  std::complex<double> sum = 0, power = 1;
  for (const double value : response) {
    sum += value * power;
    power *= back;
  }
  return b_Ns_m - 0.5 * kPeriod_s / (1 - std::cos(angle)) * ((1.0 - back) * sum).real();
}

ObserverPlan classic_with(double cutoff_Hz, int order, double b_n = 0.022) {
  auto figures = paper_observer(ObserverMode::classic, cutoff_Hz, order);
  figures.nominal_damping_Ns_m = b_n;
  return build::observer(0, 0, figures, kPeriod_s);
}

TEST(ObserverAnalysis, EffectiveDampingOfFirstOrder) {
  constexpr double kFrequency_Hz[] = {0.5, 1, 2, 5, 10, 20, 50, 100, 200, 400, 499};
  struct Row {
    double cutoff_Hz;
    double b_eff[11];
  };
  const Row rows[] = {{2,
                       {0.145967, 0.145965, 0.145958, 0.145908, 0.145727, 0.145007, 0.140003,
                        0.12265, 0.0610801, -0.079405, -0.103798}},
                      {5,
                       {0.32624, 0.326235, 0.326218, 0.326098, 0.325667, 0.323948, 0.311987,
                        0.270383, 0.121049, -0.230006, -0.292472}},
                      {10,
                       {0.612377, 0.612369, 0.612337, 0.612113, 0.611314, 0.608122, 0.585892,
                        0.50817, 0.22409, -0.476903, -0.606788}},
                      {100,
                       {3.80217, 3.80214, 3.80203, 3.80124, 3.79841, 3.7871, 3.70738, 3.41515,
                        2.12937, -3.95134, -6.06875}}};
  for (const Row& row : rows) {
    const auto response = impulse_response(classic_with(row.cutoff_Hz, 1));
    for (std::size_t i = 0; i < std::size(kFrequency_Hz); ++i) {
      const double found = effective_damping(response, 0.022, kFrequency_Hz[i]);
      EXPECT_NEAR(found, row.b_eff[i], 1e-5 * std::abs(row.b_eff[i]))
          << row.cutoff_Hz << " Hz at " << kFrequency_Hz[i];
    }
  }
}

double least_damping(const std::vector<double>& response, double b_Ns_m) {
  double least = effective_damping(response, b_Ns_m, 500);
  for (double f = 1; f < 500; f *= 1.02)
    least = std::min(least, effective_damping(response, b_Ns_m, f));
  return least;
}

TEST(ObserverAnalysis, PassivityLostPerKilogram) {
  struct Row {
    double cutoff_Hz, order_1, order_2;
  };
  for (const Row& row : {Row{1, 6.2832, 0.0197}, Row{2, 12.5662, 0.079}, Row{5, 31.4133, 0.4934},
                         Row{10, 62.8112, 1.9726}, Row{20, 125.4986, 7.8749},
                         Row{50, 311.6007, 48.5475}, Row{100, 608.4324, 185.095}}) {
    for (const int order : {1, 2}) {
      const double loss =
          -least_damping(impulse_response(classic_with(row.cutoff_Hz, order, 0)), 0) / 0.01;
      const double expected = order == 1 ? row.order_1 : row.order_2;
      EXPECT_NEAR(loss, expected, 0.003 * expected) << row.cutoff_Hz << " Hz, order " << order;
      const double a = build::low_pass_share(row.cutoff_Hz, kPeriod_s);
      EXPECT_NEAR(loss, 2 / kPeriod_s * std::pow(a / (2 - a), order), 1e-6 * expected)
          << "at Nyquist in closed form";
    }
  }
}

// Making a device feel lighter than it is costs (M - m_n) w_c / 2 with two lags, as w_c T -> 0.
TEST(ObserverAnalysis, ModelModeThatTakesMassAwayCostsDamping) {
  struct Row {
    double taken_kg, cutoff_Hz, loss_Ns_m;
  };
  for (const Row& row : {Row{0.01, 10, 0.314}, Row{0.001, 10, 0.0314}, Row{0.01, 3, 0.094}}) {
    auto figures = paper_observer(ObserverMode::model, row.cutoff_Hz, 2);
    figures.mass_kg = figures.nominal_mass_kg + row.taken_kg;
    figures.damping_Ns_m = figures.nominal_damping_Ns_m;
    const auto response = impulse_response(build::observer(0, 0, figures, kPeriod_s));
    double least = 0;
    for (double f = 0.05; f < 500; f *= 1.05)
      least = std::min(least, effective_damping(response, 0, f));
    EXPECT_NEAR(-least, row.loss_Ns_m, 0.04 * row.loss_Ns_m);
  }
}

// State of a closed loop: plant (x, v), observer (x1, x2, s1, s2, up to three commands), last
// command: what the observer is told next, and what a late actuator does next.
constexpr int kStates = 10;
using Vector = Eigen::Matrix<double, kStates, 1>;

struct Loop {
  ObserverPlan plan;
  double mass_kg = 0.01, b_Ns_m = 0.022, wall_N_m = 0, wall_Ns_m = 0;
  bool late = false;  ///< the actuator gets commands one tick late

  Vector tick(const Vector& s) const {
    ObserverState observer{.x1 = s[2], .x2 = s[3], .s1 = s[4], .s2 = s[5], .blend = 1, .known = 2};
    std::copy_n(s.data() + 6, kept(), observer.command.begin());
    const double compensation = observe(plan, observer, Motion::advanced, s[0], s[9], 0);
    const double damper = wall_Ns_m * (s[0] - s[2]) / kPeriod_s;
    const double command = compensation - wall_N_m * s[0] - damper;
    test::HeldMass plant{mass_kg, b_Ns_m, s[0], s[1]};
    plant.advance(late ? s[9] : command, kPeriod_s);
    Vector next;
    next << plant.x, plant.v, observer.x1, observer.x2, observer.s1, observer.s2,
        observer.command[0], observer.command[1], kept() == 3 ? observer.command[2] : 0, command;
    return next;
  }
  int kept() const { return plan.extra_delay + 2; }  // commands that the observer looks at

  /// Of all modes but the one of a free device that stands where it was put.
  double spectral_radius() const {
    Eigen::Matrix<double, kStates, kStates> a;
    for (int i = 0; i < kStates; ++i) a.col(i) = tick(Vector::Unit(i));
    Eigen::Matrix<std::complex<double>, kStates, 1> modes = a.eigenvalues();
    if (wall_N_m == 0) {
      const auto at_rest = std::min_element(modes.begin(), modes.end(), [](auto l, auto r) {
        return std::abs(l - 1.0) < std::abs(r - 1.0);
      });
      *at_rest = 0;
    }
    return modes.cwiseAbs().maxCoeff();
  }
};

/// The largest over devices whose mass differs from nominal by up to half, and at a wall their
/// damping with it.
double robust_radius(Loop loop) {
  double largest = 0;
  for (const double share : {0.5, 0.75, 1.0, 1.25, 1.5}) {
    loop.mass_kg = 0.01 * share;
    loop.b_Ns_m = loop.wall_N_m > 0 ? 0.022 * share : 0.022;
    largest = std::max(largest, loop.spectral_radius());
  }
  return largest;
}

TEST(ObserverAnalysis, SpectralRadiusOverMassesChangedByHalf) {
  for (const test::ObserverRadii& row : test::kObserverRadii) {
    for (std::size_t i = 0; i < std::size(test::kObserverCutoff_Hz); ++i) {
      Loop loop{.plan = classic_with(test::kObserverCutoff_Hz[i], row.order),
                .wall_N_m = row.wall_Ns_m > 0 ? 1000.0 : 0.0,
                .wall_Ns_m = row.wall_Ns_m,
                .late = row.late};
      loop.plan.extra_delay = row.late ? 1 : 0;
      EXPECT_NEAR(robust_radius(loop), row.radius[i], 1e-4)
          << "order " << row.order << ", wall damper " << row.wall_Ns_m << ", late " << row.late
          << ", " << test::kObserverCutoff_Hz[i] << " Hz";
    }
  }
}

}  // namespace
}  // namespace hapticd::control
