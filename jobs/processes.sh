# shellcheck shell=bash
# Processes that outlive the script that starts them, known by a name within the current folder:
# their records are in run/, what they write is in log/. Sourced, never run, after scripts/lib.sh.

lock=  # the descriptor of a lock that isn't theirs to inherit

# (A bare `return` in a function that a trap calls gives the status from before the trap.)

# start_time PID: in clock ticks since boot, which tells it from a later process of the same number.
# Fails when there is no such process, or when it has ended and only its parent doesn't know yet.
start_time() {
  local stat
  { read -r stat <"/proc/$1/stat"; } 2>/dev/null || return 1
  read -ra stat <<<"${stat##*) }"  # what follows the name, which may contain anything
  # shellcheck disable=SC2128  # it is an array by now
  [[ ${stat[0]} != [ZX] ]] && echo "${stat[19]}"
}

# record NAME PID: the process is the folder's NAME from now on.
record() { echo "$2 $(start_time "$2")" >"run/$1.new" && mv "run/$1.new" "run/$1.process"; }

# pid_of NAME: fails when it doesn't run.
pid_of() {
  local pid begin
  { read -r pid begin <"run/$1.process"; } 2>/dev/null || return 1
  [[ $(start_time "$pid") == "$begin" ]] && echo "$pid"
}

running() { pid_of "$1" >/dev/null; }

# stop NAME [SIGNAL]: returns when the process has ended, by force if need be.
stop() {
  local name=$1 signal=${2:-TERM} pid i
  pid=$(pid_of "$name") || return 0
  kill -s "$signal" "$pid" 2>/dev/null || true  # it may just have ended
  for ((i = 0; i < 500; ++i)); do
    running "$name" || return 0
    ((i != 200)) || kill -s KILL "$pid" 2>/dev/null || true
    sleep 0.02
  done
  die "$name, process $pid, doesn't end even by SIGKILL"
}

# start NAME COMMAND...: in the background, apart from this terminal. The process records itself
# before it becomes the command: however the script dies, all that runs is on record.
start() {
  local name=$1
  shift
  ! running "$name" || die "$name runs already"
  rm -f "run/$name.process"
  {
    [[ -z $lock ]] || exec {lock}<&-
    record "$name" "$BASHPID" && exec setsid "$@"
  } </dev/null >"log/$name.out" 2>&1 &
  until [[ -e run/$name.process ]] || ! start_time $! >/dev/null; do sleep 0.005; done
}

# show_log NAME: the end of what it wrote.
show_log() {
  say "--- $PWD/log/$1.out"
  tail -n 15 "log/$1.out" >&2
}

# wait_for WHAT NAME COMMAND...: until the command succeeds, which takes the process NAME.
wait_for() {
  local what=$1 name=$2 deadline=$((SECONDS + 30))
  shift 2
  until "$@"; do
    if ((SECONDS > deadline)) || ! running "$name"; then
      show_log "$name"
      die "$what: $(running "$name" && echo "not within 30 s" || echo "$name has ended")"
    fi
    sleep 0.02
  done
}
