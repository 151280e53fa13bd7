// Sizes and steps of moteus' registers in each format: what encoder and decoder share.
#pragma once
#include <cstddef>
#include <cstdint>

#include "drivers/can/moteus_codec.h"

namespace hapticd::can::moteus {

inline std::size_t size_of(Format format) noexcept {
  return format == Format::int8 ? 1 : format == Format::int16 ? 2 : 4;
}

/// One step of each integer format.
struct Steps {
  double int8, int16, int32;
};
inline Steps steps_of(std::uint16_t which) noexcept {
  switch (static_cast<Register>(which)) {
    case Register::position:
    case Register::command_position:
    case Register::within_lower:
    case Register::within_upper:
      return {0.01, 1e-4, 1e-5};
    case Register::velocity:
    case Register::command_velocity:
      return {0.1, 2.5e-4, 1e-5};
    case Register::torque:
    case Register::feedforward_torque:
    case Register::maximum_torque:
    case Register::within_feedforward_torque:
    case Register::within_maximum_torque:
      return {0.5, 0.01, 0.001};
    case Register::kp_scale:
    case Register::kd_scale:
    case Register::ilimit_scale:
      return {1.0 / 127, 1.0 / 32767, 1.0 / 2147483647};
    case Register::voltage:
      return {0.5, 0.1, 0.001};
    case Register::temperature:
      return {1, 0.1, 0.001};
    case Register::watchdog_timeout:
    case Register::within_watchdog_timeout:
      return {0.01, 0.001, 1e-6};
    default:
      return {1, 1, 1};
  }
}
inline double step_of(std::uint16_t which, Format format) noexcept {
  const Steps steps = steps_of(which);
  return format == Format::int8 ? steps.int8 : format == Format::int16 ? steps.int16 : steps.int32;
}

}  // namespace hapticd::can::moteus
