#!/usr/bin/env bash
# format.sh <source dir> [--fix]: all C++ is as clang-format 14 writes it.
# shellcheck source=common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
need clang-format-14
cd "$1"

sources() { find control drivers sim config daemon systemd tests -name '*.h' -o -name '*.cpp' | sort; }

cp .clang-format "$scratch"
printf 'int  x=1 ;\n' > "$scratch/bad.cpp"
must_fail "bad spacing" clang-format-14 --dry-run --Werror "$scratch/bad.cpp"

[ "$(sources | wc -l)" -gt 20 ] || fail "no sources found"
if [ "${2:-}" = --fix ]; then
  sources | xargs clang-format-14 -i
  exit
fi
{ sources | xargs clang-format-14 --dry-run --Werror 2>&1 || true; } | sed -n 's/^\([^: ]*\):[0-9]*:.*error: .*/\1/p' | sort | uniq -c \
  > "$scratch/lines"
[ ! -s "$scratch/lines" ] || { cat "$scratch/lines" && fail "places in these files; run: bash tests/lint/format.sh . --fix"; }
