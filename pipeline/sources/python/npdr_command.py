"""Makes a Python function that gives numbers x, in place of motion, a simulator of npdr.

    import npdr_command

    def simulate(theta, rng):
        total = theta["a"] + theta["b"] + 0.5 * rng.normal()
        return {"total": total}     # or a list of numbers, as an x_o without a header

    npdr_command.run(simulate)

A study names the program: simulator.command = "python3 sim.py {theta} {x}". theta["a"] is a
parameter; rng is numpy's random generator with the row's own seed. A result must depend on nothing
but these. A row with a number that isn't finite has no result. An exception fails the row that it
comes from, and no other.
"""

import csv
import os
import sys
import traceback

import numpy as np


def run(simulate):
    """Simulates each row of the file sys.argv[1], and writes them to sys.argv[2]."""
    if "NPDR_SEEDS" not in os.environ or len(sys.argv) < 3:
        sys.exit("npdr_command: started by hand; a study names this program: simulator.command = "
                 '"python3 %s {theta} {x}"' % os.path.basename(sys.argv[0]))
    with open(os.environ["NPDR_SEEDS"]) as file:
        seeds = [int(line) for line in file]
    with open(sys.argv[1], newline="", errors="replace") as file:
        if file.read(4).endswith("HDF"):
            sys.exit('npdr_command: reads CSV; leave out simulator.format = "hdf5"')
        file.seek(0)
        rows = [_Parameters({name: float(value) for name, value in row.items()})
                for row in csv.DictReader(file)]
    xs, failures = {}, {}
    for i, (theta, seed) in enumerate(zip(rows, seeds)):
        try:
            xs[i] = simulate(theta, np.random.default_rng(seed))
        except Exception as error:
            if not failures:
                traceback.print_exc()
            failures[i] = "%s: %s" % (type(error).__name__, error)
    if failures:
        _write_failures(failures)
    if xs:
        _write_xs(xs, len(rows))


def _write_failures(failures):
    with open(os.environ["NPDR_FAILED"], "w", errors="backslashreplace") as file:
        for row, why in failures.items():
            file.write("%d %s\n" % (row, " ".join(why.split())[:1000]))


def _write_xs(xs, num_rows):
    first = next(iter(xs.values()))
    names = list(first) if isinstance(first, dict) else None
    lines = {row: _numbers(x, names) for row, x in xs.items()}
    sizes = {len(line) for line in lines.values()}
    if len(sizes) > 1:
        raise ValueError("simulate() returned as many numbers as %s, must be as many in all rows"
                         % sorted(sizes))
    failed = ["nan"] * sizes.pop()
    with open(sys.argv[2], "w", newline="") as file:
        out = csv.writer(file)
        if names is not None:
            out.writerow(names)
        out.writerows(lines.get(row, failed) for row in range(num_rows))


def _numbers(x, names):
    if names is not None:
        if not isinstance(x, dict) or set(x) != set(names):
            raise ValueError("simulate() returned %s, must be numbers named %s, as of other rows"
                             % (x, ", ".join(map(str, names))))
        x = [x[name] for name in names]
    numbers = np.asarray(x)
    if np.iscomplexobj(numbers):
        raise TypeError("simulate() returned complex numbers, must be real ones")
    return [repr(float(value)) for value in numbers.astype(float).ravel()]


class _Parameters(dict):
    def __missing__(self, name):
        raise KeyError("the study has no parameter '%s'; it has %s" % (name, ", ".join(self)))
