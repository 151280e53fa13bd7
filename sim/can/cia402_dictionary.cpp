// What a CiA 402 drive has in its dictionary after boot.
#include <algorithm>
#include <cmath>

#include "sim/can/cia402_drive.h"
#include "sim/can/cia402_keys.h"

namespace hapticd::sim::can {

void Cia402Drive::add_objects() {
  objects_ = Cia402Objects(options_.node);
  const std::uint32_t identity[] = {4, options_.vendor, options_.product, options_.revision,
                                    options_.serial};
  objects_.add(object_key(0x1000), {.size = 4, .value = options_.device_type});
  objects_.add(kErrorRegister, {.size = 1, .tpdo = true});
  objects_.add(object_key(0x1005), {.size = 4, .value = kCanopenSync});
  objects_.add(object_key(0x1006), {.size = 4, .writable = true});
  objects_.add(object_key(0x1016), {.size = 1, .value = 1});
  objects_.add(kConsumerHeartbeat, {.size = 4, .writable = true});
  objects_.add(
      kProducerHeartbeat,
      {.size = 2,
       .writable = true,
       .value = static_cast<std::uint32_t>(std::lround(1e3 * options_.heartbeat_every_s))});
  for (std::uint32_t sub = 0; sub <= 4; ++sub)
    objects_.add(object_key(0x1018, sub),
                 {.size = static_cast<std::uint8_t>(sub == 0 ? 1 : 4), .value = identity[sub]});
  add_motion_objects();
}

void Cia402Drive::add_motion_objects() {
  const double most_per_mille = 1e3 * options_.max_torque_Nm / options_.rated_torque_Nm;
  objects_.add(kAbortOption, {.size = 2, .writable = true, .value = 1});
  objects_.add(kErrorCode, {.size = 2, .tpdo = true});
  objects_.add(kControlword, {.size = 2, .writable = true, .rpdo = true});
  objects_.add(kStatusword, {.size = 2, .tpdo = true});
  objects_.add(kMode, {.size = 1, .writable = true, .rpdo = true});
  objects_.add(kModeDisplay, {.size = 1, .tpdo = true});
  objects_.add(kPosition, {.size = 4, .tpdo = true});
  objects_.add(kVelocity, {.size = 4, .tpdo = true});
  objects_.add(kTargetTorque, {.size = 2, .writable = true, .rpdo = true, .tpdo = true});
  objects_.add(kMaxTorque, {.size = 2,
                            .writable = true,
                            .rpdo = true,
                            .value = cia402_whole(std::min(most_per_mille + 0.5, 65535.0))});
  objects_.add(kRatedTorque,
               {.size = 4, .value = cia402_whole(1e3 * options_.rated_torque_Nm + 0.5)});
  objects_.add(kTorque, {.size = 2, .tpdo = true});
  objects_.add(object_key(0x608f), {.size = 1, .value = 2});
  objects_.add(object_key(0x608f, 1),
               {.size = 4, .value = cia402_whole(options_.counts_per_rev + 0.5)});
  objects_.add(object_key(0x608f, 2), {.size = 4, .value = 1});
  objects_.add(object_key(0x60c2), {.size = 1, .value = 2});
  objects_.add(object_key(0x60c2, 1), {.size = 1, .writable = true, .value = 1});
  objects_.add(object_key(0x60c2, 2), {.size = 1, .writable = true, .value = 0xfd});
  objects_.add(object_key(0x6502),
               {.size = 4, .value = 0x5 | (options_.supports_cst ? kCstSupported : 0)});
}

}  // namespace hapticd::sim::can
