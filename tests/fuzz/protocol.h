// What each protocol's file has for the two targets made of it.
#pragma once
#include "tests/fuzz/input.h"

namespace hapticd::fuzz {

/// One frame, decoded or encoded.
void codec(Input& input);
/// Many ticks of a drive.
void drive(Input& input);

}  // namespace hapticd::fuzz
