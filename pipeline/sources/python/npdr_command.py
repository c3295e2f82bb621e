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
    lines, failures = {}, {}
    for i, (theta, seed) in enumerate(zip(rows, seeds)):
        try:
            lines[i] = _numbers(simulate(theta, np.random.default_rng(seed)))
        except (Exception, SystemExit) as error:
            failures[i] = traceback.format_exception_only(type(error), error)[-1]
            traceback.print_exc()
    if failures:
        with open(os.environ["NPDR_FAILED"], "wb") as file:
            for row, why in failures.items():
                words = " ".join(why.split()).encode("utf-8", "backslashreplace")
                file.write(b"%d %s\n" % (row, words[:1000]))
    if lines:
        _write_x(lines, len(rows))


def _numbers(x):
    """x as texts, by their names where it has any."""
    if x is None:
        raise TypeError("simulate() returned None, must be numbers")
    if not isinstance(x, dict):
        return _texts(x)
    texts = _texts(list(x.values()))
    if len(texts) != len(x):
        raise ValueError("simulate() returned %d numbers with %d names" % (len(texts), len(x)))
    return dict(zip(x, texts))


def _texts(x):
    numbers = np.asarray(x)
    if np.iscomplexobj(numbers):
        raise TypeError("simulate() returned complex numbers, must be real ones")
    return list(map(repr, numbers.astype(float).ravel().tolist()))


def _write_x(lines, num_rows):
    """Writes the rows, those that aren't among `lines` as failed ones."""
    first = next(iter(lines.values()))
    for line in lines.values():
        if _kind(line) != _kind(first):  # neither of them is to blame: the call fails
            raise ValueError("simulate() returned %s and %s, must be the same of all rows"
                             % (_words(first), _words(line)))
    with open(sys.argv[2], "w", newline="") as file:
        out = csv.writer(file)
        if isinstance(first, dict):
            out.writerow(first)
        for row in range(num_rows):
            line = lines.get(row, ["nan"] * len(first))
            out.writerow([line[name] for name in first] if isinstance(line, dict) else line)


def _kind(line):
    return set(line) if isinstance(line, dict) else len(line)


def _words(line):
    named = "numbers named %s" % ", ".join(map(str, line))
    return named if isinstance(line, dict) else "%d numbers" % len(line)


class _Parameters(dict):
    def __missing__(self, name):
        raise KeyError("the study has no parameter '%s'; it has %s" % (name, ", ".join(self)))
