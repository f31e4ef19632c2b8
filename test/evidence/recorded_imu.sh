#!/usr/bin/env bash
# Recorded IMUs with synthetic vision along their truths: tracks and rendered images, both estimators:
#   test/evidence/recorded_imu.sh FOLDER RECORDING...      about 5 minutes a recording on two cores
# A recording is an ASL folder with imu0 and a truth; it flies through the room, or through the hall
# where its name begins with MH.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
duet=${DUET:-$here/../../build/release/bin/duet}
out=${1:?FOLDER}
shift
mkdir -p "$out"

for recording in "$@"; do
  name=$(basename "$recording")
  world=room
  case $name in MH*) world=hall ;; esac
  for vision in tracks images; do
    flags=(--quiet --imu "$recording" --world "$world")
    [ "$vision" = tracks ] || flags+=(--images)
    [ -d "$out/$name-$vision" ] || "$duet" simulate "${flags[@]}" --out "$out/$name-$vision"
    rm -rf "$out/$name-$vision-compare"
    "$duet" compare --quiet --dataset "$out/$name-$vision" --init groundtruth \
      --out "$out/$name-$vision-compare"
  done
done
