#!/usr/bin/env bash
# Installs what is missing, builds and runs the tests. Without options: the Release build of GCC in build/ (the same as
# daemon/quickstart.sh's) and all tests but the long ones. Each option adds a suite with a build of its own below build/.
# shellcheck disable=SC2317  # the suites are called by name
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=daemon/packages.sh
. daemon/packages.sh

usage() {
  cat << 'END'
usage: tests/run.sh [--clang] [--asan] [--asan-all] [--tsan] [--rtsan] [--long] [--bench] [--vm] [--fuzz]
  --clang   build with clang 14, benchmarks too, warnings are errors; unit tests
  --asan    clang 14, AddressSanitizer and UndefinedBehaviorSanitizer, all tests but lint, service and those of
            control/design: numerics that touch memory through Eigen alone
  --asan-all  with those, which takes half as long again
  --tsan    ThreadSanitizer, the tests of threads and what they share
  --rtsan   RealtimeSanitizer (clang 22), the tests of the loop
  --long    the tests that take long
  --bench   the benchmarks, printed, not judged
  --vm      tests in a virtual machine         (no suite yet: arrives with the CAN drivers)
  --fuzz    coverage-guided fuzzing of parsers (no suite yet: arrives with the drivers' codecs)
END
}

suites=(default)
for option in "$@"; do
  case $option in
    --clang | --asan | --asan-all | --tsan | --rtsan | --long | --bench | --vm | --fuzz) suites+=("${option#--}") ;;
    --help) usage && exit 0 ;;
    *) echo "tests/run.sh: unknown option $option" >&2 && usage >&2 && exit 64 ;;
  esac
done

jobs=$(nproc)
werror=OFF
[ "${CI:-}" = true ] && werror=ON

# In CI a suite or a test that cannot run is a failure: it must not vanish unnoticed.
skip() {
  echo "SKIPPED: $*" | tee -a build/ctest.log
  [ "${CI:-}" != true ]
}

# Sanitizers of this age cannot start where the kernel spreads addresses very wide; where that is allowed, setarch turns
# it off for a suite.
run_in=()
fix_addresses() { if setarch -R true 2> /dev/null; then run_in=(setarch -R); fi; }

# build_in <directory> <compiler, or ""> <targets, or all> <cmake option>...
build_in() {
  local directory=$1 compiler=$2 targets=$3
  shift 3
  # CXX counts for a new directory only, as it should: another compiler would want a new one.
  CXX=${compiler:-${CXX:-c++}} cmake -S . -B "$directory" -G Ninja -DHAPTICD_BUILD_TESTS=ON "$@" > build/cmake.log 2>&1 \
    || { cat build/cmake.log && return 1; }
  # shellcheck disable=SC2086  # a list of targets
  "${run_in[@]}" cmake --build "$directory" --parallel "$jobs" --target $targets
}

run_ctest() {
  "${run_in[@]}" ctest --output-on-failure --no-tests=error -j2 "$@" | tee -a build/ctest.log
}

# Debug information and light optimisation: what sanitizers need to be readable and quick to build.
sanitized=(-DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1")

suite_default() {
  install_packages "${packages_build[@]}" "${packages_tests[@]}"
  build_in build '' all -DCMAKE_BUILD_TYPE=Release -DHAPTICD_WERROR="$werror"
  run_ctest --test-dir build -LE long
}
suite_clang() {
  install_packages "${packages_clang[@]}" "${packages_bench[@]}"
  build_in build/clang clang++-14 all -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O1 -DHAPTICD_WERROR=ON -DHAPTICD_BUILD_BENCH=ON
  run_ctest --test-dir build/clang -LE 'long|process|lint|service'
}
# By clang, with warnings as errors: so it is the second compiler's word too, without a build of its own.
suite_asan() {
  install_packages "${packages_clang[@]}"
  fix_addresses
  build_in build/asan clang++-14 all "${sanitized[@]}" -DHAPTICD_SANITIZE=address,undefined -DHAPTICD_WERROR=ON \
    -DHAPTICD_TEST_NUMERICS="${1:-OFF}"
  run_ctest --test-dir build/asan -LE 'long|lint|service'
}
suite_asan-all() { suite_asan ON; }
suite_tsan() {
  fix_addresses
  build_in build/tsan g++ 'test_rt test_servo' "${sanitized[@]}" -DHAPTICD_SANITIZE=thread
  run_ctest --test-dir build/tsan -L threads
}
suite_rtsan() {
  if ! command -v clang++-22 > /dev/null; then
    install_packages "${packages_rtsan[@]}" || true
  fi
  command -v clang++-22 > /dev/null || { skip "--rtsan: clang 22 cannot be had from this machine's archive"; return; }
  bash tests/lint/rtsan_can_fail.sh clang++-22
  build_in build/rtsan clang++-22 test_closed_loop "${sanitized[@]}" -DHAPTICD_SANITIZE=realtime
  run_ctest --test-dir build/rtsan -L rtsan
}
suite_long() {
  run_ctest --test-dir build -L long
}
suite_bench() {
  install_packages "${packages_bench[@]}"
  build_in build/bench '' 'bench_tick bench_scene bench_mesh' -DCMAKE_BUILD_TYPE=Release -DHAPTICD_BUILD_BENCH=ON
  find build/bench -name 'bench_*' -type f -perm -u+x -exec {} \;
}
suite_vm() { skip "--vm: no VM suite yet: arrives with the CAN drivers"; }
suite_fuzz() { skip "--fuzz: no fuzz suite yet: arrives with the drivers' codecs"; }

mkdir -p build
results=()
worst=0
for suite in "${suites[@]}"; do
  started=$SECONDS
  printf '== %s\n' "$suite"
  : > build/ctest.log
  # A subshell of its own: `set -e` holds inside, and one suite's failure does not keep the next from running.
  set +e
  (set -e && "suite_$suite" < /dev/null)
  code=$?
  set -e
  verdict=$(grep -hE 'tests passed|SKIPPED' build/ctest.log | paste -sd ';' || true)
  [ "$code" -eq 0 ] || { worst=1 && verdict="FAILED (exit $code) $verdict"; }
  results+=("$(printf '%-8s %5d s  %s' "$suite" $((SECONDS - started)) "${verdict:-done}")")
done
printf '\n%s' "Summary" && printf '\n%s' "${results[@]}" && printf '\n'
exit "$worst"
