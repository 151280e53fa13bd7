// The daemon's states and what leads from one to the next. Pure, so that every way is tested
// without a thread.
//
//   off -> connecting -> ready <-> (homing ->) enabled, fault from each of the last three,
//   out of it to ready or on; off from anywhere
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "control/build/program.h"
#include "control/core/fault.h"
#include "control/state.h"

namespace hapticd::daemon {

enum class State : std::uint8_t { off, connecting, homing, ready, enabled, fault };
inline constexpr std::array<std::string_view, 6> kStateNames = {"off",   "connecting", "homing",
                                                                "ready", "enabled",    "fault"};
constexpr std::string_view name(State state) {
  return kStateNames[static_cast<std::size_t>(state)];
}

/// What the supervisor sees of the world. `ready` does not mean that every axis knows where it is:
/// axes whose reference can be found under power are homed on the way to `enabled`.
struct Seen {
  bool starting = false;  ///< devices are being connected
  bool looping = false;   ///< the servo thread runs
  control::Mode mode = control::Mode::idle;
};

/// The state that follows from `seen`. A running loop says itself where it is.
State next_state(State now, const Seen& seen) noexcept;

/// A fault for people: meaning, axis or device by name, figures with units, what to do.
/// `device_text`: what the driver says of its own fault, may be empty.
std::string describe_fault(const FaultReport& fault, const build::ProgramSpec& names,
                           std::string_view device_text = {});

/// Unit of FaultReport::found, for an axis that is rotary or not; "" where the fault has no figure.
std::string_view fault_unit(Fault code, bool rotary) noexcept;
std::string_view fault_unit(const FaultReport& fault, const build::ProgramSpec& spec) noexcept;

/// "left.x", "left", or "" where nobody is to blame.
std::string blamed(const FaultReport& fault, const build::ProgramSpec& names);

}  // namespace hapticd::daemon
