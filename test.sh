#!/usr/bin/env bash
# Builds Duet and runs its tests: ./test.sh [--all]. --all adds the long Monte-Carlo runs.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/cmake/bootstrap.sh"

exclude=(--label-exclude long)
case "${1:-}" in
  "") ;;
  --all) exclude=() ;;
  *) echo "usage: ./test.sh [--all]" >&2; exit 2 ;;
esac

duet_install_packages "${duet_packages[@]}" "${duet_test_packages[@]}"
duet_install_packages "${duet_tex_packages[@]}" ||
  echo "duet: LaTeX tables will not be compiled" >&2
duet_install_packages "${duet_browser_packages[@]}" ||
  echo "duet: tests of the report's page in a browser will be skipped" >&2
duet_configure release -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=ON
echo "duet: building program and tests" >&2
duet_build release all
ctest --test-dir "$DUET_ROOT/build/release" --output-on-failure --no-tests=error -j "$(nproc)" "${exclude[@]}"
