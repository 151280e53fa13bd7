#!/usr/bin/env bash
# examples.sh <source dir> <hapticctl>: every example loads, and check says of each what examples.expected says.
# shellcheck source=common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source_dir=$1 hapticctl=$2
expected=$(dirname "${BASH_SOURCE[0]}")/examples.expected

# check <example>
check() {
  local wanted code=0
  wanted=$(awk -v file="$(basename "$1")" '$1 == file { print $2 }' "$expected")
  "$hapticctl" check "$1" > "$scratch/out" 2>&1 || code=$?
  [ "$code" -eq "${wanted:-0}" ] || { echo "$1: exit code $code instead of ${wanted:-0}" && cat "$scratch/out" && return 1; }
}

printf 'version: 1\nlop: {}\n' > "$scratch/misspelt.yaml"
must_fail "a misspelt key" check "$scratch/misspelt.yaml"

count=0
for example in "$source_dir"/config/examples/*.yaml; do
  check "$example" || fail "$example"
  count=$((count + 1))
done
while read -r file _; do
  [ -e "$source_dir/config/examples/$file" ] || fail "examples.expected names $file, which is not there"
done < <(grep -v '^#' "$expected" || true)
[ "$count" -ge 3 ] || fail "only $count examples found"
echo "$count examples"
