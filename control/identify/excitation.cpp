#include "control/identify/excitation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace hapticd::identify {
namespace {

constexpr double kFirstShare = 0.01;  // of the force, to begin with
constexpr double kMotionShare = 0.5;  // of travel and speed that the motion may take
constexpr double kAlarmShare = 0.7;   // likewise, beyond which the amplitude is halved at once
constexpr double kGrowth = 1.12;      // of the amplitude in one period, at most
constexpr double kCut = 0.5;          // likewise, at least
constexpr double kSteady = 0.08;      // growth that is not worth while
constexpr int kMostAdjustments = 60;  // periods of one frequency
constexpr int kSettlingPeriods = 3;
constexpr double kSettling_s = 0.15;
constexpr double kFading_s = 0.3;

}  // namespace

Excitation::Excitation(const ExcitationOptions& options, double period_s)
    : options_(options), period_s_(period_s), amplitude_(kFirstShare * options.force) {
  plan_tones();
  turns_per_tick_ = period_turns_per_tick_ = tones_.front().turns_per_tick();
}

void Excitation::plan_tones() {
  const int steps = options_.method == Method::stepped ? options_.steps : 1;
  const double ratio = std::log(options_.low_Hz / options_.high_Hz);
  for (int i = 0; i < steps; ++i) {
    const double wanted_Hz = options_.high_Hz * std::exp(steps > 1 ? ratio * i / (steps - 1) : 0.0);
    const auto periods = static_cast<std::size_t>(std::ceil(options_.block_s * wanted_Hz - 1e-9));
    auto ticks = static_cast<std::size_t>(
        std::max(4.0, std::round(static_cast<double>(periods) / (wanted_Hz * period_s_))));
    // Without a common divisor no period is sampled like the one before: else the encoder's steps
    // would err in the same way again and again.
    while (std::gcd(periods, ticks) > 1) ++ticks;
    tones_.push_back({.periods = static_cast<int>(periods), .block_ticks = ticks});
  }
  measured_.reserve(tones_.size());
}

double Excitation::next(double deviation, double velocity) noexcept {
  peak_ = std::max(peak_, std::abs(deviation));
  peak_speed_ = std::max(peak_speed_, std::abs(velocity));
  half_peak_ = std::max(half_peak_, std::abs(deviation));
  half_peak_speed_ = std::max(half_peak_speed_, std::abs(velocity));
  if (stage_ == Stage::measuring && stage_ticks_ == measured_.back().ticks()) begin_tone();
  if (stage_ == Stage::sweeping) sweep();
  const double share = stage_ == Stage::fading ? left_of_fade() : 1;
  if (share <= 0) enter(Stage::done);
  if (stage_ == Stage::done) return 0;
  const double effort = share * amplitude_ * std::sin(2 * std::numbers::pi * phase_);
  ++tick_;
  ++stage_ticks_;
  const bool first_half = phase_ < 0.5;
  phase_ += turns_per_tick_;
  if (first_half && phase_ >= 0.5) end_of_half();
  if (phase_ >= 1) {
    end_of_half();
    phase_ -= 1;
    end_of_period();
  }
  return effort;
}

void Excitation::enter(Stage stage) noexcept {
  stage_ = stage;
  stage_ticks_ = 0;
  stage_periods_ = 0;
}

double Excitation::left_of_fade() const noexcept {
  const double ticks = std::max(kFading_s / period_s_, 1 / turns_per_tick_);
  return 1 - static_cast<double>(stage_ticks_) / ticks;
}

/// The next frequency of a stepped sine, or the end.
void Excitation::begin_tone() noexcept {
  if (++tone_ == tones_.size()) return enter(Stage::fading);
  const double before = turns_per_tick_;
  turns_per_tick_ = tones_[tone_].turns_per_tick();
  move_as_far(turns_per_tick_ / before);
  tone_periods_ = 0;
  enter(Stage::adjusting);
}

/// The frequency of a chirp: its logarithm goes down and up like a saw.
void Excitation::sweep() noexcept {
  const double sweeps = static_cast<double>(stage_ticks_) * period_s_ / options_.sweep_s;
  if (sweeps >= options_.sweeps) return enter(Stage::fading);
  const double whole = std::floor(sweeps);
  const double down = std::fmod(whole, 2) == 0 ? sweeps - whole : 1 - (sweeps - whole);
  turns_per_tick_ =
      options_.high_Hz * std::pow(options_.low_Hz / options_.high_Hz, down) * period_s_;
}

/// Where the frequency falls by `ratio`, the amplitude falls so that a mass would move at most 1.4
/// times as far as before; an axis that friction slows moves about as far.
void Excitation::move_as_far(double ratio) noexcept {
  if (ratio < 1)
    amplitude_ =
        std::max(amplitude_ * ratio * std::min(1.0, 1.4 * ratio), kFirstShare * options_.force);
}

double Excitation::wanted_growth() const noexcept {
  const auto room = [](double limit, double used) { return limit / std::max(used, 1e-9 * limit); };
  return std::min({room(kMotionShare * options_.travel, peak_),
                   room(kMotionShare * options_.speed, peak_speed_), options_.force / amplitude_});
}

/// Beats of a frequency that has just changed, or a motion that grows faster than it was foreseen: half
/// of the amplitude at once.
void Excitation::end_of_half() noexcept {
  const bool alarming =
      half_peak_ > kAlarmShare * options_.travel || half_peak_speed_ > kAlarmShare * options_.speed;
  half_peak_ = half_peak_speed_ = 0;
  if (!alarming || stage_ == Stage::measuring || stage_ == Stage::fading) return;
  amplitude_ *= 0.5;
  if (stage_ == Stage::settling && tone_periods_ < kMostAdjustments) enter(Stage::adjusting);
}

void Excitation::end_of_period() noexcept {
  ++stage_periods_;
  ++tone_periods_;
  // The root: near the force that friction holds, the motion grows faster than the amplitude.
  const double growth = std::clamp(std::sqrt(wanted_growth()), kCut, kGrowth);
  peak_ = peak_speed_ = 0;
  if (stage_ == Stage::adjusting) {
    amplitude_ *= growth;
    if (std::abs(growth - 1) < kSteady || tone_periods_ >= kMostAdjustments)
      enter(options_.method == Method::stepped ? Stage::settling : Stage::sweeping);
  } else if (stage_ == Stage::sweeping) {
    amplitude_ *= growth;
    move_as_far(turns_per_tick_ / period_turns_per_tick_);
  } else if (stage_ == Stage::settling && stage_periods_ >= kSettlingPeriods &&
             static_cast<double>(stage_ticks_) * period_s_ >= kSettling_s) {
    begin_measuring();
  }
  period_turns_per_tick_ = turns_per_tick_;
}

void Excitation::begin_measuring() noexcept {
  enter(Stage::measuring);
  measured_.push_back({.frequency_Hz = frequency_Hz(),
                       .periods = tones_[tone_].periods,
                       .begin = tick_,
                       .block_ticks = tones_[tone_].block_ticks,
                       .blocks = options_.blocks});
}

double Excitation::progress() const noexcept {
  if (stage_ == Stage::done) return 1;
  if (options_.method == Method::chirp) {
    return stage_ == Stage::sweeping ? static_cast<double>(stage_ticks_) * period_s_ /
                                           (options_.sweep_s * options_.sweeps)
                                     : (stage_ == Stage::fading ? 1.0 : 0.0);
  }
  // A frequency takes about as many periods as any other: progress is counted in their length.
  double before = 0, all = 0;
  for (std::size_t i = 0; i < tones_.size(); ++i) {
    const double length = 1 / tones_[i].turns_per_tick();
    all += length;
    if (i < tone_) before += length;
  }
  return before / all;
}

std::size_t Excitation::longest_ticks() const noexcept {
  double ticks = 1000 + kFading_s / period_s_ + 1 / tones_.back().turns_per_tick();
  for (const Tone& tone : tones_) {
    ticks += (kMostAdjustments + kSettlingPeriods + 2) / tone.turns_per_tick() +
             kSettling_s / period_s_ +
             static_cast<double>(tone.block_ticks * static_cast<std::size_t>(options_.blocks));
  }
  if (options_.method == Method::chirp) ticks += options_.sweeps * options_.sweep_s / period_s_;
  return static_cast<std::size_t>(ticks);
}

}  // namespace hapticd::identify
