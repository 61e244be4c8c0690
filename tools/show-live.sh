# shellcheck shell=bash disable=SC2154
# Sourced by quickstart: a robot that sends sweeps over a link of the paper's bandwidths, and a server
# that shows what arrives in a browser. Uses $tool, the program.

# start NAME COMMAND...: in the background, what it says goes to $live/NAME.
start() {
  local name=$1
  shift
  : >"$live/$name" # there is something to look at before it runs
  "$@" >"$live/$name" 2>&1 &
  live_pids+=($!)
}

# said NAME PATTERN: waits until the newest program says a line with this, and prints the match; fails
# where the program ends before.
said() {
  until grep -oE -m 1 "$2" "$live/$1"; do
    kill -0 "${live_pids[-1]}" 2>/dev/null || return 1
    sleep 0.05
  done
}

stop_live() {
  trap '' INT TERM HUP
  kill "${live_pids[@]}" 2>/dev/null
  wait "${live_pids[@]}" 2>/dev/null
  rm -rf "$live"
}

gave_up() { # NAME
  echo "quickstart: $1 ended:" >&2
  cat "$live/$1" >&2
  exit 1
}

# receive with its page at port 8080, or where somebody has it, at any that is free.
start_receiver() {
  local port
  for port in 8080 0; do
    start receive "$tool" receive --listen 0 --keys "$live/key" --view "$port" -o "$live/got"
    said receive 'listening at .*' >/dev/null && return
    wait "${live_pids[-1]}" || true
    unset 'live_pids[-1]'
  done
  gave_up receive
}

# show_live SWEEPS: until Ctrl-C, or until one of the programs ends.
show_live() {
  local sweeps=$1 address port
  live=$(mktemp -d)
  live_pids=()
  trap stop_live EXIT
  trap 'echo && exit 0' INT TERM HUP
  "$tool" keygen "$live/key" --robot rover
  start_receiver
  address=$(grep -oE 'http://[^ ]+' "$live/receive")
  port=$(said receive 'listening at .*' | grep -oE '[0-9]+$')
  start emulate-link "$tool" emulate-link --listen 0 --to "$port" --trace paper --delay 20
  port=$(said emulate-link 'relaying [^ ]+' | grep -oE '[0-9]+$') || gave_up emulate-link
  start send "$tool" send "$sweeps" --to "127.0.0.1:$port" --key "$live/key" --loop

  echo
  if [[ -n ${DISPLAY:-}${WAYLAND_DISPLAY:-} ]] && command -v xdg-open >/dev/null; then
    xdg-open "$address" >/dev/null 2>&1 &
    echo "Live at $address, which your browser opens now. Ctrl-C ends it."
  else
    echo "Live at $address: open that in a browser on this machine. Ctrl-C ends it."
    echo "From another machine: ssh -L ${address##*:}:127.0.0.1:${address##*:} $(id -un)@$(uname -n), then open it there."
  fi
  wait -n "${live_pids[@]}" && exit 0 # a signal to them alone ends them without a fault
  for name in receive emulate-link send; do
    cat "$live/$name"
  done >&2
  echo "quickstart: one of the programs has failed; above is what they said" >&2
  exit 1
}
