// Sets up a CiA 402 drive by SDOs: what it is, who watches whom, which PDOs carry what. May wait: before the loop only.
#pragma once
#include <string>

#include "control/core/result.h"
#include "drivers/can/cia402_codec.h"
#include "drivers/can/drive.h"

namespace hapticd::can::cia402 {

struct SetUp {
  std::uint8_t node = 1;
  std::uint8_t host_node = 127;
  double period_s = 1e-3;
  double watchdog_s = 0.02;  ///< the drive gives up when it has not heard the host for so long
  double heartbeat_every_s = 0.1;
  std::string place{};  ///< for people: "node 3 on can0"
};

/// What the drive says of itself.
struct Found {
  double rated_torque_Nm = 0;
  double counts_per_turn = 0;  ///< of the motor's encoder
  double max_torque_Nm = 0;    ///< that the drive gives; infinite: it does not say
};

/// Leaves the drive operational, power stage off. Errors: nobody answers; no torque mode; an object that does not take
/// what it was told.
Result<Found> set_up(Conversation& conversation, const SetUp& wanted);

}  // namespace hapticd::can::cia402
