#!/usr/bin/env bash
# top_level.sh <source dir>: the top level holds what it is meant to hold.
# shellcheck source=common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$1"

# stray: entries on stdin that do not belong there.
stray() {
  grep -vxE '\..*|CMakeLists\.txt|README\.md|LICENSE|daemon|drivers|control|config|sim|tests|systemd'
}
entries() {
  if [ -e .git ] && command -v git > /dev/null; then
    git -c safe.directory="$PWD" ls-files | cut -d/ -f1 | sort -u
  else
    find . -mindepth 1 -maxdepth 1 -not -name 'build*' -printf '%f\n'
  fi
}
echo notes.txt | stray > /dev/null || fail "the check did not notice notes.txt"
entries | grep -qx daemon || fail "no entries found"
entries | stray && fail "stray entries at the top level"
exit 0
