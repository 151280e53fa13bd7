#!/usr/bin/env bash
# includes.sh <source dir>: every #include stands by the table of who may include whom.
# shellcheck source=common.sh
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source_dir=$1
rules=$(realpath "$(dirname "${BASH_SOURCE[0]}")")

# check <tree>
check() {
  local tree=$1 folder folders=()
  for folder in control drivers sim config daemon systemd; do [ -d "$tree/$folder" ] && folders+=("$folder"); done
  (cd "$tree" && grep -rn --include='*.h' --include='*.cpp' '^ *# *include' "${folders[@]}") > "$scratch/lines"
  awk -v rules="$rules/includes.rules" -f "$rules/check_includes.awk" "$rules/includes.rules" "$scratch/lines"
}

# forbidden <file> <header>...: a tree with nothing but these includes, which is to be refused.
forbidden() {
  local file=$1 header
  rm -rf "$scratch/tree" && mkdir -p "$scratch/tree/$(dirname "$file")"
  shift
  for header in "$@"; do echo "#include $header" >> "$scratch/tree/$file"; done
  must_fail "$file includes $*" check "$scratch/tree"
}

forbidden control/step.cpp '"daemon/cycle.h"'
forbidden control/step.cpp '"control/build/program.h"'
forbidden control/step.cpp '"control/core/result.h"'
forbidden control/scene/render.h '<chrono>'
forbidden control/guard/guard.cpp '<mutex>'
forbidden control/record.cpp '<unistd.h>'
forbidden control/design/check/stability.cpp '"control/design/synthesis/lmi.h"'
forbidden drivers/can/bus.cpp '"control/step.h"'
forbidden drivers/can/bus.cpp '<spdlog/spdlog.h>'
forbidden sim/plant.cpp '"drivers/can/codec.h"'
forbidden sim/plant.cpp '"config/schema.h"'
forbidden config/read.cpp '"daemon/log.h"'
forbidden config/read.cpp '<spdlog/spdlog.h>'
forbidden daemon/engine.cpp '"control/design/synthesis/lmi.h"'
forbidden daemon/engine.cpp '<yaml-cpp/yaml.h>'

mkdir -p "$scratch/two/config"
echo '#include <yaml-cpp/parser.h>' | tee "$scratch/two/config/a.cpp" > "$scratch/two/config/b.cpp"
must_fail "two files with yaml-cpp" check "$scratch/two"

check "$source_dir" || fail "includes against the table"
