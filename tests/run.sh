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
  --vm      a PREEMPT_RT kernel in QEMU: SocketCAN, a real CAN driver, USB, certified walls, the loop's punctuality
  --fuzz    coverage-guided fuzzing (clang 14): 10^5 inputs a CAN codec, 10^4 a drive and the socket; a hundred times
            that with --long
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
  build_in build/bench '' 'bench_tick bench_scene bench_mesh bench_can' -DCMAKE_BUILD_TYPE=Release -DHAPTICD_BUILD_BENCH=ON
  find build/bench -name 'bench_*' -type f -perm -u+x -exec {} \;
}
suite_vm() {
  install_packages "${packages_vm[@]}" || true # run.sh names what is still missing
  build_in build '' 'hapticd hapticctl can_kernel_test falcon_line' -DCMAKE_BUILD_TYPE=Release -DHAPTICD_WERROR="$werror"
  local code=0
  tests/vm/run.sh build/tests/can_kernel_test | tee -a build/ctest.log || code=$?
  case $code in
    69 | 77) skip "--vm: cannot run here (exit $code)" ;;
    *) return "$code" ;;
  esac
}

# fuzz_one <target> <inputs>: prints how many ran and how fast; a crash prints its report and the file of the input.
fuzz_one() {
  local target=$1 runs=$2 found=build/fuzz/found/$1 log=build/fuzz/$1.log artifact
  rm -rf "$found" && mkdir -p "$found"
  if ! "${run_in[@]}" "build/fuzz/tests/fuzz/$target" -runs="$runs" -seed=1 -max_len=128 -timeout=10 \
    -print_final_stats=0 -artifact_prefix=build/fuzz/ "$found" "build/fuzz/corpus/fuzz_${target%_*}" > "$log" 2>&1; then
    artifact=$(sed -n 's/.*Test unit written to //p' "$log" | tail -n 1)
    grep -v '^#[0-9]*[[:space:]]*[A-Zp]' "$log" | tail -n 40
    echo "$target: FAILED; again with: build/fuzz/tests/fuzz/$target ${artifact:-(no input was kept)}"
    return 1
  fi
  sed -n "s/^Done \([0-9]*\) runs in \([0-9]*\) second.*/\1 \2/p" "$log" \
    | awk -v target="$target" '{ printf "%-23s %9d inputs %6d s %8d a second\n", target, $1, $2, $1 / ($2 > 0 ? $2 : 1) }'
}
suite_fuzz() {
  local target runs started pids=() failed=0 part=100
  local targets=(odrive_codec moteus_codec cia402_codec odrive_drive moteus_drive cia402_drive socket
    falcon_codec report_map_codec report_descriptor_codec openffboard_codec openffboard_drive usbip)
  case " ${suites[*]} " in *" long "*) part=1 ;; esac
  install_packages "${packages_build[@]}" "${packages_clang[@]}"
  fix_addresses
  build_in build/fuzz clang++-14 fuzz -DCMAKE_BUILD_TYPE=Debug -DHAPTICD_BUILD_TESTS=OFF -DHAPTICD_BUILD_FUZZ=ON \
    -DHAPTICD_WERROR=ON
  rm -f build/fuzz/{crash,leak,timeout,oom}-*
  started=$SECONDS
  for target in "${targets[@]}"; do
    # As many at a time as there are processors.
    [ "${#pids[@]}" -lt "$jobs" ] || { wait "${pids[0]}" || failed=1 && pids=("${pids[@]:1}"); }
    case $target in
      *_codec) runs=$((10000000 / part)) ;;
      *) runs=$((1000000 / part)) ;;
    esac
    fuzz_one "$target" "$runs" &
    pids+=($!)
  done
  for target in "${pids[@]}"; do wait "$target" || failed=1; done
  echo "fuzz: $((SECONDS - started)) s"
  return "$failed"
}

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
  verdict=$(grep -hE 'tests passed|SKIPPED|^vm: ' build/ctest.log | paste -sd ';' || true)
  [ "$code" -eq 0 ] || { worst=1 && verdict="FAILED (exit $code) $verdict"; }
  results+=("$(printf '%-8s %5d s  %s' "$suite" $((SECONDS - started)) "${verdict:-done}")")
done
printf '\n%s' "Summary" && printf '\n%s' "${results[@]}" && printf '\n'
exit "$worst"
