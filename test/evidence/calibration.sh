#!/usr/bin/env bash
# What estimating the calibration is worth in simulation: test/evidence/calibration.sh OUT [SEEDS]
# (default 50). Prints the tables of docs/calibration.md; an hour on two cores.
set -euo pipefail
out=$1
seeds=${2:-50}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
duet=${DUET:-$root/build/release/bin/duet}
mkdir -p "$out"
minute=(--set simulation.duration_s=60 --set simulation.camera_rate_hz=20
        --set simulation.max_tracks=100 --set simulation.pixel_noise_px=1)
everything=(--config "$root/configs/estimators/everything_estimated.yaml")

echo "== six-axis excitation, everything told wrong: estimated, and fixed beside it"
"$duet" ablate --simulate excited "${everything[@]}" "${minute[@]}" --states all \
  --design none_and_all --perturb "$root/configs/studies/told_wrong.yaml" \
  --set simulation.t_d_s=0.005 --set simulation.t_r_s=0.02 \
  --seeds "1..$seeds" --jobs 2 --quiet --out "$out/excited"

# Fast turns; the same flight, seed by seed, with a global shutter and with rolling ones that are
# told as global: estimated, and not modelled.
turns=(--simulate room_easy "${minute[@]}" --set simulation.trajectory=aggressive
       --set simulation.duration_s=20 --states t_r --design none_and_all
       --seeds "1..$seeds" --jobs 2 --quiet)
printf 'told_offset: {t_r_s: [0]}\n' > "$out/told_right.yaml"
"$duet" ablate "${turns[@]}" --perturb "$out/told_right.yaml" --out "$out/global" > "$out/global.txt"
for milliseconds in 20 30; do
  echo "== fast turns, rolling shutter of $milliseconds ms against a global one"
  printf 'told_offset: {t_r_s: [-0.0%d]}\n' "$milliseconds" > "$out/told_global.yaml"
  "$duet" ablate "${turns[@]}" --set "simulation.t_r_s=0.0$milliseconds" \
    --perturb "$out/told_global.yaml" --out "$out/rolling$milliseconds"
  for estimator in msckf window; do
    for estimated in t_r none; do
      awk -F, -v estimator="$estimator" -v estimated="$estimated" '
        FNR == 1 { for (i = 1; i <= NF; ++i) if ($i == "ate position [m]") ate = i }
        $1 != estimator || $4 != 0 { next }
        FNR == NR { if ($2 == "none") global[$3] = $ate; next }
        $2 == estimated && ($3 in global) { print $ate / global[$3] }
      ' "$out/global/runs.csv" "$out/rolling$milliseconds/runs.csv" | sort -g | awk -v e="$estimator" \
        -v estimated="$estimated" '{ ratio[NR] = $1 } END { printf("%s, estimated: %s: median paired ratio of ATE %.3f\n", e, estimated,
          (ratio[int((NR + 1) / 2)] + ratio[int(NR / 2) + 1]) / 2) }'
    done
  done
done

for motion in straight_line pure_rotation one_axis_rotation standstill planar_driving; do
  echo "== degenerate motion: $motion"
  "$duet" ablate --simulate room_easy "${everything[@]}" "${minute[@]}" --states all \
    --design none_and_all --set "simulation.trajectory=$motion" \
    --set simulation.t_d_s=0.005 --set simulation.t_r_s=0.02 \
    --seeds "1..$(((seeds + 4) / 5))" --jobs 2 --quiet --out "$out/$motion"
done
