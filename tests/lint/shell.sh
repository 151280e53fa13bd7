#!/usr/bin/env bash
# shell.sh <source dir>: shellcheck has nothing to say about any script.
# shellcheck source=common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
need shellcheck
cd "$1"
# shellcheck disable=SC2016  # it is the fixture that is not to expand
printf '#!/bin/sh\nrm $1\n' > "$scratch/bad.sh"
must_fail "an unquoted variable" shellcheck "$scratch/bad.sh"
find daemon tests systemd .ci -name '*.sh' -o -path .ci/run | sort | xargs shellcheck -x -P SCRIPTDIR -P . || fail "shellcheck"
