// As the firmware's HidFFB and EffectsCalculator: what a report changes, and when. Whole numbers are cut where it cuts them.
#include "sim/usb/openffboard_effects.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticd::sim::usb {
namespace {

constexpr std::uint8_t kStartAlone = 2, kStopOne = 3;
constexpr double kRate_Hz = 1000;

/// Of an axis, from 1/100 degree where directions count, else linear about 180 degrees. Y is turned round.
float factor(bool by_angle, bool enabled, std::uint16_t angle_of_x, std::uint16_t own, bool y) {
  const float angle =
      static_cast<float>(2 * std::numbers::pi) * static_cast<float>(angle_of_x) / 36000;
  if (by_angle) return y ? -std::cos(angle) : std::sin(angle);
  const float along = (static_cast<float>(own) - 18000) / 18000;
  return enabled ? (y ? -along : along) : 0;
}

}  // namespace

OpenffboardEffects::OpenffboardEffects(std::size_t axes) : axes_(axes) {}

OpenffboardEffects::Effect* OpenffboardEffects::at(std::uint8_t index) {
  return index == 0 || index > kEffects ? nullptr : &effects_[index - 1u];
}

void OpenffboardEffects::create(std::uint8_t type) {
  const auto unused = std::ranges::find(effects_, 0, &Effect::type);
  if (type == 0 || type > kTypes || unused == effects_.end()) {
    load_status_ = 2;
    return;
  }
  *unused = Effect{.type = type};
  set_filters(*unused);
  loaded_index_ = static_cast<std::uint8_t>(unused - effects_.begin() + 1);
  load_status_ = 1;
  used_ = std::min(used_ + 1, kEffects);
}

void OpenffboardEffects::set(const OpenffboardSetEffect& report) {
  Effect* effect = at(report.index);
  if (effect == nullptr) return;
  if (effect->type != report.type) {
    effect->start_ms = 0;
    effect->type = report.type;
    set_filters(*effect);
  }
  effect->gain = report.gain;
  const bool by_angle = report.enable >> axes_ & 1;
  effect->factors = {
      factor(by_angle, report.enable & 1, report.direction_x, report.direction_x, false),
      factor(by_angle, report.enable & 2, report.direction_x, report.direction_y, true)};
  effect->duration_ms = report.duration_ms == 0 ? kForEver : report.duration_ms;
  effect->delay_ms = report.start_delay_ms;
  active_ = true;
}

void OpenffboardEffects::set(const OpenffboardConstant& force) {
  if (Effect* effect = at(force.index)) effect->magnitude = force.magnitude;
}

/// Its loop count is not looked at. A start while it plays starts its time anew.
void OpenffboardEffects::operate(const OpenffboardOperation& operation, std::uint32_t tick_ms) {
  Effect* effect = at(operation.index);
  if (effect == nullptr) return;
  if (operation.operation == kStopOne) {
    effect->playing = false;
    return;
  }
  if (operation.operation == kStartAlone)
    for (Effect& other : effects_) other.playing = false;
  if (!effect->playing) set_filters(*effect);
  effect->start_ms = tick_ms + effect->delay_ms;
  effect->playing = true;
}

void OpenffboardEffects::free(std::uint8_t index) {
  if (Effect* effect = at(index)) *effect = {};
}

void OpenffboardEffects::control(std::uint8_t bits) {
  if (bits & 0x01) active_ = true;
  if (bits & (0x02 | 0x04)) active_ = false;
  if (bits & 0x08) {
    active_ = false;
    reset();
  }
  if (bits & 0x10) active_ = false;
  if (bits & 0x20) active_ = true;
}

void OpenffboardEffects::reset() {
  effects_.fill({});
  used_ = 1;
}

std::vector<std::uint8_t> OpenffboardEffects::block_load() const {
  return openffboard_block_load(loaded_index_, load_status_,
                                static_cast<std::uint16_t>((kEffects - used_) * kEffectBytes));
}

std::vector<std::uint8_t> OpenffboardEffects::pool() const {
  return openffboard_pool(kEffects * kEffectBytes, kEffects);
}

std::vector<std::uint8_t> OpenffboardEffects::state() const {
  return openffboard_state(
      {.paused = !active_, .actuators = active_, .power = true, .playing = active_});
}

void OpenffboardEffects::set_filter_Hz(std::int64_t frequency) {
  constexpr auto kHalf = static_cast<std::int64_t>(kRate_Hz / 2);
  const std::int64_t wanted = static_cast<std::uint32_t>(frequency);
  filter_Hz_ = static_cast<std::uint32_t>(wanted == 0 ? kHalf : std::min(wanted, kHalf));
  for (Effect& effect : effects_) set_filters(effect);
}

void OpenffboardEffects::set_filter_q(std::int64_t hundredths) {
  const auto wanted = static_cast<std::uint8_t>(hundredths);
  filter_q_ = std::clamp<std::uint8_t>(wanted, 1, 127);
  for (Effect& effect : effects_) set_filters(effect);
}

void OpenffboardEffects::set_filters(Effect& effect) const {
  const double frequency = filter_Hz_ / kRate_Hz;
  if (effect.type != kConstant) return;
  effect.filters.fill(frequency < 0.5 ? Biquad(frequency, 0.01 * filter_q_) : Biquad());
}

/// True: makes no force now. Its last tick is `duration` after its first. One without an end does not wait either.
bool OpenffboardEffects::waits_or_ends(Effect& effect, std::uint32_t tick_ms) {
  if (effect.duration_ms == kForEver) return false;
  if (tick_ms < effect.start_ms) return true;
  if (tick_ms - effect.start_ms > effect.duration_ms) effect.playing = false;
  return !effect.playing;
}

std::array<std::int32_t, OpenffboardEffects::kAxes> OpenffboardEffects::forces(
    std::uint32_t tick_ms) {
  std::array<std::int32_t, kAxes> sums{};
  if (!active_) return sums;
  for (Effect& effect : effects_) {
    if (!effect.playing || waits_or_ends(effect, tick_ms) || effect.type != kConstant) continue;
    const std::int32_t force = effect.magnitude * effect.gain / 255;
    for (std::size_t i = 0; i < axes_; ++i) {
      const auto filtered = static_cast<std::int32_t>(effect.filters[i](force));
      const auto along =
          static_cast<std::int32_t>(static_cast<float>(-filtered) * effect.factors[i]);
      sums[i] += along * gain_ / 255;
    }
  }
  for (std::int32_t& sum : sums) sum = std::clamp(sum, -kFull, kFull);
  return sums;
}

}  // namespace hapticd::sim::usb
