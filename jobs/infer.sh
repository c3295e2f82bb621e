#!/bin/bash
#SBATCH --job-name=npdr-infer
#SBATCH --ntasks=1
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --kill-on-invalid-dep=yes
# Trains the posteriors whose simulations are there.
#
#   sbatch jobs/infer.sh STUDY [OPTION OF npdr-infer]...

export OMP_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
exec npdr task -- npdr-infer "$@"
