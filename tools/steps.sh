# shellcheck shell=bash disable=SC2154
# Sourced by quickstart and check: numbered steps, each with its time, its log, and progress on a
# terminal. The caller sets `steps`, the number of steps, and `logs`, a folder.

step_number=0
ticker=

# On a terminal: one line that shows the time and the end of the log, until killed.
show_log() {
  local log=$1 begin=$SECONDS last
  while sleep 1; do
    last=$(tail -c 400 "$log" 2>/dev/null | tr '\r' '\n' | sed 's/\x1b\[[0-9;]*[A-Za-z]//g' |
      grep . | tail -n 1 || true)
    printf '\r\033[K      %3d s  %s' $((SECONDS - begin)) "${last:0:$((${COLUMNS:-80} - 14))}"
  done
}

stop_ticker() {
  [[ -n $ticker ]] || return 0
  kill "$ticker" 2>/dev/null || true
  wait "$ticker" 2>/dev/null || true
  ticker=
  printf '\r\033[K'
}
trap stop_ticker EXIT

# step WHAT NAME COMMAND...: runs the command; its output goes to $logs/NAME.log and is shown, the
# last 40 lines of it, only where the command fails, which ends the script. In a function that is
# such a command `set -e` has no effect: chain what it does with &&.
# With own_progress=yes the command draws on the terminal itself.
step() {
  local what=$1 log=$logs/$2.log begin=$SECONDS status=0
  shift 2
  step_number=$((step_number + 1))
  echo "[$step_number/$steps] $what"
  mkdir -p "$logs"
  : >"$log"
  if [[ -t 2 && ${own_progress:-no} == yes ]]; then
    "$@" >"$log" || status=$?
  elif [[ -t 1 ]]; then
    show_log "$log" &
    ticker=$!
    "$@" >"$log" 2>&1 || status=$?
    stop_ticker
  else
    "$@" >"$log" 2>&1 || status=$?
  fi
  if ((status != 0)); then
    tail -n 40 "$log"
    echo "FAILED: $what (status $status). All of it is in $log"
    exit 1
  fi
  echo "      done in $((SECONDS - begin)) s"
}
