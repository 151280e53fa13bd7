// Newton step on the normal forces of all bodies that are touched without friction: where sweeps
// have found out which they are, it makes their laws (rest_i - n_i.y) / yields_i = f_i true at once.
#pragma once
#include <array>
#include <cstddef>

#include "control/core/vec3.h"

namespace hapticd::control {

inline constexpr std::size_t kMaxActive = 12;  ///< more bodies at once are left to the sweeps

struct ActiveSet {
  std::size_t count = 0;
  std::array<double, kMaxActive> force{};  ///< N, >= 0; changed by solve()
  std::array<double, kMaxActive> miss{};   ///< m: rest - n.y - yields * force
  /// m/N, lower triangle: n_i' give n_j, plus yields_i on the diagonal.
  std::array<std::array<double, kMaxActive>, kMaxActive> give{};

  /// False, and nothing changed, where two bodies say the same or one of them would have to pull.
  bool solve() noexcept;
};

}  // namespace hapticd::control
