"""Densities and samples of a posterior of npdr that consists of weighted particles (infer.h5): those of
ABC, linear regression and refinement. Used like npdr_posterior.py.

Densities are those of Gaussian kernels with the particles' own covariance, made narrower (Scott 1992),
as docs/methods.md says.
"""
import h5py
import numpy as np
from npdr_posterior import Prior, log_normal

class Particles:
    def __init__(self, path):
        with h5py.File(path) as f:
            if "particles" not in f:
                raise ValueError(f"{path}: holds no particles; read it by npdr_posterior.py")
            group, self.prior = f["particles"], Prior(f)
            theta, weight = group["theta"][:], group["weight"][:]
            self.is_over_theta, self.is_smooth = group.attrs["space"] == "theta", group.attrs["smooth"] == 1
        self.theta, self.weight, self.names = theta, weight / weight.sum(), self.prior.names
        points = self.points(theta)
        is_finite = np.isfinite(points).all(axis=1)
        points, weight = points[is_finite], self.weight[is_finite]
        self.varying = np.ptp(points, axis=0) > 1e-12 * np.abs(points).max(axis=0)
        self.centers, weight = points[:, self.varying], weight / weight.sum()
        covariance = np.atleast_2d(np.cov(self.centers.T, aweights=weight))
        scale = np.sqrt(np.diag(covariance))
        correlation = covariance / np.outer(scale, scale) + 1e-9 * np.eye(len(scale))
        bandwidth = np.sum(weight**2) ** (1 / (len(scale) + 4))
        self.factor = bandwidth * scale[:, None] * np.linalg.cholesky(correlation)
        with np.errstate(divide="ignore"):
            self.log_weight = np.log(weight) - np.log(np.diag(self.factor)).sum()
    def points(self, theta):  # where the kernels are
        return theta if self.is_over_theta else self.prior.to_u(theta)[0]
    def log_prob(self, theta):
        whiten = np.linalg.inv(self.factor).T
        centers, at = self.centers @ whiten, self.points(theta)[:, self.varying] @ whiten
        log_p = [np.logaddexp.reduce(self.log_weight + log_normal(row - centers)) for row in at]
        return np.array(log_p) + (0 if self.is_over_theta else self.prior.to_u(theta)[1])
    def sample(self, n, rng):
        rows = rng.choice(len(self.theta), n, p=self.weight)
        if not self.is_smooth:
            return self.theta[rows]
        points = self.points(self.theta[rows])
        points[:, self.varying] += rng.standard_normal((n, len(self.factor))) @ self.factor.T
        return points if self.is_over_theta else self.prior.to_theta(points)
