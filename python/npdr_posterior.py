"""Densities and samples of a trained posterior of npdr (infer.h5), with numpy and h5py alone.

    posterior = Posterior("infer.h5")
    theta = posterior.sample(1000, np.random.default_rng(1))  # (1000, D), columns posterior.names
    posterior.log_prob(theta)                                 # (1000) [nats]

docs/file-formats.md says what stands in the file, docs/methods.md where the equations come from;
npdr_particles.py reads those of ABC, linear regression and refinement.
"""
import json
import math
from statistics import NormalDist
import h5py
import numpy as np

SCHEMA = 24  # of posteriors
normal_quantile = np.vectorize(NormalDist().inv_cdf, otypes=[float])
normal_cdf = np.vectorize(lambda u: 0.5 * math.erfc(-u / math.sqrt(2)), otypes=[float])

def read(group):
    return {**group.attrs, **{name: values[:] for name, values in group.items()}}

def log_normal(u):
    return -0.5 * np.sum(u**2, axis=-1) - 0.5 * u.shape[-1] * math.log(2 * math.pi)

def log_mean(networks, u, z):  # of their densities
    return np.logaddexp.reduce([network.log_prob(u, z) for network in networks]) - math.log(len(networks))

def transformed(x, t):  # (1, F + K or k)
    x = np.asarray(x, float)
    if "center" in t:
        scale, copies = t["inverse_scale"], x[t["inverse_scale"] > 0]
        x = np.where(scale > 0, np.arcsinh(np.clip((x - t["center"]) * scale, -1e30, 1e30)), x)
        x = np.concatenate([x, copies]) if len(t["mean"]) > len(x) else x
    z = ((x - t["mean"]) * t["inverse_deviation"])[None]
    far = t["farthest"]
    z = np.where(abs(z) > far, np.sign(z) * (far + np.log(np.clip(abs(z), far, 1e36) / far)), z)
    return z @ t["basis"] if "basis" in t else z

def positive(a):  # 1 at 0, at least 1e-3
    return np.logaddexp(0, a + math.log(math.expm1(1 - 1e-3))) + 1e-3

class Prior:  # u = Phi^-1(F(theta)), parameter by parameter
    def __init__(self, file):
        marginals = json.loads(file.attrs["prior"])
        self.names = [m["name"] for m in marginals]
        kinds, pairs = zip(*(next((k, v) for k, v in m.items() if isinstance(v, list)) for m in marginals))
        if {"gamma", "beta"} & set(kinds) or any("lower" in m or "upper" in m for m in marginals):
            raise ValueError("priors that are gamma, beta or cut off: npdr sample and npdr log-prob read them")
        self.is_log = np.array([k.startswith("log_") for k in kinds])
        self.is_bounded = np.array([k.endswith("uniform") for k in kinds])
        pairs = [np.log(pair) if kind == "log_uniform" else pair for kind, pair in zip(kinds, pairs)]
        self.a, b = np.transpose(pairs)
        self.width = np.where(self.is_bounded, b - self.a, b)
    def to_u(self, theta):  # (n, D), and log |du / dtheta|
        with np.errstate(all="ignore"):
            t = np.where(self.is_log, np.log(theta), theta)
        share = (t - self.a) / self.width
        is_inside = np.isfinite(t) & (~self.is_bounded | (share >= 0) & (share <= 1))
        t, share = np.where(is_inside, t, 0), np.where(is_inside, share, 0.5)
        u = np.where(self.is_bounded, normal_quantile(np.clip(share, 2.0**-53, 1 - 2.0**-53)), share)
        log_slope = -np.log(self.width) - self.is_log * t - self.is_bounded * log_normal(u[..., None])
        return u, np.where(is_inside, log_slope, -np.inf).sum(1)
    def to_theta(self, u):
        t = self.a + self.width * np.where(self.is_bounded, normal_cdf(u), u)
        return np.where(self.is_log, np.exp(np.where(self.is_log, t, 0)), t)

def spline(v, p, inverse=False):  # of v (n, V) with numbers p (n, 3 bins - 1, V): z, or back; log slope
    if p.shape[1] == 0:  # the flow is affine
        return v, 0 * v
    bins, ends = (p.shape[1] + 1) // 3, np.ones_like(v[:, None])
    shares = [np.exp(a - a.max(1, keepdims=True)) for a in np.split(p[:, : 2 * bins], 2, axis=1)]
    sizes = [10 * (1e-3 + (1 - 1e-3 * bins) * s / s.sum(1, keepdims=True)) for s in shares]
    knots = [np.concatenate([-5 * ends, np.cumsum(s, 1) - 5], 1) for s in sizes]
    slopes = np.concatenate([ends, positive(p[:, 2 * bins :]), ends], 1)
    k = np.sum(knots[inverse][:, 1:-1] <= v[:, None], axis=1, keepdims=True)
    x, y, w, h, d0 = (np.take_along_axis(a, k, 1)[:, 0] for a in [*knots, *sizes, slopes])
    d1, s, is_inside = np.take_along_axis(slopes, k + 1, 1)[:, 0], h / w, np.abs(v) < 5
    bend = d1 + d0 - 2 * s
    if inverse:
        a, b, c = h * (s - d0) + (v - y) * bend, h * d0 - (v - y) * bend, s * (y - v)
        return np.where(is_inside, x - 2 * w * c / (b + np.sqrt(np.maximum(0, b * b - 4 * a * c))), v), None
    xi = (v - x) / w
    q = xi * (1 - xi)
    slope = s**2 * (d1 * xi**2 + 2 * s * q + d0 * (1 - xi) ** 2) / (s + bend * q) ** 2
    z = y + h * (s * xi**2 + d0 * q) / (s + bend * q)
    return np.where(is_inside, z, v), np.log(np.where(is_inside, slope, 1))

class Network:
    def __init__(self, group, config, embedding):
        self.w, self.is_ratio, self.embedding = read(group), config["kind"] == "resnet", embedding
        self.layers = range(1, config["num_hidden_layers"] + 1)
        self.transforms = range(1, config["num_transforms"] + 1)
    def dense(self, name, x):
        return x @ np.float64(self.w[name + ".weight"]) + self.w[name + ".bias"]
    def embed(self, z):  # through the trained layers, where there are some
        if "linear.weight" not in self.w:
            return z
        e, layer = self.embedding, 0
        y = z.reshape(-1, e["num_steps"] or 1, e["num_channels"] or z.shape[1])  # (rollouts, steps, channels)
        while f"convolution_{(layer := layer + 1)}.weight" in self.w:
            kernel = min(8, y.shape[1])
            patches = np.lib.stride_tricks.sliding_window_view(y[:, (y.shape[1] - kernel) % 4 :], kernel, axis=1)[:, ::4]
            y = np.maximum(0, self.dense(f"convolution_{layer}", patches.swapaxes(2, 3).reshape(*patches.shape[:2], -1)))
        y = y.reshape(len(z), -1, y.shape[1] * y.shape[2])
        return self.dense("linear", y.mean(1) if e["average_rollouts"] else y.reshape(len(z), -1))
    def log_prob(self, u, z):  # log q(u | z) of a flow, the log ratio of a ratio network
        c = self.embed(z)
        if self.is_ratio:
            h = self.dense("x", c) + u @ self.w["u.weight"]
            for k in self.layers:
                h = h + self.dense(f"block_{k}.b", np.maximum(0, self.dense(f"block_{k}.a", np.maximum(0, h))))
            return self.dense("output", np.maximum(0, h))[:, 0]
        log_det = 0
        for k in self.transforms:
            u = u[:, self.w[f"transform_{k}.order"]]
            scale, shift, of_spline = self.numbers(k, u, c)
            u, log_slope = spline(u * scale + shift, of_spline)
            log_det = log_det + np.sum(np.log(scale) + log_slope, axis=1)
        return log_normal(u) + log_det
    def numbers(self, k, u, c):  # that transform k maps u with
        name, h = f"transform_{k}.", np.split(self.dense("context", c), len(self.transforms), axis=1)[k - 1]
        h = np.tanh(h + u @ self.w[name + "input.weight"])
        for layer in self.layers[:-1]:
            h = np.tanh(self.dense(f"{name}hidden_{layer}", h))
        p = self.dense(name + "output", h)
        p = p.reshape(len(u), p.shape[1] // u.shape[1], u.shape[1])
        return positive(p[:, 0]), p[:, 1], p[:, 2:]
    def sample(self, z, n, rng):  # of a flow
        c = self.embed(z)
        z = rng.standard_normal((n, len(self.w["transform_1.order"])))
        for k in reversed(self.transforms):
            u = np.zeros_like(z)
            for d in range(z.shape[1]):  # whose numbers depend on those before it
                scale, shift, of_spline = self.numbers(k, u, c)
                u[:, d] = ((spline(z, of_spline, inverse=True)[0] - shift) / scale)[:, d]
            z[:, self.w[f"transform_{k}.order"]] = u
        return z

class Posterior:  # exp(log_q + log_weight) / Z: of networks q, of likelihoods l, or of both, pooled
    def __init__(self, path):
        with h5py.File(path) as f:
            if [f.attrs.get(k) for k in ("schema", "schema_version")] != ["posterior", SCHEMA] or "network_1" not in f:
                raise ValueError(f"{path}: not a trained posterior of schema {SCHEMA}; npdr run makes one")
            embedding = json.loads(f.attrs["trained_embedding"])
            config, self.prior, self.role = json.loads(f.attrs["density_estimator"]), Prior(f), f.attrs["network_role"]
            names = [f"network_{m + 1}" for m in range(config["num_networks"])]
            self.networks, self.pool = [Network(f[name], config, embedding) for name in names], {}
            self.likelihoods = self.networks
            if self.role != "posterior":  # q is the prior
                self.networks, self.pool = [], dict.fromkeys(("posterior_power", "likelihood_power", "posterior_power_at_x_o",
                                                         "likelihood_power_at_x_o"), 1)
            elif "likelihood" in f:
                self.pool, config = dict(f["likelihood"].attrs), json.loads(f["likelihood"].attrs["density_estimator"])
                self.likelihoods = [Network(f["likelihood"][name], config, {}) for name in names]
            self.names, self.x_o = self.prior.names, f["x_o"][:]
            self.transforms = [read(f["transform"]), read(f["likelihood/transform" if "likelihood" in f else "transform"])]
            self.mixture = read(f["mixture"]) if "mixture" in f else {}
        if "head.weight" in self.likelihoods[0].w and not self.mixture:
            raise ValueError(f"{path}: a mixture as likelihood can't be read here; use npdr log-prob")
    def features(self, x):  # that q sees and that l does, (1, F or k)
        if self.mixture and x is not None:
            raise ValueError("the file has its mixture at x_o alone; use npdr log-prob --x")
        return [transformed(self.x_o if x is None else x, t) for t in self.transforms]
    def log_q(self, u, z):
        if self.mixture:
            y = np.einsum("kij,nkj->nki", self.mixture["factor"], u[:, None] - self.mixture["mean"])
            log_det = np.log(np.einsum("kii->ki", self.mixture["factor"])).sum(1)
            return np.logaddexp.reduce(self.mixture["log_weight"] + log_det + log_normal(y), axis=1)
        return log_mean(self.networks, u, z[0]) if self.networks else log_normal(u)
    def log_weight(self, u, z, at_x_o):  # of draws of q: (q / N)^(a - 1) l^b
        if not self.pool:
            return 0
        log_l = log_mean(self.likelihoods, *((u, z[1]) if self.role == "ratio" else (np.repeat(z[1], len(u), 0), u)))
        a, b = (self.pool[power + ("_at_x_o" if at_x_o else "")] for power in ("posterior_power", "likelihood_power"))
        return (a - 1) * (self.log_q(u, z) - log_normal(u)) + b * log_l
    def log_prob(self, theta, x=None):  # up to a constant: roles likelihood and ratio, a pool at another x
        (u, log_slope), z = self.prior.to_u(theta), self.features(x)
        log_p = self.log_q(u, z) + self.log_weight(u, z, x is None) + log_slope
        return log_p - self.pool.get("log_normalizer_at_x_o", 0)
    def draw_q(self, z, n, rng):
        if self.mixture:
            k = rng.choice(len(self.mixture["mean"]), n, p=np.exp(self.mixture["log_weight"]))
            y = np.linalg.solve(self.mixture["factor"][k], rng.standard_normal((n, len(self.names), 1)))
            return self.mixture["mean"][k] + y[..., 0]
        if not self.networks:
            return rng.standard_normal((n, len(self.names)))
        counts = rng.multinomial(n, np.full(len(self.networks), 1 / len(self.networks)))
        return rng.permutation(np.concatenate([net.sample(z[0], k, rng) for net, k in zip(self.networks, counts)]))
    def sample(self, n, rng, x=None, num_candidates=100_000):
        z = self.features(x)
        u = self.draw_q(z, num_candidates if self.pool else n, rng)
        if self.pool:  # resampled by their weight
            log_w = self.log_weight(u, z, x is None)
            u = u[rng.choice(len(u), n, p=np.exp(log_w - np.logaddexp.reduce(log_w)))]
        return self.prior.to_theta(u)
