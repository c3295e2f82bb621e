# shellcheck shell=bash
# What the scripts share. Sourced, never run. Results go to stdout, everything else to stderr.

root=$(readlink -f "${BASH_SOURCE[0]}")
root=${root%/scripts/*}
# Where the logs of configuring, building and testing stay until the next run overwrites them.
# shellcheck disable=SC2034  # used by the scripts that source this file
logs=$root/build/logs

red='' plain=''
if [[ -t 2 && -z ${NO_COLOR:-} && ${TERM:-dumb} != dumb ]]; then
  red=$'\e[31m' plain=$'\e[0m'
fi

say() { printf '%s\n' "$*" >&2; }

die() {
  say "${red}$(basename "$0"): $*${plain}"
  exit 1
}

# usage_error MESSAGE: for a command line that makes no sense.
usage_error() {
  say "$(basename "$0"): $*; see $(basename "$0") --help"
  exit 2
}

# print_help: the comment at the top of the script, from its second line to its first blank one.
print_help() { sed -n '2,/^$/ s/^# \{0,1\}//p' "$0"; }

duration() {
  if (($1 < 60)); then echo "$1 s"; else echo "$(($1 / 60)) min $(($1 % 60)) s"; fi
}

# show_progress TITLE: keeps the title and the latest "[12/98]" or "12/98" of its input on one line
# of the terminal. Without a terminal it only swallows its input.
show_progress() {
  local line
  while IFS= read -r line; do
    if [[ -t 2 && $line =~ ^\ *\[?([0-9]+/[0-9]+)[]\ ] ]]; then
      printf '\r%-44s %12s' "$1" "${BASH_REMATCH[1]}" >&2
    fi
  done
}

# show_failure LOG: what went wrong: a failed build from ninja's first FAILED, else the log's tail.
show_failure() {
  if grep -q '^FAILED: ' "$1"; then
    awk '/^FAILED: / { failed = 1 } failed && ++lines <= 60' "$1" >&2
  else
    tail -n 40 "$1" >&2
  fi
  say "${red}The whole log: $1${plain}"
}

# step TITLE LOG COMMAND...: runs the command with all its output in the log and shows one line,
# with the time at its end. When the command fails: what the log says, and the command's status.
# (bash ignores `set -e` inside a function called here; chain its commands with &&.)
step() {
  local title=$1 log=$2 begin=$SECONDS status=0
  shift 2
  mkdir -p "$(dirname "$log")"
  printf '%-44s' "$title" >&2
  "$@" </dev/null 2>&1 | tee "$log" | show_progress "$title" || status=$?
  [[ -t 2 ]] && printf '\r%-44s' "$title" >&2
  if ((status != 0)); then
    printf ' %s%12s%s\n' "$red" failed "$plain" >&2
    show_failure "$log"
    return "$status"
  fi
  printf ' %12s\n' "$(duration $((SECONDS - begin)))" >&2
}

# The cores this process may use. nproc heeds OpenMP's variables, which are meant for rollouts.
num_cores() { env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc; }

# As many compilers as cores, but no more than the free memory holds: the largest take 1.5 GB.
num_compilers() {
  local cores memory
  cores=$(num_cores)
  memory=$(awk '/^MemAvailable:/ { print int($2 / (1.5 * 1024 * 1024)) }' /proc/meminfo)
  ((memory >= 1)) || memory=1
  echo "${CMAKE_BUILD_PARALLEL_LEVEL:-$((cores < memory ? cores : memory))}"
}

# build PRESET [ARGUMENT OF CMAKE --BUILD]...
build() {
  local preset=$1
  shift
  cd "$root" || return
  step "Configuring ($preset)" "$logs/$preset-configure.log" cmake --preset "$preset" || return
  step "Building ($preset)" "$logs/$preset-build.log" \
    cmake --build --preset "$preset" --parallel "$(num_compilers)" "$@"
}

# git in the checkout, also when it belongs to somebody else, as it does in many a CI container.
git_here() { git -C "$root" -c safe.directory="$root" "$@"; }

# tracked_files PATTERN...: those that exist, relative to the root.
tracked_files() {
  local file
  git_here ls-files -- "$@" | while IFS= read -r file; do
    [[ ! -f $root/$file ]] || printf '%s\n' "$file"
  done
}
