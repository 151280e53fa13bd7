#!/usr/bin/env bash
# symbols.sh <archive of the loop> <compiler>: a Release build of the loop imports nothing that allocates, throws, locks,
# prints or makes a system call.
# shellcheck source=common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
archive=$1 compiler=$2
grep -v '^#' "$(dirname "${BASH_SOURCE[0]}")/symbols.allowed" > "$scratch/allowed"

# check <archive or object>: prints what is imported and not allowed.
check() {
  nm --undefined-only --format=posix "$1" 2> /dev/null | awk 'NF >= 2 { print $1 }' | sort -u > "$scratch/imported"
  nm --defined-only --format=posix "$1" 2> /dev/null | awk 'NF >= 2 { print $1 }' | sort -u > "$scratch/defined"
  [ -s "$scratch/defined" ] || { echo "$1: defines nothing"; return 1; }
  ! comm -23 "$scratch/imported" "$scratch/defined" | grep -vxE -f "$scratch/allowed" | c++filt
}

# forbidden <declarations> <statement>: an object with this in it, which is to be refused.
forbidden() {
  printf '%s\ndouble* sink;\nvoid tick(double* x) noexcept { %s; sink = x; }\n' "$1" "$2" > "$scratch/bad.cpp"
  "$compiler" -std=c++20 -O2 -c "$scratch/bad.cpp" -o "$scratch/bad.o" || fail "fixture does not compile: $2"
  must_fail "$2" check "$scratch/bad.o"
}

forbidden '#include <cstdlib>' 'x = static_cast<double*>(std::malloc(8))'
forbidden '#include <new>' 'x = new double(*x)'
forbidden '#include <vector>' 'static std::vector<double> v; v.push_back(*x)'
forbidden '#include <stdexcept>' 'try { if (x == nullptr) throw 1; } catch (...) { *x = 0; }'
forbidden '#include <mutex>' 'static std::mutex m; m.lock()'
forbidden '#include <pthread.h>' 'static pthread_cond_t c; pthread_cond_signal(&c)'
forbidden '#include <cstdio>' 'std::printf("%f", *x)'
forbidden '#include <unistd.h>' 'x[0] = static_cast<double>(write(1, "", 1))'
forbidden '#include <time.h>' 'timespec t; clock_gettime(CLOCK_MONOTONIC, &t); *x = static_cast<double>(t.tv_sec)'

echo 'double half(double x) noexcept { return 0.5 * x; }' > "$scratch/good.cpp"
"$compiler" -std=c++20 -O2 -c "$scratch/good.cpp" -o "$scratch/good.o"
check "$scratch/good.o" || fail "an object without imports was refused"

check "$archive" || fail "$archive imports what the loop may not call"
