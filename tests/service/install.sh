#!/usr/bin/env bash
# install.sh <build dir>: `cmake --install` puts exactly the listed files into a staging directory.
# shellcheck source=../lint/common.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lint/common.sh"
build=$1
list=$(dirname "${BASH_SOURCE[0]}")/installed_files.txt

compare() { diff "$scratch/wanted" "$1"; }

grep -v '^#' "$list" | sort > "$scratch/wanted"
cmake --install "$build" --prefix "$scratch/stage" > "$scratch/log" || { cat "$scratch/log" && fail "cmake --install"; }
(cd "$scratch/stage" && find . -type f -printf '%P\n' | sort) > "$scratch/got"
compare "$scratch/got" || fail "installed files: < is missing, > is not in installed_files.txt"
grep -v '^bin/hapticd$' "$scratch/got" > "$scratch/less"
must_fail "a program that is not installed" compare "$scratch/less"
"$scratch/stage/bin/hapticd" --version > /dev/null || fail "the installed hapticd does not start"
for example in "$scratch/stage"/share/hapticd/examples/*.yaml; do
  cmp -s "$example" "$(dirname "$list")/../../config/examples/$(basename "$example")" || fail "$example differs"
done
