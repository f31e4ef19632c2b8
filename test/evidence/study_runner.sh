#!/usr/bin/env bash
# What the runner of studies costs beside its runs, and whether its memory grows with their number:
#   test/evidence/study_runner.sh OUT [RUNS]
# RUNS (1000) short runs of both estimators, two at once: its resident memory as records come in. Then runs as long
# as the head-to-head's, one after the other, on streams that are there: its processor time beside theirs, and the
# time that passes beyond the time that the runs take. DUET names another program.
set -euo pipefail
out=$1
runs=${2:-1000}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
duet=${DUET:-$root/build/release/bin/duet}
ticks=$(getconf CLK_TCK)
mkdir -p "$out"

# study NAME SECONDS SEEDS
study() {
  printf '%s\n' "study: $1" "streams:" \
    "  - {name: room, simulate: room_easy, set: {simulation.duration_s: $2}}" \
    "seeds: 1..$3" "metrics: [ate.position_m]" "figures: []" >"$out/$1.yaml"
}

records() { { find "$1" -mindepth 1 -maxdepth 1 -type d ! -name '*.partial-*' 2>/dev/null || true; } | wc -l; }

# watch NAME JOBS TOTAL: runs the study and writes NAME.csv: records, kB resident, own ticks, children's ticks, time.
watch() {
  "$duet" study "$out/$1.yaml" --jobs "$2" --quiet --out "$out/$1" >"$out/$1.log" &
  local pid=$! done_runs=0
  : >"$out/$1.csv"
  while [ "$done_runs" -lt "$3" ] && [ -r "/proc/$pid/stat" ]; do
    done_runs=$(records "$out/$1/runs")
    local memory times
    memory=$(awk '/^VmRSS/ {print $2}' "/proc/$pid/status" 2>/dev/null) || break
    times=$(awk '{print $14 + $15 "," $16 + $17}' "/proc/$pid/stat" 2>/dev/null) || break
    echo "$done_runs,$memory,$times,$(date +%s.%N)" >>"$out/$1.csv"
    sleep 0.1
  done
  wait "$pid"
}

study many 3 $((runs / 2))
watch many 2 "$runs"
echo "memory of the runner over $(records "$out/many/runs") runs:"
for share in 10 25 50 75 100; do
  awk -F, -v want=$((runs * share / 100)) '$1 + 2 >= want {
    printf "  %5d records: %.1f MB\n", $1, $2 / 1024; exit }' "$out/many.csv"
done

study long 30 20
"$duet" study "$out/long.yaml" --jobs 2 --quiet --out "$out/long" >"$out/long.log"  # makes the streams
rm -r "$out/long/runs"
watch long 1 40
elapsed=$(sed -n 's/^ *"elapsed_s": *\([0-9.e+-]*\),*$/\1/p' "$out"/long/runs/*/manifest.json |
  awk '{sum += $1} END {print sum}')
awk -F, -v ticks="$ticks" -v elapsed="$elapsed" '
  NR == 1 {start = $5; own = $3}
  {last = $0}
  END {
    split(last, at, ",")
    printf "%d runs of 30 s, one after the other:\n", at[1]
    printf "  processor time: runner %.2f s, runs %.2f s: %.2f %%\n", (at[3] - own) / ticks, at[4] / ticks,
           100 * (at[3] - own) / at[4]
    printf "  time passed %.2f s, of it in runs %.2f s: %.2f %% more\n", at[5] - start, elapsed,
           100 * ((at[5] - start) / elapsed - 1)
  }' "$out/long.csv"
