#!/usr/bin/env bash
# Run time against error of every choice that rendering has: runs the pareto program, prints its table and draws it.
#
#   tests/bench/pareto.sh [build directory] [output directory]      default: build, .
set -eu
build=${1:-build}
output=${2:-.}
command -v gnuplot > /dev/null || { echo "pareto.sh: needs gnuplot (Debian: gnuplot-nox)" >&2; exit 69; }
"$build/tests/bench/pareto" > "$output/pareto.csv"
column -s, -t < "$output/pareto.csv"
gnuplot << PLOT
set terminal svg size 1000,640 font "sans,11" background "white"
set output "$output/pareto.svg"
set datafile separator ","
set logscale xy
set xlabel "ns per tick"
set ylabel "force error, root mean square [N]"
set key outside right
set grid
floor(x) = x > 1e-12 ? x : 1e-12
plot for [study in "kind sweeps integrator rate mesh"] "$output/pareto.csv" \
  using 3:(strcol(1) eq study ? floor(column(4)) : NaN) with points pointtype 7 title study, \
  "$output/pareto.csv" using 3:(floor(column(4))):2 with labels offset 0.5,0.4 left font ",7" notitle
PLOT
echo "$output/pareto.csv and $output/pareto.svg"
