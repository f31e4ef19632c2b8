#!/usr/bin/env bash
# Builds Duet and runs the head-to-head comparison: ./run.sh [arguments of duet compare].
# Without --dataset it runs on a sequence that Duet simulates.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/cmake/bootstrap.sh"

duet_install_packages "${duet_packages[@]}"
duet_configure release -DCMAKE_BUILD_TYPE=Release
[ -x "$DUET_ROOT/build/release/bin/duet" ] || echo "duet: building (once, a few minutes)" >&2
duet_build release duet
exec "$DUET_ROOT/build/release/bin/duet" compare "$@"
