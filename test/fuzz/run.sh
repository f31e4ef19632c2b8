#!/bin/sh
# Builds the fuzz targets with clang, AddressSanitizer and UBSan, and runs each for SECONDS (60):
#   test/fuzz/run.sh [SECONDS [TARGET...]]
# Exit status 1 where one of them found something; what it found is in build/fuzz/found.
set -eu
cd "$(dirname "$0")/../.."

seconds=${1:-60}
[ $# -eq 0 ] || shift
compiler=
for candidate in ${CXX:-} clang++ clang++-14 clang++-15 clang++-16 clang++-17 clang++-18; do
  case $candidate in
    *clang*) if command -v "$candidate" > /dev/null; then compiler=$candidate; break; fi ;;
  esac
done
if [ -z "$compiler" ]; then
  echo "test/fuzz/run.sh needs clang with libFuzzer: apt-get install clang libclang-rt-dev" >&2
  exit 2
fi

build=${DUET_FUZZ_BUILD:-build/fuzz}
mkdir -p "$build"
cmake -S "${DUET_FUZZ_SOURCE:-.}" -B "$build" -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_BUILD_TYPE=Release -DDUET_FUZZERS=ON \
  -DDUET_SANITIZE=fuzzer-no-link,address,undefined > "$build/configure.log" 2>&1 || {
  cat "$build/configure.log" >&2; exit 2; }
cmake --build "$build" --target fuzzers -j "$(nproc)"

targets=${*:-$(cd test/fuzz && ls *_fuzz.cc | sed 's/_fuzz.cc//')}
mkdir -p "$build/found"
failed=
for target in $targets; do
  corpus=$build/corpus/$target
  mkdir -p "$corpus"
  seeds=test/fuzz/seeds/$target
  [ -d "$seeds" ] || seeds=
  log=$build/$target.log
  # shellcheck disable=SC2086  # an absent folder of seeds is no argument
  if "$build/bin/${target}_fuzz" -max_total_time="$seconds" -timeout=5 -rss_limit_mb=1024 \
      -max_len=4096 -close_fd_mask=1 -artifact_prefix="$build/found/$target-" \
      "$corpus" $seeds > "$log" 2>&1; then
    echo "$target: nothing found, $(grep -o 'Done [0-9]* runs' "$log" | tail -1)"
  else
    failed="$failed $target"
    echo "$target: FOUND something, see $log" >&2
    grep -m 3 'ERROR\|runtime error\|Check failed' "$log" >&2 || true
  fi
done
[ -z "$failed" ] || { echo "found by:$failed; inputs in $build/found" >&2; exit 1; }
