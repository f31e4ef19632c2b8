#!/bin/sh
# A study through GNU parallel, on this machine or (parallel's --sshlogin, on a folder that all see)
# on several:
#
#   gnu_parallel.sh JOBS STUDY.yaml --out DIR [flags of duet study]
#   PARALLEL_OPTIONS='--sshlogin host1,host2' gnu_parallel.sh 8 STUDY.yaml --out /shared/DIR
#
# DUET names the program where it is not in the path. Each run is one process that writes one record;
# the last command makes runs.csv and the tables. Started again it does what is left.
set -eu
if [ $# -lt 4 ]; then
  echo "usage: $0 JOBS STUDY.yaml --out DIR [flags of duet study]" >&2
  exit 2
fi
jobs=$1
shift
duet=${DUET:-duet}
plan=$(mktemp)
trap 'rm -f "$plan"' EXIT
"$duet" study "$@" --plan > "$plan"
# The options are words on purpose.
# shellcheck disable=SC2086
parallel --will-cite --jobs "$jobs" --halt soon,fail=1 ${PARALLEL_OPTIONS:-} < "$plan"
"$duet" study "$@"
