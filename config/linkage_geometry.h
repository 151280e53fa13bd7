// Geometry of a device in the loop's terms; linkage index, gravity and the like are left at their
// defaults. Plan and simulation are made from the same figures.
#pragma once
#include "config/schema_device.h"
#include "control/kinematics/kinematics.h"

namespace hapticd::config {

control::LinearMap linear_map(const Cartesian& cartesian);
control::FiveBar five_bar(const FiveBar& bars);
control::Delta delta(const Delta& legs);
control::Serial serial(const Serial& chain);

bool has_mass(const Serial& chain);

}  // namespace hapticd::config
