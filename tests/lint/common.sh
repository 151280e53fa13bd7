# shellcheck shell=bash
# For the checks below tests/lint and tests/service.
set -euo pipefail

# skip <why>: aloud on a desktop; in CI a check that cannot run has failed.
skip() {
  echo "SKIPPED: $*"
  [ "${CI:-}" = true ] && exit 1
  exit 77
}

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# must_fail <what> <command>...: a check that cannot fail is a defect, so each one is shown something bad.
must_fail() {
  local what=$1
  shift
  if ("$@") > /dev/null 2>&1; then fail "the check did not notice: $what"; fi
}

need() {
  command -v "$1" > /dev/null || skip "$1 is not installed"
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
