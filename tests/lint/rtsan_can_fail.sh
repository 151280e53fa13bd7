#!/usr/bin/env bash
# rtsan_can_fail.sh <clang++>: RealtimeSanitizer stops a function that is marked as the tick is and allocates.
# shellcheck source=common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
compiler=$1
include=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../..")
cat > "$scratch/tick.cpp" << 'END'
#include "control/core/realtime.h"

#include <cstdlib>
void* volatile sink;
void tick(bool allocate) noexcept HAPTICD_NONBLOCKING {
  if (allocate) sink = std::malloc(8);
}
int main(int argc, char**) { tick(argc > 1); }
END
"$compiler" -std=c++20 -fsanitize=realtime -I"$include" "$scratch/tick.cpp" -o "$scratch/tick" || fail "does not build"
"$scratch/tick" || fail "a tick that does nothing was stopped"
must_fail "malloc in the tick" "$scratch/tick" allocate
