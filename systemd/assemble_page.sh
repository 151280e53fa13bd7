#!/bin/sh
# Puts what the code knows into the source of hapticd(8): the tables of faults and limits, the number of flight files.
#   assemble_page.sh <template> <fault_tables program> <telemetry.h> <examples dir> <output>
set -eu
template=$1 tables=$2 telemetry=$3 examples=$4 output=$5
max=$(sed -n 's/.*kMaxFlightFiles = \([0-9]*\);.*/\1/p' "$telemetry")
[ -n "$max" ] || { echo "$telemetry: kMaxFlightFiles not found" >&2; exit 1; }
while IFS= read -r line; do
  case $line in
    @faults@ | @limits@)
      what=${line#@}
      "$tables" "${what%@}"
      ;;
    *) printf '%s\n' "$line" | sed -e "s|@max_flight_files@|$max|" -e "s|@examples@|$examples|" ;;
  esac
done < "$template" > "$output.tmp"
mv "$output.tmp" "$output"
