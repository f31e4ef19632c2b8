#!/usr/bin/env bash
# Rolling shutters on rendered images through the front end, against the same flights with a global
# shutter: test/evidence/rolling_shutter_images.sh FOLDER [SEEDS]      (default 3; 4 minutes a seed)
# t_r is told as 0: estimated, and not modelled. FOLDER keeps data sets and run records.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
duet=${DUET:-$here/../../build/release/bin/duet}
out=${1:?FOLDER}
seeds=${2:-3}
mkdir -p "$out"
estimate=(--set shared.calibration.t_r.state=estimated)

# compare NAME DATASET [settings of duet compare]: msckf and window ATE [m]
compare() {
  local name=$1 dataset=$2
  shift 2
  rm -rf "$out/$name"
  "$duet" compare --quiet --dataset "$dataset" --init groundtruth "$@" --out "$out/$name" > "$out/$name.txt"
  awk -F'[:,]' '/"position_m"/ { print $2 }' "$out/$name/comparison.json" | head -2 | xargs
}

for seed in $(seq 1 "$seeds"); do
  for milliseconds in 0 20 30; do
    data="$out/data-$milliseconds-$seed"
    [ -d "$data" ] || "$duet" simulate --quiet --preset difficult_room --images --seed "$seed" \
      --set duration_s=20 --set "t_r_s=0.0$(printf %02d "$milliseconds")" --out "$data"
  done
  errors=$(compare "global-$seed" "$out/data-0-$seed")
  read -r filter window <<< "$errors"
  echo "seed $seed, global shutter: msckf ${filter:0:6} m, window ${window:0:6} m"
  for milliseconds in 20 30; do
    told=(--set "shared.calibration.told_offset.t_r_s=[-0.0$milliseconds]")
    data="$out/data-$milliseconds-$seed"
    errors=$(compare "estimated-$milliseconds-$seed" "$data" "${told[@]}" "${estimate[@]}")
    read -r f w <<< "$errors"
    errors=$(compare "ignored-$milliseconds-$seed" "$data" "${told[@]}")
    read -r g v <<< "$errors"
    awk -v t="$milliseconds" -v f="$f" -v w="$w" -v g="$g" -v v="$v" -v F="$filter" -v W="$window" \
      'BEGIN { printf("  t_r = %d ms: estimated msckf %.4f m (%.2f x), window %.4f m (%.2f x); not modelled %.4f m (%.1f x), %.4f m (%.1f x)\n",
                      t, f, f / F, w, w / W, g, g / F, v, v / W) }'
  done
done
