#!/bin/bash
#SBATCH --job-name=npdr-prepare
#SBATCH --ntasks=1
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --kill-on-invalid-dep=yes
# Makes the target domain and the proposals that can be drawn: a moment.
#
#   sbatch jobs/prepare.sh STUDY [OPTION OF npdr-propose]...
#
# The programs must be on the PATH; 'npdr submit' writes scripts with their own paths.

export OMP_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
exec npdr task -- npdr-propose "$@"
