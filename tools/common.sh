# What the scripts in tools/ share: the project's root, progress messages, building a preset. Sourced, not run.

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)

# Progress goes to standard error, results to standard output.
say() { printf '%s: %s\n' "${0##*/}" "$*" >&2; }

# die STATUS SENTENCE: ends the script.
die() {
  local status=$1
  shift
  say "$*"
  exit "$status"
}

jobs_of_this_machine() { nproc 2>/dev/null || echo 2; }

# Where what failed is noted: its log and a sentence.
failure_list=$root/build/log/failures
note_failure() {
  mkdir -p "$root/build/log"
  printf '%s\t%s\n' "$1" "$2" >>"$failure_list"
}

# quietly NAME COMMAND...: runs the command, shows its output only when it fails.
quietly() {
  local name=$1 log status=0
  shift
  mkdir -p "$root/build/log"
  log="$root/build/log/$name.log"
  "$@" >"$log" 2>&1 </dev/null || status=$?
  if ((status != 0)); then
    tail -n 60 "$log" >&2
    say "failed with status $status (all output: $log): $*"
    note_failure "$log" "status $status: $*"
  fi
  return "$status"
}

# failures_again LINES: the last lines of what failed since failure_list was removed; what came between has pushed them
# out of sight.
failures_again() {
  local log what
  [[ -e $failure_list ]] || return 0
  while IFS=$'\t' read -r log what; do
    say "$what"
    tail -n "$1" "$log" >&2
  done <"$failure_list"
}

# configure PRESET [CMAKE OPTION]...
configure() {
  local preset=$1
  shift
  quietly "configure-$preset" cmake -S "$root" --preset "$preset" "$@"
}

# build PRESET [TARGET]...: all targets when none is named.
build() {
  local preset=$1 name=build-$1
  local -a targets=()
  shift
  if (($# > 0)); then targets=(--target "$@"); fi
  quietly "$name" cmake --build "$root/build/$preset" -j "$(jobs_of_this_machine)" "${targets[@]}"
}

# targets_among PRESET NAME...: those of the names that the preset's build has.
targets_among() {
  local preset=$1 name known
  shift
  known=$(ninja -C "$root/build/$preset" -t targets all | sed -n 's/: .*//p')
  for name in "$@"; do
    if grep -qxF -- "$name" <<<"$known"; then printf '%s\n' "$name"; fi
  done
}

# unless_skipped COMMAND...: like the command, but status 77 (skipped, it said why) counts as passed.
unless_skipped() {
  local status=0
  "$@" || status=$?
  if ((status == 77)); then say "SKIPPED: ${1##*/}, for the reason above"; else return "$status"; fi
}
