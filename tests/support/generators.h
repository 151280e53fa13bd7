// Random numbers for property tests.
#pragma once
#include <rapidcheck.h>

namespace hapticd::test {

/// Any number of [low, high), to a thousandth of the range. Only within a property.
inline double any_number(double low, double high) {
  return low + (high - low) * 1e-3 * *rc::gen::inRange(0, 1000);
}

}  // namespace hapticd::test
