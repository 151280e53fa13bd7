// OpenFFBoard: a board that plays force effects as a gamepad does. Each axis has a constant force whose magnitude follows the
// loop; the force ends by itself when it has not been started anew for `dead_man_s`, since the board has no watchdog. A start
// that the bus holds up for longer than that plays the last magnitude until the zero behind it is there, 1 to 2 ms.
//
// Positions come only when they change. While they do not, the board is asked for something else, and an answer without a
// position before it means that there is no other position: it may be as old as the board takes to send both, 3 ms at 1 kHz.
// Wire facts: Ultrawipf/OpenFFBoard (HidFFB.cpp, EffectsCalculator.cpp, Axis.cpp, FFBHIDMain.cpp); nothing was tried on a board.
#pragma once
#include <cstdint>
#include <memory>

#include "drivers/usb/options.h"
#include "drivers/usb/protocol.h"

namespace hapticd::hid {

/// usb::Reading::drive_faults.
namespace openffboard {
inline constexpr std::uint32_t kEmergencyStop = 1, kSafetySwitch = 2, kNoPower = 4, kPaused = 8,
                               kForceOff = 16;
}  // namespace openffboard

/// `options` outlives it.
std::unique_ptr<usb::Protocol> make_openffboard(const usb::DeviceOptions& options);

}  // namespace hapticd::hid
