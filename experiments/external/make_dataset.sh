#!/bin/sh
# Simulations that somebody has made elsewhere: make_dataset.sh FOLDER writes theta.csv and x.csv,
# 1000 rows of a, b ~ N(0, 1) and of what linear_gaussian.sh makes of them.
here=$(dirname "$0")
awk 'BEGIN {
  print "a,b"
  state = 20240301
  for (i = 0; i < 1000; ++i) {
    for (k = 0; k < 2; ++k) {
      state = (16807 * state) % 2147483647; u = state / 2147483647
      state = (16807 * state) % 2147483647; v = state / 2147483647
      z[k] = sqrt(-2 * log(u)) * cos(6.283185307179586 * v)
    }
    printf "%.17g,%.17g\n", z[0], z[1]
  }
}' > "$1/theta.csv"
awk 'BEGIN { for (i = 1; i <= 1000; ++i) print 7919 * i }' > "$1/seeds.txt"
NPDR_SEEDS="$1/seeds.txt" FAIL='' sh "$here/linear_gaussian.sh" "$1/theta.csv" "$1/x.csv"
rm "$1/seeds.txt"
