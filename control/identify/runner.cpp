#include "control/identify/runner.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace hapticd::identify {
namespace {

constexpr std::size_t kWatched = 20;      // ticks before the first effort
constexpr std::size_t kMostMissing = 10;  // ticks in a row
constexpr double kSineShare = 0.8;        // of the force; the rest is left to the centring
constexpr double kSpringShare = 0.3;      // of the force, at the end of the travel
constexpr double kFirmShare = 0.6;        // likewise, before the excitation
constexpr double kDamperPeriods = 8;  // damper / spring; more than a delay of 7 periods takes away
constexpr double kWeighing_s = 1;     // before the excitation
constexpr double kWeight_s = 0.3;     // spring / integrator of the weight
constexpr double kWeightShare = 0.5;  // of the force that weight may take

ExcitationOptions sine_of(ExcitationOptions options) {
  options.force *= kSineShare;
  return options;
}

}  // namespace

Runner::Runner(const ExcitationOptions& options, double period_s)
    : options_(options), excitation_(sine_of(options), period_s) {
  record_.period_s = period_s;
  record_.samples.reserve(kWatched + static_cast<std::size_t>(kWeighing_s / period_s) +
                          excitation_.longest_ticks());
}

double Runner::tick(double position, bool fresh) noexcept {
  if (ended_ != Ended::running) return 0;
  see(position, fresh);
  if (record_.samples.size() <= kWatched) {
    middle_ = last_[0];
    begin_ = record_.samples.size();
    return 0;
  }
  const double deviation = last_[0] - middle_, speed = velocity();
  hold_bounds(deviation, speed);
  if (ended_ != Ended::running) return 0;
  if (static_cast<double>(record_.samples.size() - kWatched) * record_.period_s <= kWeighing_s) {
    begin_ = record_.samples.size();
    return weigh(deviation, speed);
  }
  const double sine = excitation_.next(deviation, speed);
  if (excitation_.done()) ended_ = Ended::complete;
  if (ended_ == Ended::complete) return 0;
  return bounded(sine + weight_ + centring(kSpringShare, deviation, speed));
}

void Runner::see(double position, bool fresh) noexcept {
  fresh = fresh && std::isfinite(position);
  missing_ = fresh ? 0 : missing_ + 1;
  const double at = fresh ? position : last_[0];
  if (record_.samples.empty()) last_.fill(at);
  std::copy_backward(last_.begin(), last_.end() - 1, last_.end());
  last_[0] = at;
  record_.samples.push_back({.position = at, .effort = 0, .fresh = fresh});
}

void Runner::delivered(double effort) noexcept {
  if (!record_.samples.empty()) record_.samples.back().effort = effort;
}

/// Over four periods: an encoder's step is then a small share of the speed.
double Runner::velocity() const noexcept {
  return (last_.front() - last_.back()) /
         (static_cast<double>(last_.size() - 1) * record_.period_s);
}

/// What holds the axis in the middle while nothing else moves it is its weight.
double Runner::weigh(double deviation, double velocity) noexcept {
  const double stiffness = kFirmShare * options_.force / options_.travel;
  const double most = kWeightShare * options_.force;
  weight_ -= stiffness * deviation * record_.period_s / kWeight_s;
  weight_ = std::clamp(weight_, -most, most);
  return bounded(weight_ + centring(kFirmShare, deviation, velocity));
}

double Runner::bounded(double effort) const noexcept {
  return std::clamp(effort, -options_.force, options_.force);
}

double Runner::centring(double share, double deviation, double velocity) const noexcept {
  const double stiffness = share * options_.force / options_.travel;
  return -stiffness * (deviation + kDamperPeriods * record_.period_s * velocity);
}

void Runner::hold_bounds(double deviation, double velocity) noexcept {
  const auto end = [&](Ended how, double found) {
    ended_ = how;
    found_ = found;
  };
  if (missing_ > kMostMissing) return end(Ended::no_samples, static_cast<double>(missing_));
  if (std::abs(deviation) > options_.travel) return end(Ended::too_far, deviation);
  if (std::abs(velocity) > options_.speed) return end(Ended::too_fast, velocity);
}

std::string Runner::why() const {
  const auto text = [&](const char* format, double limit) {
    std::array<char, 240> line{};
    std::snprintf(line.data(), line.size(), format, found_, limit, excitation_.frequency_Hz(),
                  excitation_.amplitude());
    return std::string(line.data());
  };
  switch (ended_) {
    case Ended::running:
      return "still running";
    case Ended::complete:
      return "complete";
    case Ended::too_far:
      return text(
          "the axis went %.4g from where it began, allowed are %.4g (at %.3g Hz with an "
          "effort of %.3g): allow more travel, or less force",
          options_.travel);
    case Ended::too_fast:
      return text(
          "the axis moved at %.4g, allowed are %.4g (at %.3g Hz with an effort of %.3g): "
          "allow more speed, or less force",
          options_.speed);
    case Ended::no_samples:
      return text("no fresh position for %.0f ticks, allowed are %.0f", kMostMissing);
  }
  return {};
}

std::vector<Measured> Runner::measured() const {
  std::vector<Measured> all = excitation_.measured();
  for (Measured& one : all) one.begin += begin_;
  return all;
}

}  // namespace hapticd::identify
