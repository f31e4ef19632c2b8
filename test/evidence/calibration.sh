#!/usr/bin/env bash
# What estimating the calibration is worth in simulation: test/evidence/calibration.sh OUT [SEEDS]
# (default 50). Prints the tables of docs/calibration.md; about half an hour on two cores.
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

for motion in straight_line pure_rotation one_axis_rotation standstill planar_driving; do
  echo "== degenerate motion: $motion"
  "$duet" ablate --simulate room_easy "${everything[@]}" "${minute[@]}" --states all \
    --design none_and_all --set "simulation.trajectory=$motion" \
    --set simulation.t_d_s=0.005 --set simulation.t_r_s=0.02 \
    --seeds "1..$((seeds / 5))" --jobs 2 --quiet --out "$out/$motion"
done
