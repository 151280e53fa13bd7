// As the firmware's Axis. Left out: limits of speed, and its errors but for the range.
#include "sim/usb/openffboard_axis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticd::sim::usb {
namespace {

enum Setting : std::uint32_t {
  kPower = 0x00,
  kDegrees = 0x01,
  kEndStopGain = 0x02,
  kZeroEncoder = 0x03,
  kInvert = 0x04,
  kIdleSpring = 0x05,
  kDamper = 0x06,
  kEncoderType = 0x07,
  kDriverType = 0x08,
  kPosition = 0x09,
  kMaxSpeed = 0x0a,
  kMaxTorqueRate = 0x0b,
  kEffectRatio = 0x0c,
  kTorqueNow = 0x0d,
  kPositionNow = 0x0e,
  kSpeedNow = 0x0f,
  kAccelNow = 0x10,
  kCpr = 0x15,
  kFriction = 0x16,
  kInertia = 0x17,
  kExpo = 0x18,
  kExpoScale = 0x19,
};

constexpr std::int32_t kFull = 0x7fff, kMostOwn = 20000;
constexpr double kAxisRate_Hz = 1000;
constexpr double kDamperGain = 40 * 0.7 / 255, kInertiaGain = 4 * 0.7 / 255;
constexpr double kFrictionSpeed = 45, kFrictionRamp = 4096, kFrictionGain = 0.7 * 32;
constexpr double kEndStopScale = 25;

std::int32_t cut(double value, double most) {
  return static_cast<std::int32_t>(std::clamp(value, -most, most));
}

}  // namespace

OpenffboardAxis::OpenffboardAxis(const OpenffboardAxisOptions& options)
    : options_(options),
      now_(options),
      counts_per_degree_(65536.0 / options.degrees),
      wanted_degrees_(options.degrees),
      speed_filter_(70 / kAxisRate_Hz, 0.55),
      accel_filter_(55 / kAxisRate_Hz, 0.3),
      damper_filter_(60 / kAxisRate_Hz, 0.55),
      friction_filter_(50 / kAxisRate_Hz, 0.2),
      inertia_filter_(20 / kAxisRate_Hz, 0.2) {
  set_expo(options.expo);
  plugged_in();
}

void OpenffboardAxis::set_expo(std::int64_t value) {
  now_.expo = static_cast<int>(std::clamp<std::int64_t>(value, -127, 127));
  const double strength = std::abs(now_.expo / static_cast<double>(expo_scale_));
  expo_ = now_.expo < 0 ? 1 / (1 + strength) : 1 + strength;
}

double OpenffboardAxis::torque() const {
  return motor_on_ ? options_.full_torque_Nm * torque_ / kFull : 0;
}

void OpenffboardAxis::move_to(double counts, double) {
  at_counts_ = counts;
}

std::int32_t OpenffboardAxis::encoder() const {
  const double turns = at_counts_ / counts_per_degree_ / 360;
  return static_cast<std::int32_t>(std::llround(turns * now_.cpr)) - zero_encoder_;
}

/// In 65535ths of the range.
std::int32_t OpenffboardAxis::scaled(double degrees) const {
  return static_cast<std::int32_t>(65535.0 / now_.degrees * degrees);
}

void OpenffboardAxis::measure() {
  const double before = degrees_;
  degrees_ = 360.0 * encoder() / now_.cpr * (now_.invert ? -1 : 1);
  if (!measured_) last_speed_ = 0;
  const double speed = measured_ ? (degrees_ - before) * kAxisRate_Hz : 0;
  measured_ = true;
  speed_ = speed_filter_(speed);
  accel_ = accel_filter_(speed - last_speed_) * kAxisRate_Hz;
  last_speed_ = speed;
  if (wanted_degrees_ != now_.degrees && std::abs(65535.0 / wanted_degrees_ * degrees_) < kFull)
    now_.degrees = wanted_degrees_;
  if (std::abs(scaled(degrees_)) > 0xffff && motor_on_) {
    motor_on_ = false;
    out_of_bounds_ = true;
  } else if (std::abs(scaled(degrees_)) <= kFull) {
    out_of_bounds_ = false;
  }
}

/// In single precision, as the firmware reckons it.
std::int16_t OpenffboardAxis::pad() const {
  const auto share = static_cast<float>(2.0 / now_.degrees * static_cast<float>(degrees_));
  const double fine = std::clamp(share * 2147483648.0, -2147483647.0, 2147483647.0);
  return static_cast<std::int16_t>(static_cast<std::int32_t>(fine) >> 16);
}

void OpenffboardAxis::drive(bool actuators, bool emergency, std::int32_t effects) {
  if (emergency) {
    torque_ = 0;
    return;
  }
  double torque = effects;
  if (now_.expo != 0)
    torque = std::trunc(std::copysign(std::pow(std::abs(torque) / kFull, expo_), torque) * kFull);
  torque = std::trunc(torque * now_.fxratio / 255) + own_torque(actuators) + end_stop();
  std::int32_t whole = static_cast<std::int32_t>(torque * now_.power / kFull);
  if (max_rate_ > 0) {
    const auto rate = static_cast<std::int32_t>(max_rate_);
    whole = std::clamp(whole, limited_from_ - rate, limited_from_ + rate);
  }
  if (out_of_bounds_) whole = 0;
  if (fade_ < 1) {
    whole = static_cast<std::int32_t>(whole * fade_);
    fade_ += 1 / (options_.fade_in_s * kAxisRate_Hz);
  }
  limited_from_ = now_.invert ? -whole : whole;
  torque_ = std::clamp<std::int32_t>(limited_from_, -now_.power, now_.power);
}

/// Spring while no effects play, damper, inertia and friction always.
std::int32_t OpenffboardAxis::own_torque(bool actuators) {
  std::int32_t sum = 0;
  if (!actuators)
    sum += cut(-scaled(degrees_) * (0.5 + 0.01 * now_.idlespring),
               std::min(35.0 * now_.idlespring, 10000.0));
  if (now_.damper != 0)
    sum -= static_cast<std::int32_t>(
        damper_filter_(cut(speed_ * now_.damper * kDamperGain, kMostOwn)));
  if (now_.inertia != 0)
    sum -= static_cast<std::int32_t>(
        inertia_filter_(cut(accel_ * now_.inertia * kInertiaGain, kMostOwn)));
  if (now_.friction != 0) {
    const double speed = speed_ * kFrictionSpeed;
    const double share = std::min(1.0, std::abs(speed) / kFrictionRamp);
    const double ramp = (1 + std::sin(std::numbers::pi * (share - 0.5))) / 2;
    const double force = std::copysign(now_.friction * ramp * kFrictionGain, speed);
    sum -= static_cast<std::int32_t>(friction_filter_(cut(force, kMostOwn)));
  }
  return sum;
}

std::int32_t OpenffboardAxis::end_stop() const {
  const std::int32_t at = scaled(degrees_);
  if (std::abs(at) <= kFull) return 0;
  const double beyond = std::abs(degrees_) - now_.degrees / 2.0;
  return cut(std::copysign(beyond, -degrees_) * now_.esgain * kEndStopScale, kFull);
}

bool OpenffboardAxis::knows(std::uint32_t command) const {
  return command <= kAccelNow || (command >= kCpr && command <= kExpoScale);
}

std::optional<std::int64_t> OpenffboardAxis::read(std::uint32_t command) const {
  switch (command) {
    case kPower:
      return now_.power;
    case kDegrees:
      return now_.degrees;
    case kEndStopGain:
      return now_.esgain;
    case kInvert:
      return now_.invert ? 1 : 0;
    case kIdleSpring:
      return now_.idlespring;
    case kDamper:
      return now_.damper;
    case kEncoderType:
    case kDriverType:
      return 2;
    case kPosition:
      return now_.invert ? -encoder() : encoder();
    case kMaxSpeed:
      return max_speed_;
    case kMaxTorqueRate:
      return max_rate_;
    case kEffectRatio:
      return now_.fxratio;
    case kTorqueNow:
      return limited_from_;
    case kPositionNow:
      return scaled(degrees_);
    case kSpeedNow:
      return static_cast<std::int64_t>(speed_);
    case kAccelNow:
      return static_cast<std::int64_t>(accel_);
    case kCpr:
      return now_.cpr;
    case kFriction:
      return now_.friction;
    case kInertia:
      return now_.inertia;
    case kExpo:
      return now_.expo;
    case kExpoScale:
      return expo_scale_;
    default:
      return std::nullopt;
  }
}

bool OpenffboardAxis::write(std::uint32_t command, std::int64_t value) {
  const auto byte = static_cast<std::uint8_t>(value);
  switch (command) {
    case kPower:
      now_.power = static_cast<std::uint16_t>(value);
      return true;
    case kDegrees:
      if ((value & 0x7fff) != 0) wanted_degrees_ = static_cast<std::uint16_t>(value & 0x7fff);
      return true;
    case kEndStopGain:
      now_.esgain = byte;
      return true;
    case kZeroEncoder:
      zero_encoder_ += encoder();
      return true;
    case kInvert:
      now_.invert = value >= 1;
      measured_ = false;
      return true;
    case kIdleSpring:
      now_.idlespring = byte;
      return true;
    case kDamper:
      now_.damper = byte;
      return true;
    case kPosition:
      zero_encoder_ += encoder() - static_cast<std::int32_t>(now_.invert ? -value : value);
      return true;
    case kMaxSpeed:
      max_speed_ = static_cast<std::uint16_t>(value);
      return true;
    case kMaxTorqueRate:
      max_rate_ = static_cast<std::uint32_t>(value);
      return true;
    case kEffectRatio:
      now_.fxratio = byte;
      return true;
    case kFriction:
      now_.friction = byte;
      return true;
    case kInertia:
      now_.inertia = byte;
      return true;
    case kExpo:
      set_expo(value);
      return true;
    case kExpoScale:
      if (value > 0) expo_scale_ = value;
      return true;
    default:
      return command == kEncoderType || command == kDriverType;
  }
}

void OpenffboardAxis::plugged_in() {
  motor_on_ = true;
  fade_ = options_.fade_in_s > 0 ? 0 : 1;
}

/// Its encoder is absolute.
void OpenffboardAxis::power_up() {
  const double counts = at_counts_;
  const OpenffboardAxisOptions options = options_;
  *this = OpenffboardAxis(options);
  at_counts_ = counts;
}

}  // namespace hapticd::sim::usb
