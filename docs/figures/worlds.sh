#!/usr/bin/env bash
# Makes the pictures of docs/worlds.md anew: docs/figures/worlds.sh [PROGRAM]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
duet=${1:-../../build/release/bin/duet}

# picture NAME SECONDS [arguments of duet simulate]
picture() {
  local name=$1 after=$2
  shift 2
  rm -f "world_$name.jpg"
  "$duet" simulate "$@" --set render.quality=accurate --picture "$after" --out "world_$name.jpg"
  echo "world_$name.jpg" >&2
}

picture room 9 --preset easy_room
picture bare_room 9 --preset easy_room --world bare_room
picture hall 35 --preset easy_hall
picture street 12 --preset street_drive
picture dark_hall 20 --preset dark_hall
picture walkers 28 --preset easy_room --set moving_bodies=true
picture blur 9.2 --preset difficult_room --set render.exposure_s=0.03
picture rolling_shutter 9.2 --preset difficult_room --set render.exposure_s=0 --set t_r_s=0.06
picture global_shutter 9.2 --preset difficult_room --set render.exposure_s=0
picture noise 9 --preset easy_room --set render.photometry.noise_per_grey=0.6 \
  --set render.photometry.noise_floor=20
picture vignetting 9 --preset easy_room --set render.photometry.vignetting=0.8
picture fisheye 9 --preset easy_room --sensors ../../configs/sensors/phone_like.yaml
