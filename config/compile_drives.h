// What compile_buses() needs of one device of CAN drives.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "config/compilation.h"

namespace hapticd::config {

/// What its driver is told, but for the times that depend on the bus; nothing: another driver, or refused keys.
std::optional<can::DeviceOptions> compile_drives(Compilation& compilation,
                                                 const DevicePlace& place);

/// The timing that a protocol has where the config names none.
drivers::Timing own_timing(can::Protocol protocol);
std::string word_of_timing(drivers::Timing timing);

/// Then the loop waits, for all devices.
bool any_in_phase(const std::vector<std::optional<can::DeviceOptions>>& devices);

}  // namespace hapticd::config
