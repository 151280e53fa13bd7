// What the stages of one tick found out, gathered for the guard and the record.
#pragma once
#include <cstdint>

#include "control/core/fault.h"

namespace hapticd::control {

struct Findings {
  LimitFlags limits;
  FaultReport fault;    ///< the first of this tick
  bool ready = true;    ///< every axis gave a sample
  bool homed = true;    ///< every axis is homed
  bool enable = false;  ///< forces are wanted and every enable input agrees (decide_mode)
  bool search = false;  ///< an axis that is not homed can be driven to its reference

  /// Keeps the first fault: what follows in the same tick is usually its consequence.
  void report(const FaultReport& found) noexcept {
    if (fault.code == Fault::none) fault = found;
  }
};

}  // namespace hapticd::control
