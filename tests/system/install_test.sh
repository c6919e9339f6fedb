#!/usr/bin/env bash
# Another project finds the installed package, compiles against it with Eigen alone, and gets a right chamber pressure.
# tags: long
set -euo pipefail
source "$(dirname -- "${BASH_SOURCE[0]}")/installing.sh"
compiler=${CXX:-g++}

install_component estimator
[[ -f $prefix/include/pneuservo/estimator/pipeline_estimator.hpp ]] || fail "the estimator's header is not installed"
for folder in "$prefix"/include/pneuservo/*; do
  case ${folder##*/} in
    core | elements | estimator) ;;
    *) fail "${folder##*/} is installed without its library" ;;
  esac
done

# The consumer's own build.
cmake -G Ninja -S "$source_dir/tests/package/consumer" -B "$work/consumer" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$prefix" >"$work/configure.log" 2>&1 || fail "configure: $(cat "$work/configure.log")"
cmake --build "$work/consumer" >"$work/build.log" 2>&1 || fail "build: $(cat "$work/build.log")"
mapfile -t seen < <(grep '"command"' "$work/consumer/compile_commands.json" | grep -oE '(-I|-isystem) *[^ "]+' |
  sed -E 's/^(-I|-isystem) *//' | sort -u)
eigen=
for directory in "${seen[@]}"; do
  case $directory in
    "$prefix/include") ;;
    *eigen3*) eigen=$directory ;;
    *) fail "the consumer sees the include directory $directory" ;;
  esac
done
((${#seen[@]} == 2)) || fail "expected the installed include directory and Eigen's, found: ${seen[*]}"

# Ports at rest: the chambers come to the ports' pressures (10 m line, 9 s; no flow, no loss).
pressures=$("$work/consumer/consumer") || fail "the consumer ended with status $?"
read -r pressure_1 pressure_2 <<<"$pressures"
echo "chamber pressures ${pressure_1} Pa, ${pressure_2} Pa"
awk -v a="$pressure_1" -v b="$pressure_2" 'BEGIN { exit !(a > 469900 && a < 470100 && b > 540100 && b < 540300) }' ||
  fail "expected 470000 and 540200 Pa within 100 Pa"

# A translation unit on Eigen alone: whatever it includes is ours, Eigen's, the standard library's or the compiler's.
includes() { "$compiler" -std=c++20 -M -I"$prefix/include" -isystem "$eigen" "$1" | tr ' \\' '\n\n' | grep '^/' | sort -u; }
printf '#include <bits/stdc++.h>\n#include <immintrin.h>\n' >"$work/standard.cpp"
includes "$work/standard.cpp" >"$work/standard.txt"
compiler_dir=$("$compiler" -print-file-name=include)
others=$(includes "$source_dir/tests/package/consumer/eigen_alone.cpp" | grep -vxF -f "$work/standard.txt" |
  grep -vF -e "$prefix/include/pneuservo/" -e "$eigen/" -e "$compiler_dir/" -e /consumer/eigen_alone.cpp || true)
[[ -z $others ]] || fail "the estimator includes more than Eigen: $others"
"$compiler" -std=c++20 -Wall -Wextra -Werror -Wno-psabi -c -I"$prefix/include" -isystem "$eigen" \
  "$source_dir/tests/package/consumer/eigen_alone.cpp" -o "$work/eigen_alone.o" || fail "the unit on Eigen alone does not compile"

# Installed headers compile by themselves: ten drawn ones by day, all with PNEUSERVO_LONG=1.
find "$prefix/include/pneuservo" -name '*.hpp' | sort >"$work/headers.txt"
if [[ -z ${PNEUSERVO_LONG:-} ]]; then shuf -n 10 -o "$work/headers.txt" "$work/headers.txt"; fi
while IFS= read -r header; do
  printf '#include <%s>\n' "${header#"$prefix/include/"}" |
    "$compiler" -std=c++20 -Wno-psabi -fsyntax-only -I"$prefix/include" -isystem "$eigen" -x c++ - || fail "$header does not compile alone"
done <"$work/headers.txt"
echo "$(wc -l <"$work/headers.txt") installed headers compile alone"
