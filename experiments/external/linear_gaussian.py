#!/usr/bin/env python3
"""A simulator as npdr calls it: linear_gaussian.py THETA X.

    total      = a + b + 0.5 e1
    difference = a - b + 0.5 e2,   e1, e2 ~ N(0, 1)

With a, b ~ N(0, 1) their posterior is normal, with mean 4/9 (total + difference, total - difference)
and standard deviation 1/3.
"""
import csv
import os
import random
import sys

with open(os.environ["NPDR_SEEDS"]) as file:
    seeds = [int(line) for line in file]
with open(sys.argv[1], newline="") as file:
    theta = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]

with open(sys.argv[2], "w", newline="") as file:
    out = csv.writer(file)
    out.writerow(["total", "difference"])
    for row, seed in zip(theta, seeds):
        noise = random.Random(seed)  # a generator per row: no row's x depends on other rows
        total = row["a"] + row["b"] + 0.5 * noise.gauss(0.0, 1.0)
        difference = row["a"] - row["b"] + 0.5 * noise.gauss(0.0, 1.0)
        out.writerow([repr(total), repr(difference)])
