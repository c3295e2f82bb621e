#!/bin/bash
# Runs one line of a list of commands, for batch systems of every kind.
#
#   npdr tasks STUDY > tasks.txt                          # a line for all that can be made now
#   jobs/array-task.sh tasks.txt 3                        # runs its third line
#
# The number comes from the command line or from one variable: NPDR_INDEX, or that of the batch
# system's array (counted from 1):
#   qsub -J 1-$(wc -l < tasks.txt) -v LIST=tasks.txt jobs/array-task.sh              PBS
#   bsub -J "npdr[1-$(wc -l < tasks.txt)]" jobs/array-task.sh tasks.txt              LSF
#   qsub -cwd -t 1-$(wc -l < tasks.txt) jobs/array-task.sh tasks.txt                 Grid Engine
#   sbatch --array=1-$(wc -l < tasks.txt) jobs/array-task.sh tasks.txt               Slurm
#   seq $(wc -l < tasks.txt) | parallel jobs/array-task.sh tasks.txt                 GNU parallel
# When all have ended, list again: more can be made now. jobs/waves.sh does that on one machine.

set -euo pipefail
cd "${PBS_O_WORKDIR:-.}"
list=${1:-${LIST:?names the list of commands}}
index=${2:-${NPDR_INDEX:-${SLURM_ARRAY_TASK_ID:-${PBS_ARRAY_INDEX:-${LSB_JOBINDEX:-${SGE_TASK_ID:-}}}}}}
if ! [[ $index =~ ^[1-9][0-9]*$ ]]; then
  echo "array-task.sh: needs the number of a line, counted from 1; see the head of this file" >&2
  exit 2
fi
command=$(sed -n "${index}p" "$list")
if [[ -z $command ]]; then
  echo "array-task.sh: $list has no line $index" >&2
  exit 2
fi
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
eval "exec $command"
