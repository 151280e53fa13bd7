// Which unit a register of moteus has, and what one step of an integer is worth.
#pragma once
#include <cstdint>
#include <limits>

#include "sim/can/moteus_wire.h"

namespace hapticd::sim::can {

enum class MoteusUnit : std::uint8_t {
  count,    ///< whole numbers: modes, codes, versions
  counter,  ///< whole numbers that wrap
  position,
  velocity,
  torque,
  scale,  ///< of kp, kd, ilimit
  voltage,
  temperature,
  time,
  current,
  power,
  acceleration,
};

inline MoteusUnit moteus_unit(std::uint32_t reg) {
  switch (reg) {
    case 0x001:
    case 0x006:
    case 0x020:
    case 0x026:
    case 0x040:
    case 0x041:
      return MoteusUnit::position;
    case 0x002:
    case 0x021:
    case 0x028:
      return MoteusUnit::velocity;
    case 0x003:
    case 0x022:
    case 0x025:
    case 0x042:
    case 0x045:
      return MoteusUnit::torque;
    case 0x023:
    case 0x024:
    case 0x02b:
    case 0x043:
    case 0x044:
    case 0x047:
      return MoteusUnit::scale;
    case 0x00d:
    case 0x02a:
      return MoteusUnit::voltage;
    case 0x00a:
    case 0x00e:
      return MoteusUnit::temperature;
    case 0x027:
    case 0x046:
      return MoteusUnit::time;
    case 0x004:
    case 0x005:
    case 0x02c:
      return MoteusUnit::current;
    case 0x007:
      return MoteusUnit::power;
    case 0x029:
      return MoteusUnit::acceleration;
    case 0x070:
      return MoteusUnit::counter;
    default:
      return MoteusUnit::count;
  }
}

/// Of an int8, int16 and int32.
struct MoteusSteps {
  double int8 = 1, int16 = 1, int32 = 1;
};

inline MoteusSteps moteus_steps(MoteusUnit unit) {
  switch (unit) {
    case MoteusUnit::position:
      return {0.01, 1e-4, 1e-5};
    case MoteusUnit::velocity:
      return {0.1, 2.5e-4, 1e-5};
    case MoteusUnit::torque:
      return {0.5, 0.01, 0.001};
    case MoteusUnit::scale:
      return {1.0 / 127, 1.0 / 32767, 1.0 / 2147483647};
    case MoteusUnit::voltage:
      return {0.5, 0.1, 0.001};
    case MoteusUnit::temperature:
      return {1, 0.1, 0.001};
    case MoteusUnit::time:
      return {0.01, 0.001, 1e-6};
    case MoteusUnit::current:
      return {1, 0.1, 0.001};
    case MoteusUnit::power:
      return {10, 0.05, 1e-4};
    case MoteusUnit::acceleration:
      return {0.05, 0.001, 1e-5};
    default:
      return {};
  }
}

inline double moteus_step(std::uint32_t reg, MoteusType type) {
  const MoteusSteps steps = moteus_steps(moteus_unit(reg));
  if (type == MoteusType::int8) return steps.int8;
  return type == MoteusType::int16 ? steps.int16 : steps.int32;
}

/// Largest positive integer of the type; -largest - 1 stands for NaN.
inline double moteus_largest(MoteusType type) {
  if (type == MoteusType::int8) return std::numeric_limits<std::int8_t>::max();
  if (type == MoteusType::int16) return std::numeric_limits<std::int16_t>::max();
  return std::numeric_limits<std::int32_t>::max();
}

}  // namespace hapticd::sim::can
