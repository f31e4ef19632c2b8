#!/bin/sh
# A study as a Slurm array; DIR and the program must be seen by every node:
#
#   slurm_array.sh STUDY.yaml --out DIR [flags of duet study]
#   SBATCH_OPTIONS='--partition=long --mem-per-cpu=1G' slurm_array.sh STUDY.yaml --out DIR
#
# DUET names the program where it is not in the path, MAX_TASKS the largest array that the cluster
# takes (1000): a task takes every so many-th run. Prints the number of the job that finishes the
# study, after all tasks, whatever became of them. Started again it does what is left.
set -eu
if [ $# -lt 3 ]; then
  echo "usage: $0 STUDY.yaml --out DIR [flags of duet study]" >&2
  exit 2
fi
duet=${DUET:-duet}
out=
previous=
for word in "$@"; do
  [ "$previous" = --out ] && out=$word
  case $word in --out=*) out=${word#--out=} ;; esac
  previous=$word
done
"$duet" study "$@" --plan > "$out.plan.partial"
mkdir -p "$out/slurm"
plan=$(cd "$out/slurm" && pwd)/commands.txt
mv "$out.plan.partial" "$plan"
runs=$(wc -l < "$plan")
tasks=${MAX_TASKS:-1000}
[ "$runs" -lt "$tasks" ] && tasks=$runs

finish="'$duet' study"
for word in "$@"; do finish="$finish '$word'"; done
dependency=
if [ "$runs" -gt 0 ]; then
  # Line by line: task t takes lines t, t + tasks, ...
  # shellcheck disable=SC2086
  array=$(sbatch --parsable --job-name=duet-study --array="1-$tasks" --cpus-per-task=1 \
    --output="$out/slurm/%A_%a.txt" ${SBATCH_OPTIONS:-} --wrap \
    "awk -v t=\"\$SLURM_ARRAY_TASK_ID\" -v n=$tasks 'NR % n == t % n' '$plan' | sh -e")
  dependency=--dependency=afterany:$array
fi
# shellcheck disable=SC2086
sbatch --parsable --job-name=duet-study-end $dependency --output="$out/slurm/end.txt" \
  ${SBATCH_OPTIONS:-} --wrap "$finish"
