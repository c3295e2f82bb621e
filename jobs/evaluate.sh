#!/bin/bash
#SBATCH --job-name=npdr-evaluate
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=2
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --kill-on-invalid-dep=yes
# Judges the posteriors that are there by rollouts of their samples, and finds the floor.
#
#   sbatch jobs/evaluate.sh STUDY [OPTION OF npdr-evaluate]...

export OMP_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
exec npdr task -- npdr-evaluate "$@"
