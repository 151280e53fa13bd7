// The period that most tests tick with.
#pragma once

namespace hapticd::test {

inline constexpr double kPeriod_s = 1e-3;

}  // namespace hapticd::test
