#!/usr/bin/env bash
# Another project finds the installed library and runs an own axis with an own reference and an own law.
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/installing.sh"

for component in estimator library; do install_component "$component"; done
cmake -G Ninja -S "$source_dir/tests/package/axis" -B "$work/axis" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$prefix" >"$work/configure.log" 2>&1 || fail "configure: $(cat "$work/configure.log")"
cmake --build "$work/axis" >"$work/build.log" 2>&1 || fail "build: $(cat "$work/build.log")"
! grep -rq "$source_dir" "$prefix/lib/cmake" || fail "the package names the source folder"

# The swing takes 50 mm; a law that does not close its loop, or a plant that does not move, is off by as much.
said=$("$work/axis/own_axis" "$source_dir/config/cylinder-2m-6.10mm.yaml") || fail "own_axis ended with status $?"
echo "$said"
awk -v a="${said%% *}" 'BEGIN { exit !(a > 0 && a < 10) }' || fail "expected less than 10 mm"
lines=$(grep -vc '^$' "$source_dir/tests/package/axis/axis.cpp")
((lines <= 65)) || fail "the example has $lines lines"
