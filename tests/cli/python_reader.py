"""Compares what python/ makes of a posterior file with what npdr printed: densities of rows of theta to
5e-5, as the program sums them in single precision, quartiles of samples within what their number allows.

    python3 python_reader.py FOLDER POSTERIOR THETA.csv LOG_PROB.csv

FOLDER: that of the readers. THETA.csv: `npdr sample`; LOG_PROB.csv: `npdr log-prob` of it.
"""
import sys

import h5py
import numpy as np

folder, path, theta_csv, log_prob_csv = sys.argv[1:]
sys.path.insert(0, folder)
sys.dont_write_bytecode = True
from npdr_particles import Particles
from npdr_posterior import Posterior

with h5py.File(path) as f:
    posterior = (Particles if "particles" in f else Posterior)(path)
theta = np.loadtxt(theta_csv, delimiter=",", skiprows=1, ndmin=2)
expected = np.loadtxt(log_prob_csv, skiprows=1)
found = posterior.log_prob(theta)
if getattr(posterior, "role", "posterior") != "posterior":
    found += np.mean(expected - found)  # up to a constant
error = np.max(np.abs(found - expected))

outside = posterior.log_prob(np.outer([1e3, -1e3], np.isfinite(theta[0])))
fewer = {"num_candidates": 20_000} if getattr(posterior, "pool", {}) else {}  # than by default, for time
samples = posterior.sample(len(theta), np.random.default_rng(1), **fewer)
few = []  # of one network each
if getattr(posterior, "role", "") == "posterior" and not posterior.pool:
    few = [posterior.sample(1, np.random.default_rng(seed)) for seed in range(10)]
spread = theta.std(axis=0)
moved = np.max(np.abs(np.quantile(samples, [0.25, 0.5, 0.75], axis=0) - np.quantile(theta, [0.25, 0.5, 0.75], axis=0)) / spread)
print(f"{path}: densities differ by {error:.1e}, quartiles by {moved:.2f} deviations")
if any(one.shape != (1, theta.shape[1]) for one in few):
    sys.exit("a single sample has shape " + str([one.shape for one in few]))
if error > 5e-5 or moved > 10 / np.sqrt(len(theta)) or not np.all(outside == -np.inf):
    sys.exit(1)
