// The exact sampled loop against a simulation that shares nothing with it: Runge-Kutta sub-steps for
// the device, the loop's own kernels (observe) or plain difference equations for the tick.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>
#include <random>

#include "control/design/synthesis/exact_index.h"
#include "tests/support/paper2_loop.h"

namespace hapticd::test {
namespace {

using check::LoopCase;

enum class Estimator { ideal, difference, low_pass, fit, tracking };

struct RandomLoop {
  double stiffness = 0, damper = 0;
  Estimator estimator = Estimator::difference;
  double figure = 0;  ///< cut-off, bandwidth
  std::uint16_t window = 0;
  std::optional<control::ObserverPlan> observer;
  LoopCase one;
  double meant_damping = 1, weight_rad_s = 100;
  bool step = false;

  check::SampledLoop loop() const {
    std::optional<System> velocity;
    if (estimator == Estimator::difference) velocity = check::backward_difference(kPeriod_s);
    if (estimator == Estimator::low_pass)
      velocity = check::velocity_of(build::low_pass(0, figure, kPeriod_s), kPeriod_s);
    if (estimator == Estimator::fit)
      velocity = check::velocity_of(build::least_squares(0, window, 1, kPeriod_s));
    if (estimator == Estimator::tracking)
      velocity = check::velocity_of(build::alpha_beta_gamma(0, figure, kPeriod_s), kPeriod_s);
    return synthesis::loop_of(
        {.stiffness_N_m = stiffness, .velocity = velocity, .observer = observer}, damper);
  }
  synthesis::WallMeant meant() const {
    synthesis::WallMeant wall{.stiffness_N_m = stiffness, .damping_Ns_m = meant_damping};
    const double w = weight_rad_s;
    wall.weight = {Vector::Constant(1, step ? 1 : w), Eigen::Vector2d(step ? 0 : w, 1)};
    return wall;
  }
};

/// Device, wall that is meant and integral of the squared error, by Runge and Kutta's fourth order.
class Simulation {
 public:
  explicit Simulation(const RandomLoop& random) : random_(random) {
    history_.assign(40, 0);
    if (random.observer) observer_ = *random.observer;
  }
  double x = 0, v = 0, index = 0;
  bool pushed = false;

  double energy() const { return x * x + 1e-4 * v * v + 1e-6 * command_ * command_; }

  void tick(int substeps) {
    const double asked = command();
    history_.push_front(asked);
    history_.pop_back();
    const double latency = random_.one.latency_s / kPeriod_s;
    const auto whole = static_cast<std::size_t>(latency + 1e-9);
    const double fraction = std::max(0.0, latency - static_cast<double>(whole)) * kPeriod_s;
    if (fraction > 1e-9) advance(history_[whole + 1], fraction, substeps);
    advance(history_[whole], kPeriod_s - (fraction > 1e-9 ? fraction : 0), substeps);
  }

 private:
  using State = std::array<double, 5>;  ///< x, v, wall's position and velocity, integral

  double push(double t) const {
    if (!pushed) return 0;
    return random_.step ? 1 : random_.weight_rad_s * std::exp(-random_.weight_rad_s * t);
  }

  State rate(const State& y, double t, double u) const {
    const LoopCase& one = random_.one;
    const double f = push(t), damping = random_.meant_damping + one.hand_Ns_m;
    const double stiffness = random_.stiffness + one.hand_N_m;
    const double mass = one.mass_kg + one.hand_kg;
    const double wall_velocity = one.hand_kg > 0 ? y[3] : (f - stiffness * y[2]) / damping;
    const double wall_acceleration =
        one.hand_kg > 0 ? (f - stiffness * y[2] - damping * y[3]) / one.hand_kg : 0;
    const double error = wall_velocity - y[1];
    return {y[1], (f + u - one.hand_N_m * y[0] - (one.damping_Ns_m + one.hand_Ns_m) * y[1]) / mass,
            wall_velocity, wall_acceleration, error * error};
  }

  void advance(double u, double time_s, int substeps) {
    const double h = time_s / substeps;
    acting_ = u;
    for (int i = 0; i < substeps; ++i) {
      const State y{x, v, wall_x_, wall_v_, index};
      const auto ahead = [&](const State& slope, double by) {
        State z = y;
        for (std::size_t j = 0; j < z.size(); ++j) z[j] += by * slope[j];
        return z;
      };
      const State a = rate(y, time_, u), b = rate(ahead(a, h / 2), time_ + h / 2, u),
                  c = rate(ahead(b, h / 2), time_ + h / 2, u), d = rate(ahead(c, h), time_ + h, u);
      const auto next = [&](std::size_t j) {
        return y[j] + h / 6 * (a[j] + 2 * b[j] + 2 * c[j] + d[j]);
      };
      x = next(0), v = next(1), wall_x_ = next(2), wall_v_ = next(3), index = next(4);
      time_ += h;
    }
  }

  /// What a sensor between hand and device reads: m x'' + b x' = u + h.
  double measured_hand() const {
    const double acceleration = rate({x, v, wall_x_, wall_v_, 0}, time_, acting_)[1];
    return random_.one.mass_kg * acceleration + random_.one.damping_Ns_m * v - acting_;
  }

  double velocity() {
    const double difference = (x - positions_[0]) / kPeriod_s;
    switch (random_.estimator) {
      case Estimator::ideal:
        return v;
      case Estimator::difference:
        return difference;
      case Estimator::low_pass:
        filtered_ +=
            (1 - std::exp(-2 * M_PI * random_.figure * kPeriod_s)) * (difference - filtered_);
        return filtered_;
      case Estimator::fit: {
        // Slope of the straight line through the last positions: the textbook's sums.
        double covariance = 0, variance = 0;
        const double middle = 0.5 * (random_.window - 1);
        for (std::size_t i = 0; i < random_.window; ++i) {
          const double t = middle - static_cast<double>(i);
          covariance += t * (i == 0 ? x : positions_[i - 1]);
          variance += t * t;
        }
        return covariance / variance / kPeriod_s;
      }
      default: {
        const double r = std::exp(-random_.figure * kPeriod_s), T = kPeriod_s;
        const double ahead = tracked_[0] + T * tracked_[1] + 0.5 * T * T * tracked_[2];
        const double off = x - ahead;
        tracked_[0] = ahead + (1 - r * r * r) * off;
        tracked_[1] += T * tracked_[2] + 1.5 * (1 - r) * (1 - r) * (1 + r) / T * off;
        tracked_[2] += std::pow(1 - r, 3) / (T * T) * off;
        return tracked_[1];
      }
    }
  }

  double command() {
    if (!started_) positions_.fill(0);
    const double force = random_.stiffness * x + random_.damper * velocity();
    command_ = -random_.one.contact * force;
    if (random_.observer) {
      // The device hears what it delivered; the state begins as after a start at rest.
      if (!started_)
        control::observe(observer_, observer_state_, control::Motion::reseeded, 0, 0, 0);
      command_ += control::observe(observer_, observer_state_, control::Motion::advanced, x,
                                   history_[0], measured_hand());
    }
    started_ = true;
    for (std::size_t i = positions_.size() - 1; i > 0; --i) positions_[i] = positions_[i - 1];
    positions_[0] = x;
    return command_;
  }

  const RandomLoop& random_;
  std::deque<double> history_;
  control::ObserverPlan observer_;
  control::ObserverState observer_state_{};
  std::array<double, 32> positions_{};
  std::array<double, 3> tracked_{};
  double wall_x_ = 0, wall_v_ = 0, time_ = 0, filtered_ = 0, command_ = 0, acting_ = 0;
  bool started_ = false;
};

class Drawn {
 public:
  explicit Drawn(unsigned seed) : random_(seed) {}
  double between(double low, double high) {
    return low * std::pow(high / low, std::uniform_real_distribution<double>(0, 1)(random_));
  }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }

  RandomLoop loop() {
    RandomLoop r;
    r.stiffness = between(50, 3000);
    r.damper = between(0.3, 20);
    r.estimator = static_cast<Estimator>(below(5));
    r.figure = r.estimator == Estimator::tracking ? between(400, 2000) : between(60, 400);
    r.window = static_cast<std::uint16_t>(2 + below(4));
    r.one = {.mass_kg = between(0.004, 0.1), .damping_Ns_m = between(0.005, 3)};
    if (below(2) == 0) r.one.hand_kg = between(0.02, 2);
    if (below(2) == 0) r.one.hand_Ns_m = between(0.1, 10);
    if (below(2) == 0) r.one.hand_N_m = between(10, 800);
    if (below(4) == 0) r.one.contact = 0.2 + 0.2 * below(4);
    if (below(3) != 0) r.one.latency_s = kPeriod_s * (below(2) ? below(3) : between(0.05, 2.5));
    if (below(3) == 0) observe(r);
    r.meant_damping = between(0.5, 5);
    r.weight_rad_s = between(30, 500);
    r.step = below(2) == 0;
    return r;
  }

 private:
  void observe(RandomLoop& r) {
    using enum build::ObserverMode;
    const build::ObserverMode modes[] = {model, sensor, classic};
    r.observer = build::observer(0, 0,
                                 {.mode = modes[below(3)],
                                  .nominal_mass_kg = r.one.mass_kg * between(0.5, 1.5),
                                  .nominal_damping_Ns_m = r.one.damping_Ns_m,
                                  .mass_kg = r.one.mass_kg,
                                  .damping_Ns_m = r.one.damping_Ns_m,
                                  .cutoff_Hz = between(1, 60),
                                  .order = 1 + below(2),
                                  .delay_ticks = static_cast<std::uint16_t>(below(3)),
                                  .max_output = 1e30},
                                 kPeriod_s);
  }
  std::mt19937 random_;
};

/// log of the largest eigenvalue, from how a random state grows over the second half of `ticks`.
double growth(const RandomLoop& random, int ticks) {
  Simulation simulation(random);
  // Far from what the observer takes for a fault, whatever the growth.
  simulation.x = 1e-12;
  simulation.v = 1e-10;
  double early = 0, late = 0;
  for (int k = 0; k < ticks; ++k) {
    simulation.tick(4);
    // Peaks over a window, so that a slow oscillation does not pass for decay.
    if (k >= ticks / 2 - 200 && k < ticks / 2) early = std::max(early, simulation.energy());
    if (k >= ticks - 200) late = std::max(late, simulation.energy());
    if (simulation.energy() > 1e6) return 1;
  }
  return late < 1e-200 ? -1 : 0.5 * std::log(late / early) / (0.5 * ticks);
}

TEST(BruteForce, RandomLoopsAreStableWhereTheRadiusSaysSo) {
  Drawn drawn(11);
  int stable = 0, unstable = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const RandomLoop random = drawn.loop();
    const double radius = check::loop_radius(random.loop(), random.one);
    if (std::abs(radius - 1) <= 1e-3) continue;
    const double rate = growth(random, 2000);
    EXPECT_EQ(rate < 0, radius < 1) << trial << ": radius " << radius << ", grows by " << rate
                                    << ", " << check::described(random.one);
    ++(radius < 1 ? stable : unstable);
  }
  EXPECT_GT(stable, 200);
  EXPECT_GT(unstable, 100);
}

TEST(BruteForce, IndexIsTheIntegralOfASimulation) {
  Drawn drawn(12);
  int compared = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const RandomLoop random = drawn.loop();
    if (!(check::loop_radius(random.loop(), random.one) < 0.985)) continue;
    const double index = synthesis::exact_index(random.loop(), random.one, random.meant());
    Simulation simulation(random);
    simulation.pushed = true;
    double before = -1;
    // Until a hundred ticks add nothing more.
    for (int k = 0; k < 4000 && !(k % 100 == 0 && simulation.index - before < 1e-6 * index); ++k) {
      if (k % 100 == 0) before = simulation.index;
      simulation.tick(12);
    }
    EXPECT_NEAR(simulation.index / index, 1, 1e-3)
        << trial << ": " << check::described(random.one) << ", estimator "
        << static_cast<int>(random.estimator) << ", observer " << random.observer.has_value();
    ++compared;
  }
  EXPECT_GT(compared, 200);
}

}  // namespace
}  // namespace hapticd::test
