// What a tick did to the position of an axis.
#pragma once
#include <cstdint>

namespace hapticd::control {

enum class Motion : std::uint8_t {
  advanced,  ///< by one period: differences may be taken
  held,      ///< no fresh sample: the last position stands
  reseeded,  ///< first sample, missed ticks or samples, a new reference: no difference is taken
};

}  // namespace hapticd::control
