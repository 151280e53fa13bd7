// Where each array stands in a record; the header comes first (control/record.h).
#pragma once
#include <cstdint>

namespace hapticd::control {

/// `count` values of one kind from `offset` on. Count 0: the plan has nothing of the kind.
struct RecordArray {
  std::uint32_t offset = 0;
  std::uint32_t count = 0;
  bool operator==(const RecordArray&) const = default;
};

struct RecordLayout {
  RecordArray raw, age_ns, delivered;  ///< per axis, from the input
  // From here to `fade` one block, as in State::recorded; control/recorded.h says what each is.
  RecordArray q, qd, gravity, friction, observer, residual, travel, effort;  ///< per axis
  RecordArray x, hand_force, proxy, scene_force, observer_force, contact_residual, limited,
      force;                                                     ///< per coordinate
  RecordArray solve_error, injected, work, reserve, gain, fade;  ///< per device
  RecordArray aux;                                               ///< per device
  RecordArray drive_faults,
      drive_limits;              ///< per axis, as its drive reports them: 4 and 2 bytes each
  RecordArray freshness, homed;  ///< per axis, one byte each
  std::uint32_t bytes = 0;       ///< of a whole record, a multiple of 8
  bool operator==(const RecordLayout&) const = default;
};

}  // namespace hapticd::control
