#!/bin/sh
# The simulator of linear_gaussian.py for any POSIX shell and awk: linear_gaussian.sh THETA X.
#
# FAIL=crash: dies of a segmentation fault when one of its rows is bad, one in twenty.
# FAIL=hang: never comes back from a bad row, one in two hundred.
# Whether a row is bad is a function of its seed alone.
exec awk -F, -v seeds="$NPDR_SEEDS" -v fail="$FAIL" '
  # Park and Miller (1988): the same numbers from every awk.
  function uniform() { state = (16807 * state) % 2147483647; return state / 2147483647 }
  function normal(  radius) {
    radius = sqrt(-2 * log(uniform()))
    return radius * cos(6.283185307179586 * uniform())
  }
  NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; print "total,difference"; next }
  {
    getline seed < seeds
    if (fail == "crash" && seed % 20 == 0) system("kill -SEGV $PPID")
    if (fail == "hang" && seed % 200 == 0) system("sleep 1000")
    state = seed % 2147483646 + 1
    for (i = 0; i < 5; ++i) uniform()
    a = $column["a"]; b = $column["b"]
    printf "%.17g,%.17g\n", a + b + 0.5 * normal(), a - b + 0.5 * normal()
  }' "$1" > "$2"
