// What the servo thread and the device's own thread have in common: the newest reading one way, the newest command the
// other way, and which connection they are of. Neither ever waits for the other.
#pragma once
#include <atomic>
#include <cstdint>

#include "control/rt/latest.h"
#include "drivers/device.h"
#include "drivers/fault_text.h"
#include "drivers/usb/protocol.h"

namespace hapticd::usb {

struct Exchange {
  rt::Latest<Reading> reading;  ///< the device's thread stores
  rt::Latest<Command> command;  ///< the servo thread stores
  /// Which connection is up, counted from 1; 0: none is. A reading or a command of another one is not to be used.
  std::atomic<std::uint32_t> link{0};
  std::uint32_t connections = 0;  ///< so many there were: of the device's thread, over all of them
  drivers::FaultText
      lost;  ///< why the last connection ended, or the device failed; before `link` or the reading tells it
  drivers::FaultText doing;  ///< what the device is about while no connection is up
  drivers::Traffic traffic;
};

}  // namespace hapticd::usb
