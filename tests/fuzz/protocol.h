// What each protocol's file has for the two targets made of it.
#pragma once
#include "tests/fuzz/input.h"

namespace hapticd::fuzz {

/// A frame is decoded.
void decode(Input& input);
/// Frames are encoded.
void encode(Input& input);
/// Many ticks of a drive.
void session(Input& input);

}  // namespace hapticd::fuzz
