#!/usr/bin/env bash
# man.sh <man dir> <fault_tables> <hapticd> <hapticctl>: the pages tell of every fault and limit, every verb and every
# option that the programs have, and of no option that they have not.
# shellcheck source=common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
man_dir=$1 fault_tables=$2 hapticd=$3 hapticctl=$4

# Roff without its marks for bold and italics, and without what scdoc puts around dots.
plain() {
  sed -e 's/\\f[BIRP]//g' -e 's/\\-/-/g' -e 's/\\&//g' "$1" > "$2"
}
plain "$man_dir/man8/hapticd.8" "$scratch/hapticd"
plain "$man_dir/man1/hapticctl.1" "$scratch/hapticctl"

names() { "$fault_tables" "$1" | sed -n 's/^\*\([a-z_]*\)\*$/\1/p'; }
long_options() { grep -oE -- '--[a-z][a-z-]+' "$1" | sort -u; }
verbs() { "$hapticctl" --help | sed -n '/^Subcommands:/,$p' | sed -n 's/^  \([a-z][a-z]*\) .*/\1/p'; }

# has_lines <page> <words>: each word begins a line of the page.
has_lines() {
  local page=$1 word
  while read -r word; do
    grep -qE -- "^$word( |\$)" "$page" || { echo "$(basename "$page"): nothing about $word" && return 1; }
  done
}

"$hapticd" --help > "$scratch/help"
verbs > "$scratch/verbs"
{
  "$hapticctl" --help
  while read -r verb; do "$hapticctl" "$verb" --help; done < "$scratch/verbs"
} > "$scratch/ctl_help"

{ names faults && names limits; } > "$scratch/table"
[ "$(wc -l < "$scratch/table")" -ge 20 ] || fail "fault_tables printed $(wc -l < "$scratch/table") names"
[ "$(wc -l < "$scratch/verbs")" -ge 8 ] || fail "hapticctl --help lists $(wc -l < "$scratch/verbs") verbs"

has_lines "$scratch/hapticd" < "$scratch/table" || fail "faults and limits"
has_lines "$scratch/hapticctl" < "$scratch/verbs" || fail "verbs"
for page in hapticd:help hapticctl:ctl_help; do
  long_options "$scratch/${page#*:}" > "$scratch/have"
  sed -n '/^\.SH SYNOPSIS/,$p' "$scratch/${page%:*}" > "$scratch/page"
  long_options "$scratch/page" > "$scratch/told"
  comm -23 "$scratch/have" "$scratch/told" | grep . && fail "the page of ${page%:*} does not have these options"
  [ "${page%:*}" = hapticctl ] || continue
  comm -13 "$scratch/have" "$scratch/told" | grep -vxE -- '--(config)' | grep . && fail "hapticctl has no such option"
done

must_fail "a fault without an entry" has_lines "$scratch/hapticd" <<< no_such_fault
must_fail "a verb without an entry" has_lines "$scratch/hapticctl" <<< levitate
