#include "sim/linkage_plant.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace hapticd::sim {
namespace {

constexpr std::size_t at(int joint) noexcept {
  return static_cast<std::size_t>(joint);
}

// Stops are no stiffer than the steps resolve: a tenth of a radian of their swing each.
double stiffest_stop(double inertia, double step_s) noexcept {
  return inertia * std::pow(0.1 / step_s, 2);
}

}  // namespace

LinkagePlant::LinkagePlant(const DeviceOptions& options)
    : mass_(*options.linkage, options.axes, options.hand.mass_kg),
      joints_(static_cast<int>(options.axes.size())),
      hand_(options.hand),
      direction_(Eigen::Vector3d::Map(options.linkage->hand_direction.data())) {
  for (int i = 0; i < joints_; ++i) {
    const AxisOptions& axis = options.axes[at(i)];
    motion_.q[i] = axis.position_m;
    damping_[i] = axis.damping_Ns_m;
    coulomb_[i] = axis.coulomb_N;
    rubs_ |= axis.coulomb_N > 0;
  }
  mass_.dynamics(motion_.q, motion_.qd, here_);
  start_ = tip_ = here_.points.point[0].at;
  for (int i = 0; i < joints_; ++i) {
    const double inertia = here_.mass(i, i);
    const double most = stiffest_stop(inertia, options.period_s / options.substeps);
    stops_[at(i)] = end_stops(options.axes[at(i)], inertia, most);
  }
}

Eigen::Vector3d LinkagePlant::tip_velocity() noexcept {
  mass_.dynamics(motion_.q, motion_.qd, here_);
  return here_.points.point[0].jacobian * motion_.qd;
}

double LinkagePlant::energy_J(double rest_m) noexcept {
  mass_.dynamics(motion_.q, motion_.qd, here_);
  const double stretch = displacement_m() - rest_m;
  double energy = 0.5 * motion_.qd.dot(here_.mass * motion_.qd) + here_.weight_J +
                  0.5 * hand_.stiffness_N_m * stretch * stretch;
  for (int i = 0; i < joints_; ++i) energy += stops_[at(i)].energy_J(motion_.q[i]);
  return energy;
}

Eigen::Vector3d LinkagePlant::hand_force_N(const LinkageInput& input) noexcept {
  const Contact contact = grip(input, 0);
  const std::optional<Motion> now = rate(motion_, input, 0, contact);
  if (!now) return Eigen::Vector3d::Zero();
  const MassPoint& tip = here_.points.point[0];
  return held_force_N(motion_, input, 0) - hand_.mass_kg * (tip.jacobian * now->qd + tip.bias);
}

void LinkagePlant::advance(double length_s, const LinkageInput& input) noexcept {
  constexpr int kMostCuts = 24;     // beyond it a joint that would turn round is stopped instead
  constexpr double kAtRest = 1e-3;  // of its speed before: stopped there, not cut again
  double left_s = length_s, piece_s = length_s;
  Contact contact = grip(input, 0);
  int cut_for = -1;
  for (int cuts = 0; left_s > 0; ++cuts) {
    const double time_s = length_s - left_s;
    const std::optional<Motion> next = step(input, time_s, piece_s, contact);
    if (!next) return stop_dead();
    const Reversal reversal = first_reversal(*next, contact);
    if (reversal.joint >= 0 && reversal.share > 0 && cuts < kMostCuts) {
      piece_s *= reversal.share;
      cut_for = reversal.joint;
    } else if (reversal.joint >= 0) {
      stop(reversal.joint, contact);
      cut_for = -1;
    } else {
      const bool rests =
          cut_for >= 0 && std::abs(next->qd[cut_for]) <= kAtRest * std::abs(motion_.qd[cut_for]);
      accept(*next, input);
      if (rests) stop(cut_for, contact);
      left_s -= piece_s;
      if (left_s > 0) contact = grip(input, length_s - left_s);
      piece_s = left_s;
      cut_for = -1;
    }
  }
}

LinkagePlant::Motion LinkagePlant::Motion::plus(double share, const Motion& other) const noexcept {
  return {q + share * other.q, qd + share * other.qd, rest_work_J + share * other.rest_work_J,
          lost_J + share * other.lost_J};
}

// Classical Runge-Kutta from motion_.
std::optional<LinkagePlant::Motion> LinkagePlant::step(const LinkageInput& input, double time_s,
                                                       double length_s,
                                                       const Contact& contact) noexcept {
  const double h = length_s, middle_s = time_s + h / 2;
  const auto k1 = rate(motion_, input, time_s, contact);
  if (!k1) return {};
  const auto k2 = rate(motion_.plus(h / 2, *k1), input, middle_s, contact);
  if (!k2) return {};
  const auto k3 = rate(motion_.plus(h / 2, *k2), input, middle_s, contact);
  if (!k3) return {};
  const auto k4 = rate(motion_.plus(h, *k3), input, time_s + h, contact);
  if (!k4) return {};
  return motion_.plus(h / 6, *k1).plus(h / 3, *k2).plus(h / 3, *k3).plus(h / 6, *k4);
}

// The hand without its mass, on the tip as here_ has it.
Eigen::Vector3d LinkagePlant::held_force_N(const Motion& now, const LinkageInput& input,
                                           double time_s) const noexcept {
  const MassPoint& tip = here_.points.point[0];
  const double rest_m = input.rest_m + input.rest_rate_m_s * time_s;
  const double stretch_m = direction_.dot(tip.at - start_) - rest_m;
  return (input.force_N - hand_.stiffness_N_m * stretch_m) * direction_ -
         hand_.damping_Ns_m * (tip.jacobian * now.qd);
}

std::optional<LinkagePlant::Motion> LinkagePlant::rate(const Motion& now, const LinkageInput& input,
                                                       double time_s,
                                                       const Contact& contact) noexcept {
  if (!mass_.dynamics(now.q, now.qd, here_)) return {};
  const MassPoint& tip = here_.points.point[0];
  const double rest_m = input.rest_m + input.rest_rate_m_s * time_s;
  const double stretch_m = direction_.dot(tip.at - start_) - rest_m;
  const Joints resisting = contact.friction - damping_.cwiseProduct(now.qd);
  Joints force = input.effort + resisting + here_.load +
                 tip.jacobian.transpose() * held_force_N(now, input, time_s);
  Motion rate;
  rate.rest_work_J = -hand_.stiffness_N_m * stretch_m * input.rest_rate_m_s;
  rate.lost_J = hand_.damping_Ns_m * (tip.jacobian * now.qd).squaredNorm() - resisting.dot(now.qd);
  for (int i = 0; i < joints_; ++i) {
    const EndStops& stops = stops_[at(i)];
    const double push = stops.force_N(now.q[i], now.qd[i]);
    force[i] += push;
    rate.lost_J -= (push + stops.stiffness_N_m * stops.depth_m(now.q[i])) * now.qd[i];
  }
  rate.q = now.qd;
  rate.qd = solve(here_.mass, force, contact);
  return rate;
}

// Accelerations; those of stuck joints are 0.
Joints LinkagePlant::solve(JointMatrix mass, Joints force, const Contact& contact) noexcept {
  for (int i = 0; i < kJointRows; ++i) {
    if (!contact.stuck[at(i)]) continue;
    mass.row(i).setZero();
    mass.col(i).setZero();
    mass(i, i) = 1;
    force[i] = 0;
  }
  return mass.llt().solve(force);
}

// Friction on every joint from now on.
LinkagePlant::Contact LinkagePlant::grip(const LinkageInput& input, double time_s) noexcept {
  Contact contact;
  if (!rubs_) return contact;
  bool rests = false;
  for (int i = 0; i < joints_; ++i) {
    if (coulomb_[i] == 0) continue;
    rests |= motion_.qd[i] == 0;
    if (motion_.qd[i] != 0) contact.friction[i] = -std::copysign(coulomb_[i], motion_.qd[i]);
  }
  if (!rests) return contact;
  if (const auto now = rate(motion_, input, time_s, contact)) hold_resting(now->qd, contact);
  return contact;
}

// The friction forces f of resting joints, |f_i| <= c_i, that leave the least acceleration
// a + M^-1 f (in the norm of M: Gauss's principle), by projected Gauss-Seidel. Where f_i does not
// reach c_i the joint is stuck; else it starts to slide against f_i.
void LinkagePlant::hold_resting(const Joints& acceleration, Contact& contact) noexcept {
  constexpr int kMostSweeps = 200;
  constexpr double kSettled = 1e-14;
  const JointMatrix mobility = here_.mass.llt().solve(JointMatrix::Identity());
  Joints a = acceleration, f = Joints::Zero();
  const auto rests = [&](int i) { return coulomb_[i] > 0 && motion_.qd[i] == 0; };
  double change = 1;
  for (int sweep = 0; sweep < kMostSweeps && change > kSettled; ++sweep) {
    change = 0;
    for (int i = 0; i < joints_; ++i) {
      if (!rests(i)) continue;
      const double wanted = std::clamp(f[i] - a[i] / mobility(i, i), -coulomb_[i], coulomb_[i]);
      change = std::max(change, std::abs(wanted - f[i]) / coulomb_[i]);
      a += mobility.col(i) * (wanted - f[i]);
      f[i] = wanted;
    }
  }
  constexpr double kStirs = 1e-12;  // of what the Coulomb force can hold: rounding
  for (int i = 0; i < joints_; ++i) {
    if (!rests(i)) continue;
    const bool slides = -a[i] * f[i] > kStirs * mobility(i, i) * coulomb_[i] * coulomb_[i];
    contact.stuck[at(i)] = !slides;
    contact.friction[i] = slides ? f[i] : 0;
  }
}

// Sliding joints whose friction would push them along at the end of the step. The velocity is taken
// as linear within it.
LinkagePlant::Reversal LinkagePlant::first_reversal(const Motion& next,
                                                    const Contact& contact) const noexcept {
  constexpr double kNone = 1e-3;  // of its speed before
  Reversal first;
  for (int i = 0; i < joints_; ++i) {
    if (contact.friction[i] == 0) continue;
    const double before = std::abs(motion_.qd[i]);
    const double after = contact.friction[i] > 0 ? -next.qd[i] : next.qd[i];
    if (after >= -kNone * before) continue;
    const double share = before / (before - after);
    if (first.joint < 0 || share < first.share) first = {i, share};
  }
  return first;
}

void LinkagePlant::accept(const Motion& next, const LinkageInput& input) noexcept {
  const double before_m = displacement_m();
  for (int i = 0; i < joints_; ++i)
    effort_work_J_[at(i)] += input.effort[i] * (next.q[i] - motion_.q[i]);
  motion_ = next;
  mass_.dynamics(motion_.q, motion_.qd, here_);
  tip_ = here_.points.point[0].at;
  script_work_J_ += input.force_N * (displacement_m() - before_m);
}

// By an impulse of friction on this joint alone; stuck joints stay at rest. It costs
// qd^2 / (2 (M^-1)_ii).
void LinkagePlant::stop(int joint, Contact& contact) noexcept {
  mass_.dynamics(motion_.q, motion_.qd, here_);
  const Joints kick = solve(here_.mass, Joints::Unit(joint), contact);
  const double speed = motion_.qd[joint];
  motion_.lost_J += 0.5 * speed * speed / kick[joint];
  motion_.qd -= speed / kick[joint] * kick;
  motion_.qd[joint] = 0;
  contact.friction[joint] = 0;
  contact.stuck[at(joint)] = true;
}

// At the end of what the linkage can reach: no pose fits beyond. Its links stop it.
void LinkagePlant::stop_dead() noexcept {
  here_.points.point[0].at = tip_;
  mass_.dynamics(motion_.q, motion_.qd, here_);
  motion_.lost_J += 0.5 * motion_.qd.dot(here_.mass * motion_.qd);
  motion_.qd.setZero();
}

}  // namespace hapticd::sim
