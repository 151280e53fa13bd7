// Faults and limits, the one table: code, name, meaning, who sets it, what the operator does. The
// man page hapticd(8) prints this table and a test holds the two together.
//
// A fault takes all forces to zero in the tick that sees it and stays until an operator clears it.
// A limit is not a fault: the force was bounded, the loop goes on, and the record says so.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace hapticd {

enum class Fault : std::uint8_t {
  none = 0,
  estop,
  overrun,
  missed_rate,
  cpu_time,
  suspended,
  clock_jump,
  device,
  disarmed,
  sample_missing,
  input_not_finite,
  encoder_jump,
  encoder_stuck,
  velocity,
  output_not_finite,
  kinematics,
  homing,
  travel,
  workspace,
  count_
};

/// Bits of LimitFlags.
enum class Limit : std::uint32_t {
  ramp = 1u << 0,
  force = 1u << 1,
  slew = 1u << 2,
  actuator = 1u << 3,
  sample_held = 1u << 4,
  reseeded = 1u << 5,
  stale = 1u << 6,
  singular = 1u << 7,
  power = 1u << 8,
  temperature = 1u << 9,
  travel = 1u << 10,
  compensation = 1u << 11,
  passivity = 1u << 12,
};

class LimitFlags {
 public:
  constexpr LimitFlags() = default;
  constexpr explicit LimitFlags(std::uint32_t bits) : bits_(bits) {}
  constexpr void set(Limit limit) noexcept { bits_ |= static_cast<std::uint32_t>(limit); }
  constexpr bool has(Limit limit) const noexcept {
    return (bits_ & static_cast<std::uint32_t>(limit)) != 0;
  }
  constexpr std::uint32_t bits() const noexcept { return bits_; }

 private:
  std::uint32_t bits_ = 0;
};

inline constexpr std::uint16_t kNoIndex = 0xffff;

/// The first fault since the last clear, with the figures that a person needs. Trivially copyable.
struct FaultReport {
  Fault code = Fault::none;
  std::uint16_t axis = kNoIndex;    ///< plan axis, where one is to blame
  std::uint16_t device = kNoIndex;  ///< plan device, where one is to blame
  double found = 0;                 ///< unit: FaultEntry::unit
  double allowed = 0;               ///< same unit
};

/// One row of the table. `unit` is that of FaultReport::found; for a quantity of an axis "" means
/// the axis' own unit.
struct FaultEntry {
  Fault code;
  std::string_view name;
  std::string_view meaning;
  std::string_view set_by;
  std::string_view action;  ///< what the operator should do
  std::string_view unit;
};

struct LimitEntry {
  Limit bit;
  std::string_view name;
  std::string_view meaning;
  std::string_view action;
};

std::span<const FaultEntry> fault_table() noexcept;
std::span<const LimitEntry> limit_table() noexcept;
const FaultEntry& entry(Fault code) noexcept;

}  // namespace hapticd
