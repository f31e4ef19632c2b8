#!/usr/bin/env bash
# Both estimators on rendered images, 60 s each, from the truth, and the accuracy of the tracks that
# they were given (docs/worlds.md has its table):
#   test/evidence/rendered_worlds.sh FOLDER [PRESET...]      about 3 minutes a preset on two cores
# FOLDER keeps the data sets, tracks and run records.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
duet=${DUET:-$here/../../build/release/bin/duet}
out=${1:?FOLDER}
shift
[ $# -gt 0 ] || set -- easy_room difficult_room easy_hall dark_hall dark_hall_lit
mkdir -p "$out"

for preset in "$@"; do
  [ -d "$out/$preset" ] || "$duet" simulate --preset "$preset" --images --out "$out/$preset"
  rm -rf "$out/$preset-compare" "$out/$preset-points" "$out/$preset-points-compare"
  "$duet" compare --quiet --dataset "$out/$preset" --init groundtruth --out "$out/$preset-compare"
  "$duet" trackerror --quiet --dataset "$out/$preset" --tracks "$out/$preset-compare/tracks" \
    | tee "$out/$preset-trackerror.txt"
  # The same flight on simulated tracks with the noise and drift that were measured: white noise s and
  # a walk d a frame, per axis, make 4 s^2 + 2 n d^2 over n frames (both axes, both ends).
  read -r noise drift < <(awk '/frame to frame/ { f = $5 } /after 20 frames/ { D = $5 }
    END { d2 = (D * D > f * f) ? (D * D - f * f) / 38 : 0; s2 = f * f / 4 - d2 / 2
          printf("%.4f %.4f\n", (s2 > 0 ? sqrt(s2) : 0.001), sqrt(d2)) }' "$out/$preset-trackerror.txt")
  echo "simulated tracks: noise $noise px, drift $drift px a frame"
  "$duet" simulate --quiet --preset "$preset" --set "pixel_noise_px=$noise" \
    --set "pixel_drift_px=$drift" \
    --set weak_share=0.5 --set weak_track_frames=6 --set mean_track_frames=40 --set max_tracks=150 \
    --out "$out/$preset-points"
  "$duet" compare --quiet --dataset "$out/$preset-points" --init groundtruth \
    --out "$out/$preset-points-compare"
done
