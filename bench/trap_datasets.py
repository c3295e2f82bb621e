"""Finished simulations of bench_traps, theta and x, and their studies."""
from functools import partial

import numpy as np

from trap_recordings import network_lines

ROWS = 1000


class Marginal:
    def __init__(self, kind, a, b):
        self.text = f"{kind} = [{a}, {b}]"
        self.draw = {"normal": lambda rng, n: rng.normal(a, b, n),
                     "uniform": lambda rng, n: rng.uniform(a, b, n),
                     "log_uniform": lambda rng, n: np.exp(rng.uniform(np.log(a), np.log(b), n))}[kind]


def normal(*names):
    return {name: Marginal("normal", 0.0, 1.0) for name in names}


def uniform(low, high, *names):
    return {name: Marginal("uniform", low, high) for name in names}


# Simulators: x (n, F) of theta (n, D).


def noise(theta, rng, num_features, size):
    return size * rng.standard_normal((len(theta), num_features))


def linear(theta, rng):
    a, b = theta.T
    return np.column_stack([a + b, a - b]) + noise(theta, rng, 2, 0.5)


def mixed(theta, rng):
    d = theta.shape[1]
    return theta @ np.random.default_rng(7).standard_normal((d, 2 * d)) + noise(theta, rng, 2 * d, 0.3)


def curved(theta, rng):
    a, b = theta.T
    return np.column_stack([a + b**2, b - 0.5 * a, np.sin(2 * a)]) + noise(theta, rng, 3, 0.2)


def skewed(theta, rng):
    a, b = theta.T
    return np.exp(np.column_stack([a, b, a + b]) + noise(theta, rng, 3, 0.3))


def counts(theta, rng):
    a, b = theta.T
    return rng.poisson(np.exp(np.column_stack([1 + 0.5 * a, 1.5 + 0.5 * b, 1 + 0.3 * (a + b)]))).astype(float)


def growth(theta, rng):
    """Of a size by a rate."""
    return theta[:, :1] * np.exp(theta[:, 1:] * np.linspace(0.2, 1.0, 5)) * (1 + noise(theta, rng, 5, 0.1))


def heavy_tailed(theta, rng):
    return theta + 0.3 * rng.standard_t(3, theta.shape)


def of_first(theta, rng):
    return theta[:, :1] + noise(theta, rng, 2, 0.3)


class Dataset:
    """Faults and variants edit it before it is written."""

    def __init__(self, rng, prior=None, simulate=linear, rows=ROWS, truth=None):
        self.rng, self.prior, self.simulate = rng, prior or normal("a", "b"), simulate
        self.theta = np.column_stack([marginal.draw(rng, rows) for marginal in self.prior.values()])
        self.x = simulate(self.theta, rng)
        # Half as far from the prior's middle as a draw of it may be.
        drawn = np.array([[marginal.draw(rng, 1)[0] for marginal in self.prior.values()]])
        middle = np.median(self.theta, axis=0)
        self.x_o = simulate(middle + 0.5 * (drawn - middle) if truth is None else np.array([truth]), rng)[0]

    def set_theta(self, theta):
        self.theta, self.x = theta, self.simulate(theta, self.rng)

    def pick(self, share):
        return self.rng.choice(len(self.theta), round(share * len(self.theta)), replace=False)

    def write(self, folder, options):
        """Files of a user; the command that imports them."""
        names = [f"x{i}" for i in range(self.x.shape[1])]
        for name, values, header in (("theta", self.theta, self.prior), ("x", self.x, names), ("x_o", [self.x_o], names)):
            np.savetxt(folder / f"{name}.csv", values, "%.9g", ",", header=",".join(header), comments="")
        lines = ["[study]", 'name = "world"', "[target]", 'observation = "x_o.csv"', "[simulator]",
                 'dataset = "dataset.h5"', "[prior]"]
        lines += [f"{name} = {{ {marginal.text} }}" for name, marginal in self.prior.items()]
        lines += network_lines("dataset", len(self.theta), options)
        (folder / "study.toml").write_text("\n".join(lines) + "\n")
        return ["import", "--theta", "theta.csv", "--x", "x.csv", "-o", "dataset.h5"]


def drawn(theta):
    """Theta of another distribution, and x of it."""
    return lambda d: d.set_theta(theta(d))


def correlated(d):
    a = d.theta[:, 0]
    return np.column_stack([a, 0.4 * a + np.sqrt(1 - 0.16) * d.rng.standard_normal(len(a))])


def features(x):
    def fault(d):
        d.x = x(d)

    return fault


def observed(x_o):
    def fault(d):
        d.x_o = x_o(d.x_o)

    return fault


def without_tail(d):
    kept = d.theta[:, 0] < 1.0
    d.theta, d.x = d.theta[kept], d.x[kept]


def rows_of(x, share):
    """x in some rows is another: what `x` says, given the dataset and the rows."""

    def fault(d):
        rows = d.pick(share)
        d.x[rows] = x(d, rows)

    return fault


def copies(share, jitter):
    def fault(d):
        n = round(share * len(d.theta))
        for values in (d.theta, d.x):
            values[-n:] = values[:n] * (1 + jitter * d.rng.standard_normal((n, values.shape[1])))

    return fault


def last_rows(share, change):
    def fault(d):
        n = round(share * len(d.x))
        d.x[-n:] = change(d.x[-n:])

    return fault


def reversed_theta(d):
    d.theta = d.theta[:, ::-1].copy()


def dead_parameter(d):
    d.theta[:, 1] = d.rng.permutation(d.theta[:, 1])


# What was done, the words of a finding, or of its id, that name it, and what else is particular.
PRIOR, UNITS, PAIRS, COPIES = r"drawn|prior", r"unit|scale|outside of what", r"go with", r"copies|very x|the same"
BOX, FAILURES = uniform(-2, 2, "a", "b"), r"fail|further from all"
GROWTH = uniform(1, 3, "size") | uniform(0.5, 2, "rate")
FAULTS = {
    "prior_1.1": (drawn(lambda d: 1.1 * d.theta), PRIOR, {}),
    "prior_1.3": (drawn(lambda d: 1.3 * d.theta), PRIOR, {}),
    "prior_moved": (drawn(lambda d: d.theta + [0.2, 0.0]), PRIOR, {}),
    "prior_correlated": (drawn(correlated), r"correlated", {}),
    "prior_clipped": (drawn(lambda d: np.clip(1.3 * d.theta, -2, 2)), PRIOR + "|clipped|end of", {"prior": BOX}),
    "prior_inner_box": (drawn(lambda d: 0.8 * d.theta), PRIOR, {"prior": BOX}),
    "theta_constant": (drawn(lambda d: d.theta * [1, 0] + [0, 0.3]), r"in all rows|constant", {}),
    "without_tail": (without_tail, PRIOR + "|tail|missing", {}),
    "last_30_reversed": (last_rows(0.03, lambda x: x[::-1].copy()), PAIRS + "|order|row", {}),
    "next_row": (features(lambda d: np.roll(d.x, 1, axis=0)), PAIRS, {}),
    "sorted_x": (features(lambda d: d.x[np.argsort(d.x[:, 0])]), PAIRS, {}),
    "shuffled_part": (rows_of(lambda d, rows: d.x[d.rng.permutation(rows)], 0.3), PAIRS + "|row", {}),
    "theta_swapped": (reversed_theta, PAIRS + "|swap",
                      {"prior": normal("a") | {"b": Marginal("normal", 0.5, 0.8)}, "simulate": curved}),
    "same_rows": (rows_of(lambda d, rows: d.x[0].copy(), 0.03), COPIES, {}),
    "copies": (copies(0.1, 0.0), COPIES, {}),
    "copies_with_jitter": (copies(0.1, 1e-7), COPIES + "|nearly", {}),
    "failure_codes": (rows_of(lambda d, rows: (-999 + 0.001 * np.arange(len(rows)))[:, None], 0.11), FAILURES, {}),
    "one_code": (rows_of(lambda d, rows: -999.0, 0.05), FAILURES, {}),
    "dead_parameter": (dead_parameter, r"says little|nothing|dead", {"simulate": of_first}),
    "rounded": (features(lambda d: np.round(d.x)), r"round|integers|whole numbers|grid", {"simulate": curved}),
    "scaled_part_10": (last_rows(0.15, lambda x: 10 * x), UNITS, {}),
    "scaled_part_1000": (last_rows(0.02, lambda x: 1000 * x), UNITS, {}),
    "scaled_part_counts": (last_rows(0.3, lambda x: 2 * x), UNITS, {"simulate": counts}),
    "other_version": (last_rows(0.5, lambda x: x + 1), r"version|rows|halves|simulator", {}),
    "x_o_x1000": (observed(lambda x: 1000 * x), UNITS, {"truth": (0.8, -0.9)}),
    "x_o_x2": (observed(lambda x: 2 * x), UNITS, {"simulate": curved, "truth": (0.8, -1.2)}),
    "x_o_swapped": (observed(lambda x: x[::-1]), r"swap|order|convention|outside of what", {"simulate": growth, "prior": GROWTH}),
    "x_o_moved": (observed(lambda x: x + [0, 0, 0, 6]), r"lack|outside of what", {"simulate": mixed}),
    "x_o_sign": (observed(lambda x: -x), r"sign|outside of what", {"simulate": skewed}),
}


def latin(d):
    """A design: each thousandth of the box once."""
    n = len(d.theta)
    return np.column_stack([-2 + 4 * (d.rng.permutation(n) + d.rng.random(n)) / n for _ in range(2)])


def grid(d):
    steps = -2 + 4 * (np.arange(32) + 0.5) / 32
    return d.rng.permutation(np.array([(a, b) for a in steps for b in steps]))


def three_digits(d):
    d.x, d.x_o, d.theta = np.round(d.x, 3), np.round(d.x_o, 3), np.round(d.theta, 3)


def as_it_is(d):
    return d


RIGHT = {
    "plain": (as_it_is, {}),
    "plain_again": (as_it_is, {}),
    "few_rows": (as_it_is, {"rows": 300}),
    "many_rows": (as_it_is, {"rows": 3000}),
    "box": (as_it_is, {"prior": BOX, "simulate": curved}),
    "five_parameters": (as_it_is, {"prior": uniform(-1, 1, *"abcde"), "simulate": mixed}),
    "eight_parameters": (as_it_is, {"prior": normal(*"abcdefgh"), "simulate": mixed}),
    "one_parameter": (as_it_is, {"prior": normal("a"), "simulate": of_first}),
    "counts": (as_it_is, {"simulate": counts}),
    "skewed": (as_it_is, {"simulate": skewed}),
    "heavy_tailed": (as_it_is, {"simulate": heavy_tailed}),
    "rectified": (as_it_is, {"prior": normal(*"abc"), "simulate": lambda theta, rng: np.maximum(mixed(theta, rng) - 0.5, 0)}),
    "idle_features": (as_it_is, {"simulate": lambda theta, rng: np.column_stack(
        [linear(theta, rng), noise(theta, rng, 6, 1.0), np.full(len(theta), 3.0)])}),
    "growth": (as_it_is, {"prior": {"size": Marginal("log_uniform", 0.1, 100)} | uniform(0, 2, "rate"), "simulate": growth}),
    "narrow_prior": (as_it_is, {"prior": {"a": Marginal("normal", 3.0, 0.01), "b": Marginal("normal", 1.0, 1.0)},
                                "simulate": lambda theta, rng: linear((theta - [3, 1]) * [100, 1], rng)}),
    "near_the_end": (as_it_is, {"prior": BOX, "simulate": mixed, "truth": (1.85, 0.3)}),
    "x_o_rare": (as_it_is, {"truth": (2.0, 0.5)}),
    "latin": (drawn(latin), {"prior": BOX}),
    "grid": (drawn(grid), {"prior": BOX}),
    "replicates": (drawn(lambda d: np.repeat(d.theta[: len(d.theta) // 4], 4, axis=0)), {}),
    "some_failed": (rows_of(lambda d, rows: np.nan, 0.02), {}),
    "three_digits": (three_digits, {"simulate": curved}),
    "wide_noise": (as_it_is, {"simulate": lambda theta, rng: linear(theta, rng) + noise(theta, rng, 2, 1.5)}),
}


def worlds():
    """Device, name, whether it is right, what names its fault, how to begin it, what edits it."""
    for name, (fault, cause, options) in FAULTS.items():
        yield "dataset", name, False, cause, partial(Dataset, **options), fault
    for name, (variant, options) in RIGHT.items():
        yield "dataset", name, True, "", partial(Dataset, **options), variant
