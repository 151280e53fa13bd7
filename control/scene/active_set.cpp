#include "control/scene/active_set.h"

#include <cmath>

namespace hapticd::control {

// Cholesky: give = L L', L in place of give; then L L' change = miss.
bool ActiveSet::solve() noexcept {
  constexpr double kLeastPivot = 1e-12;  // of the diagonal: below it two normals are the same
  auto& l = give;
  for (std::size_t j = 0; j < count; ++j) {
    const double diagonal = l[j][j];
    for (std::size_t k = 0; k < j; ++k) l[j][j] -= l[j][k] * l[j][k];
    if (!(l[j][j] > kLeastPivot * diagonal)) return false;
    l[j][j] = std::sqrt(l[j][j]);
    for (std::size_t i = j + 1; i < count; ++i) {
      for (std::size_t k = 0; k < j; ++k) l[i][j] -= l[i][k] * l[j][k];
      l[i][j] /= l[j][j];
    }
  }
  std::array<double, kMaxActive> change = miss;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < i; ++k) change[i] -= l[i][k] * change[k];
    change[i] /= l[i][i];
  }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t k = i + 1; k < count; ++k) change[i] -= l[k][i] * change[k];
    change[i] /= l[i][i];
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!(force[i] + change[i] >= 0)) return false;
  }
  for (std::size_t i = 0; i < count; ++i) force[i] += change[i];
  return true;
}

}  // namespace hapticd::control
