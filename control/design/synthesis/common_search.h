// Finds the P of check/common_lyapunov.h by semidefinite programs: in coordinates in which one loop of
// the box contracts,
//
//   minimise trace P subject to  P - A_i' P A_i >= I
//
// over vertices of the box (whatever has a P has one of some size), and over whatever loop the check
// then shows P to fail for. For devices and hands that do not change: one P for the vertices of each
// cell in which the check has none, as far as there is one. The check has the last word.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "control/design/check/common_lyapunov.h"

namespace hapticd::synthesis {

using check::Matrix;

struct CommonAnswer {
  std::vector<Matrix> P;  ///< accepted by the check; empty: none found
  std::string why;
  check::CommonVerdict verdict;  ///< of the last
};
/// One P, whatever changes from tick to tick.
CommonAnswer find_common(const check::SampledLoop& loop, const check::LoopBox& box);
/// A list of P for devices and hands that do not change, at most `most`.
CommonAnswer find_constant(const check::SampledLoop& loop, const check::LoopBox& box,
                           std::size_t most = 60);

}  // namespace hapticd::synthesis
