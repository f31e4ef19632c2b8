#!/usr/bin/env bash
# Builds Duet and runs its tests: ./test.sh [--all]. --all adds the long Monte-Carlo runs, and installs
# what looks at tables, figures and reports (TeX, a browser).
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/cmake/bootstrap.sh"

exclude=(--label-exclude long)
case "${1:-}" in
  "") ;;
  --all) exclude=() ;;
  *) echo "usage: ./test.sh [--all]" >&2; exit 2 ;;
esac

duet_install_packages "${duet_packages[@]}" "${duet_test_packages[@]}"
if [ ${#exclude[@]} -eq 0 ]; then
  # Without them what looks at LaTeX, fonts and the report's page is skipped, and says so.
  duet_install_packages "${duet_paper_packages[@]}" "${duet_browser_packages[@]}" ||
    echo "duet: tests of LaTeX, of fonts or of the report in a browser will be skipped" >&2
fi
duet_configure release -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=ON
echo "duet: building program and tests" >&2
duet_build release all
ctest --test-dir "$DUET_ROOT/build/release" --output-on-failure --no-tests=error -j "$(nproc)" "${exclude[@]}"
