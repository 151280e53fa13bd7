#include "sim/plant.h"

#include <algorithm>
#include <cmath>

#include "sim/matrix_exponential.h"

namespace hapticd::sim {

// State (y, v, f, s) with y = x - r at the start, f the held force, s its slope (k r'). In units of
// the interval's own length h and of M, (y, v h, f h^2/M, s h^3/M), all entries are of order one
// for short intervals:
//
//   d/dtau = [0 1 0 0; -k h^2/M  -d h/M  1 0; 0 0 0 1; 0 0 0 0],  tau = t/h from 0 to 1
Propagator Plant::propagator(double length_s) const {
  const double h = length_s;
  const double mass = options_.mass_kg;
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  a(0, 1) = 1;
  a(1, 0) = -options_.stiffness_N_m * h * h / mass;
  a(1, 1) = -options_.damping_Ns_m * h / mass;
  a(1, 2) = 1;
  a(2, 3) = 1;
  const Eigen::Matrix4d d = exp_minus_identity(a);
  Propagator p;
  p.length_s = h;
  p.x_y = d(0, 0);
  p.x_v = d(0, 1) * h;
  p.x_f = d(0, 2) * h * h / mass;
  p.x_s = d(0, 3) * h * h * h / mass;
  p.v_y = d(1, 0) / h;
  p.v_v = d(1, 1);
  p.v_f = d(1, 2) * h / mass;
  p.v_s = d(1, 3) * h * h / mass;
  return p;
}

void Plant::advance(const Propagator& p, const PlantInput& input) noexcept {
  const double y = position_m_ - input.rest_m;
  const double slope = options_.stiffness_N_m * input.rest_rate_m_s;
  double step = p.x_y * y + p.x_v * velocity_m_s_ + p.x_f * input.force_N + p.x_s * slope;
  double velocity =
      velocity_m_s_ + p.v_y * y + p.v_v * velocity_m_s_ + p.v_f * input.force_N + p.v_s * slope;
  if (const double stop = stop_N(p, step); stop != 0) {
    step += p.x_f * stop;
    velocity += p.v_f * stop;
  }
  if (options_.coulomb_N > 0) {
    if (sticks(p, input)) return;
    const double stopping = -velocity / p.v_f;
    const double friction = friction_N(p, step, stopping);
    step += p.x_f * friction;
    velocity = friction == stopping ? 0.0 : velocity + p.v_f * friction;
  }
  position_m_ += step;
  velocity_m_s_ = velocity;
}

// At rest, with less than the Coulomb force acting at both ends of the interval (it is linear in
// between at rest).
bool Plant::sticks(const Propagator& p, const PlantInput& input) const noexcept {
  if (velocity_m_s_ != 0) return false;
  const double start = input.force_N - options_.stiffness_N_m * (position_m_ - input.rest_m) +
                       options_.stops.force_N(position_m_, 0);
  const double end = start + options_.stiffness_N_m * input.rest_rate_m_s * p.length_s;
  return std::abs(start) <= options_.coulomb_N && std::abs(end) <= options_.coulomb_N;
}

// With p the depth, F = max(0, k p1 + c (p1 - max(p0, 0)) / h) held over the interval, p1 = p_free -
// x_f F the depth at its end: backward Euler. k p^2 / 2 is convex, so the spring gains at most
// k p1 (p1 - p0) <= F (p1 - p0) in pushing and loses at least as much in letting go: with any k, c
// and h the stop never gives energy. Friction only shortens the step, which keeps that so.
double Plant::stop_N(const Propagator& p, double free_step_m) const noexcept {
  const EndStops& stops = options_.stops;
  const double free_m = stops.depth_m(position_m_ + free_step_m);
  if (free_m == 0) return 0;
  const double sign = free_m > 0 ? 1 : -1;
  const double before_m = std::max(0.0, sign * stops.depth_m(position_m_));
  const double c_h = stops.damping_Ns_m / p.length_s;
  const double push = stops.stiffness_N_m * sign * free_m + c_h * (sign * free_m - before_m);
  return -sign * std::max(0.0, push / (1 + (stops.stiffness_N_m + c_h) * p.x_f));
}

// The force that brings the mass to rest at the interval's end, at most the Coulomb force. Where
// the mass turns round by itself within the interval such a force could push along the way covered;
// its work f (step + x_f f) is held at <= 0.
double Plant::friction_N(const Propagator& p, double free_step_m,
                         double stopping_N) const noexcept {
  const double wanted = std::clamp(stopping_N, -options_.coulomb_N, options_.coulomb_N);
  if (wanted * free_step_m >= 0) return 0;
  const double most = std::abs(free_step_m) / p.x_f;
  return std::clamp(wanted, -most, most);
}

double Plant::acceleration_m_s2(double force_N, double rest_m) const noexcept {
  const double c = options_.coulomb_N;
  const double pull = force_N - options_.damping_Ns_m * velocity_m_s_ -
                      options_.stiffness_N_m * (position_m_ - rest_m) +
                      options_.stops.force_N(position_m_, velocity_m_s_);
  const double friction =
      velocity_m_s_ != 0 ? -std::copysign(c, velocity_m_s_) : std::clamp(-pull, -c, c);
  return (pull + friction) / options_.mass_kg;
}

double Plant::energy_J(double rest_m) const noexcept {
  const double y = position_m_ - rest_m;
  return 0.5 * options_.mass_kg * velocity_m_s_ * velocity_m_s_ +
         0.5 * options_.stiffness_N_m * y * y + options_.stops.energy_J(position_m_);
}

}  // namespace hapticd::sim
