// A drive as the loop speaks to it, through ticks that the input makes up: frames of an emulated
// drive, frames of nobody, lost ones, failures, arming and disarming at any time.
#pragma once
#include <optional>

#include "drivers/can/drive.h"
#include "sim/can/drive.h"
#include "tests/fuzz/input.h"

namespace hapticd::fuzz {

/// What differs between the protocols.
class Wire {
 public:
  virtual ~Wire() = default;
  /// Gives a frame an id of the node.
  virtual void own(can::Frame& frame, std::uint32_t number) const = 0;
  /// Torque that a frame carries to the drive [N m]; nothing: it is no such frame.
  virtual std::optional<double> torque_of(const can::Frame& frame) const = 0;
  /// What `wanted` may differ from what is sent.
  virtual double tolerance_Nm(double wanted) const = 0;
};

struct Session {
  Input& input;
  can::Drive& drive;
  sim::can::Drive& servo;
  const Wire& wire;
  const can::DeviceOptions& device;
};
/// Connects and runs until the input ends.
void run(const Session& session);

}  // namespace hapticd::fuzz
