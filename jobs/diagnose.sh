#!/bin/bash
#SBATCH --job-name=npdr-diagnose
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=2
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --kill-on-invalid-dep=yes
# Checks the posteriors of a study. The simulations of its calibration are among those of
# jobs/simulate.sh.
#
#   sbatch jobs/diagnose.sh STUDY [OPTION OF npdr-diagnose]...

export OMP_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
exec npdr task -- npdr-diagnose "$@"
