#!/bin/bash
#SBATCH --job-name=npdr-report
#SBATCH --ntasks=1
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#SBATCH --kill-on-invalid-dep=yes
# Makes tables, figures and report.html.
#
#   sbatch jobs/report.sh STUDY [OPTION OF npdr-report]...

export OMP_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
exec npdr task -- npdr-report "$@"
