#!/usr/bin/env bash
# Runs the shipped studies, or those that are named, and prints docs/results.md:
#   test/evidence/studies.sh OUT [--quick] [STUDY[:quick]...] > docs/results.md
# All of them: an hour on two cores; with --quick a third of one. Runs that are there already are not made again.
# DUET names another program, JOBS how many runs at once (2).
set -euo pipefail
out=$1
shift
arguments="$*"
suffix=
if [ "${1:-}" = --quick ]; then
  suffix=:quick
  shift
fi
studies=("$@")
[ ${#studies[@]} -gt 0 ] || studies=(head_to_head time_offset calibration_ablation rolling_shutter
                                     consistency start_errors imu_noise_told_wrong window_and_features)
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
duet=${DUET:-$root/build/release/bin/duet}
mkdir -p "$out"

cat <<TEXT
# Results of the shipped studies

Made by \`test/evidence/studies.sh OUT${arguments:+ $arguments}\` from the records of each study; the same command makes
them again. Every number can be derived once more from the records: \`duet verify OUT/STUDY\`.
docs/studies.md says what the studies are, docs/statistics.md how to read the sentences, and the tables with
their spreads are in \`OUT/STUDY/tables\`, the page to look at in \`OUT/STUDY/report.html\`.

Those with \`--quick\` are a first look, of few seeds. Where they say that nothing can be said, more seeds may.
TEXT
for named in "${studies[@]}"; do
  [[ $named == *:quick ]] || named+=$suffix
  study=${named%:quick}
  quick=()
  [ "$named" = "$study" ] || quick=(--quick)
  "$duet" study "$root/configs/studies/$study.yaml" "${quick[@]}" --jobs "${JOBS:-2}" --quiet \
    --out "$out/$study" >&2
  "$duet" verify "$out/$study" >&2
  printf '\n## %s\n\n```\nduet study configs/studies/%s.yaml%s --jobs 2 --out %s\n```\n\n```\n' \
    "$study" "$study" "${quick:+ --quick}" "$study"
  cat "$out/$study/summary.txt"
  printf '```\n'
done
