#!/bin/bash
#SBATCH --job-name=npdr-simulate
#SBATCH --ntasks=1
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --kill-on-invalid-dep=yes
# Simulates one shard of every simulation whose proposal is there; the last shard joins them all.
#
#   sbatch --array=0-9 jobs/simulate.sh STUDY [OPTION OF npdr-simulate]...
#
# A simulation of N rows has shards 0 to (N - 1) / simulate.shard_size. --round 2, --seeds 1 and
# --only 'NPDR (MAF)' pick some of the simulations.

export OMP_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
exec npdr task -- npdr-simulate "$@" --shard "${SLURM_ARRAY_TASK_ID:?submit this script as an array}"
