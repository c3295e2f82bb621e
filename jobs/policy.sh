#!/bin/bash
#SBATCH --job-name=npdr-policy
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=2
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --kill-on-invalid-dep=yes
# Searches for the policies of a study with a table [policy] whose posteriors are there, and tests
# them. Where methods have several iterations, jobs/prepare.sh then collects the rollouts of the next.
#
#   sbatch jobs/policy.sh STUDY [OPTION OF npdr-policy]...

export OMP_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
exec npdr task -- npdr-policy "$@"
