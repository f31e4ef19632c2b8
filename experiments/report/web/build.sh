#!/usr/bin/env bash
# Makes dist/ from src/ with the versions that package-lock.json pins: experiments/report/web/build.sh
# With --check FOLDER it builds in FOLDER instead and compares: status 1 where dist/ is not what its
# sources give, 77 where node, npm or the packages are missing.
set -euo pipefail
web=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

missing() {
  echo "SKIPPED: the report's bundle was not rebuilt: $1" >&2
  exit 77
}
for program in node npm; do
  command -v "$program" >/dev/null || missing "$program is not installed"
done

if [ "${1:-}" != --check ]; then
  cd "$web"
  npm ci --ignore-scripts --no-audit --no-fund --silent
  exec node build.mjs dist
fi

work=${2:?usage: build.sh --check FOLDER}
mkdir -p "$work"
rm -rf "$work/src"
cp -r "$web"/{package.json,package-lock.json,build.mjs,src} "$work"
cd "$work"
# Kept from one check to the next: the network is asked once.
if ! cmp -s package-lock.json node_modules/.installed-from; then
  npm ci --ignore-scripts --no-audit --no-fund --silent || missing "npm did not get the packages"
  cp package-lock.json node_modules/.installed-from
fi
rm -rf dist
node build.mjs dist
(cd "$web/dist" && sha256sum --check --quiet SHA256SUMS)
diff -rq "$web/dist" dist && echo "dist/ is what its sources give"
