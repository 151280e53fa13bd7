#!/usr/bin/env bash
# From a fresh Debian 12 to a rendered wall: installs what is missing, builds Release into build/, runs hapticd for ten
# seconds against a simulated hand and ends with its summary. Run again, it does only what is left to do.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=daemon/packages.sh
. daemon/packages.sh

readonly log=build/quickstart.log
step=start

failed() {
  local code=$?
  [ "$code" -eq 0 ] && return
  printf '\n'
  [ "$step" = run ] || tail -n 40 "$log" >&2 || true
  echo "quickstart: step '$step' failed with exit code $code; the full output is in $log" >&2
}
trap failed EXIT

# quiet <step> <what it does> <command>...: one line, with the time that it took.
quiet() {
  step=$1
  local started=$SECONDS
  printf '%-10s %-64s ' "$step" "$2"
  shift 2
  "$@" >> "$log" 2>&1
  printf '%4d s\n' $((SECONDS - started))
}

configure() {
  cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release
}
build() {
  cmake --build build --target hapticd hapticctl --parallel "$(nproc)"
}

mkdir -p build
: > "$log"
if command -v dpkg-query > /dev/null; then
  mapfile -t missing < <(missing_packages "${packages_build[@]}")
else
  missing=("${packages_build[@]}")
fi
if [ "${#missing[@]}" -eq 0 ]; then
  quiet packages "all there" true
else
  quiet packages "apt-get install of ${#missing[@]} packages" install_packages "${missing[@]}"
fi
quiet configure "cmake, Release, into build/" configure
quiet build "hapticd and hapticctl" build
step=run
echo "run        hapticd --config config/examples/wall.yaml for 10 s"
build/daemon/hapticd --config config/examples/wall.yaml --duration 10 --socket build/hapticd.sock < /dev/null
