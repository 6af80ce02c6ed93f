# shellcheck shell=bash
# Sourced by setup, demo and check after `cd` to the repository: runs a step quietly.

# step NAME COMMAND…: what the command prints goes to build/logs/NAME.log. Here stands how long it
# took; while it runs, its last line: every second on a terminal, every 15 s elsewhere.
step() {
  local name=$1 log=build/logs/$1.log started=$SECONDS rc=0 ticker
  shift
  mkdir -p build/logs
  : >"$log"
  watch_step "$name" "$log" "$started" &
  ticker=$!
  "$@" >"$log" 2>&1 </dev/null || rc=$?
  kill "$ticker" 2>/dev/null || true
  wait "$ticker" 2>/dev/null || true
  if [ -t 1 ]; then printf '\r\033[K'; fi
  if [ "$rc" -ne 0 ]; then
    printf '%s: failed after %d s; the end of %s/%s:\n' "$name" $((SECONDS - started)) "$PWD" "$log" >&2
    tail -n 25 "$log" | sed 's/^/    /' >&2
    return "$rc"
  fi
  printf '%s: done in %d s\n' "$name" $((SECONDS - started))
}

watch_step() {
  local every=15 last
  if [ -t 1 ]; then every=1; fi
  while sleep "$every" >/dev/null 2>&1 && kill -0 $$ 2>/dev/null; do  # ends with the script
    last=$(tail -n 1 "$2" | tr -d '\r' | cut -c 1-80)
    if [ -t 1 ]; then printf '\r\033[K'; fi
    printf '%s: %d s  %s' "$1" $((SECONDS - $3)) "$last"
    if [ ! -t 1 ]; then printf '\n'; fi
  done
}
