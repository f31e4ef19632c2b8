#!/usr/bin/env bash
# Runs the shipped studies, or those that are named, and prints docs/results.md:
#   test/evidence/studies.sh OUT [--quick [STUDY...]] > docs/results.md
# An hour on two cores; with --quick a quarter of one. Studies that are there already are not run again.
set -euo pipefail
out=$1
quick=${2:-}
studies=("${@:3}")
[ ${#studies[@]} -gt 0 ] || studies=(head_to_head calibration_ablation consistency window_and_features
                                     time_offset imu_noise_told_wrong start_errors rolling_shutter)
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
duet=${DUET:-$root/build/release/bin/duet}
mkdir -p "$out"

cat <<TEXT
# Results of the shipped studies

Made by \`test/evidence/studies.sh OUT${quick:+ ${*:2}}\` from the records of each study; the same command makes
them again. Every number can be derived once more from the records: \`duet verify OUT/STUDY\`.
docs/studies.md says what the studies are, docs/statistics.md how to read the sentences, and the tables with
their spreads are in \`OUT/STUDY/tables\`, the page to look at in \`OUT/STUDY/report.html\`.
TEXT
[ -z "$quick" ] || cat <<'TEXT'

These are the quick versions: a first look, of few seeds. Where they say that nothing can be said, more seeds may.
TEXT
for study in "${studies[@]}"; do
  # shellcheck disable=SC2086  # no argument where it is empty
  "$duet" study "$root/configs/studies/$study.yaml" $quick --jobs 2 --quiet --out "$out/$study" >&2
  "$duet" verify "$out/$study" >&2
  printf '\n## %s\n\n```\nduet study configs/studies/%s.yaml%s --jobs 2 --out %s\n```\n\n```\n' \
    "$study" "$study" "${quick:+ $quick}" "$study"
  cat "$out/$study/summary.txt"
  printf '```\n'
done
