#!/bin/bash
# Brings a study up to date on one machine, a wave of independent commands at a time.
#
#   jobs/waves.sh STUDY [OPTION OF npdr tasks]...
#
# JOBS says how many commands run side by side (all cores). 'npdr run' does the same without waiting
# for the slowest command of a wave: this script is here to be changed.

set -euo pipefail
if (($# == 0)); then
  sed -n '2,/^$/ s/^# \{0,1\}//p' "$0"
  exit 2
fi
here=$(dirname "$(readlink -f "$0")")
list=$(mktemp)
trap 'rm -f "$list"' EXIT
npdr tasks "$@" >"$list"
while [[ -s $list ]]; do
  seq "$(wc -l <"$list")" | xargs -P "${JOBS:-$(nproc)}" -n 1 "$here/array-task.sh" "$list"
  npdr tasks "$@" >"$list"
done
