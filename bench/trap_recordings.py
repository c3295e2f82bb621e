"""Recordings of bench_traps, of three devices, and the studies that a user would write around them.

Devices are integrated here, by the equations of sim/pendulum.h, sim/furuta.h and experiments/external/spring/spring.c,
so that they may have what these simulators lack.
"""
import math
import pathlib
import sys
from dataclasses import dataclass
from functools import partial

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
SUBSTEPS = 10  # of a time step


def pendulum(p, y, torque):
    angle, rate = y
    inertia = p["pole_mass"] * p["pole_length"] ** 2 / 3
    pull = torque - p["damping"] * rate - p["dry_friction"] * math.tanh(50 * rate)
    return rate, (pull - p["pole_mass"] * 9.81 * p["pole_length"] / 2 * math.sin(angle)) / inertia


def furuta(p, y, voltage):
    _, alpha, theta_dot, alpha_dot = y
    half = p["pole_mass"] * p["pole_length"] / 2
    w1, w2 = half * p["pole_length"] / 2, half * p["rotary_length"]
    gain = p["motor_constant"] / p["motor_resistance"]
    s, c = math.sin(alpha), math.cos(alpha)
    tau = gain * min(max(voltage, -4.5), 4.5) - p["dry_friction"] * math.tanh(theta_dot / 0.3)
    m11 = (p["rotary_mass"] / 12 + p["pole_mass"]) * p["rotary_length"] ** 2 + w1 * s * s
    m12, m22 = w2 * c, 4 / 3 * w1
    drag = p["motor_constant"] * gain + p["rotary_damping"]
    c1 = 2 * w1 * s * c * theta_dot * alpha_dot - w2 * s * alpha_dot**2 + drag * theta_dot
    c2 = -w1 * s * c * theta_dot**2 + half * 9.81 * s + p["pole_damping"] * alpha_dot
    det = m11 * m22 - m12 * m12
    return theta_dot, alpha_dot, (m22 * (tau - c1) + m12 * c2) / det, (-m11 * c2 - m12 * (tau - c1)) / det


def runge_kutta(slope):
    def step(p, y, u, dt):
        h = dt / SUBSTEPS
        for _ in range(SUBSTEPS):
            a = slope(p, y, u)
            b = slope(p, [q + h / 2 * r for q, r in zip(y, a)], u)
            c = slope(p, [q + h / 2 * r for q, r in zip(y, b)], u)
            d = slope(p, [q + h * r for q, r in zip(y, c)], u)
            y = [q + h / 6 * (k + 2 * l + 2 * m + n) for q, k, l, m, n in zip(y, a, b, c, d)]
        return y

    return step


def spring_step(p, y, force, dt):
    q, v = y
    h = dt / SUBSTEPS
    for _ in range(SUBSTEPS):
        pull = force - p["stiffness"] * q - p["damping"] * v
        v += h / p["mass"] * (pull - p["friction"] * math.tanh(100 * v))
        q += h * v
    return [q, v]


@dataclass
class Device:
    name: str
    step: callable
    dt: float  # [s]
    steps: int  # of a rollout
    columns: list  # of states: positions, then their rates
    action: str
    nominal: dict
    spread: dict  # ranges of what is inferred; a fault is one of the first of them
    more: dict  # of what may be inferred, too
    sines: tuple  # of the action: amplitude of each, lowest and highest frequency [Hz]
    friction: tuple  # that simulations may lack: parameter, value
    damping: tuple
    known: tuple  # a parameter that scales actions, one whose wrong value shows
    homing: tuple  # gains that move it back, from where
    first: list  # state in motion


DEVICES = (
    Device("pendulum", runge_kutta(pendulum), 0.02, 250, ["theta [rad]", "theta_dot [rad/s]"], "torque [N m]",
           dict(pole_mass=1.0, pole_length=1.0, damping=0.2, dry_friction=0.0),
           dict(pole_mass=(0.5, 1.5), pole_length=(0.5, 1.5), damping=(0.0, 0.6)), dict(gravity=(8.0, 11.0)),
           (1.2, 0.2, 1.2), ("dry_friction", 0.4), ("damping", 0.4), ("pole_mass", "pole_mass"), (20.0, 5.0, 0.5),
           [0.3, 0.5]),
    Device("spring", spring_step, 0.02, 250, ["q [m]", "v [m/s]"], "force [N]",
           dict(mass=1.0, stiffness=23.0, damping=0.6, friction=0.4),
           dict(stiffness=(10.0, 40.0), damping=(0.0, 1.5), friction=(0.0, 1.0)), dict(mass=(0.5, 2.0)),
           (3.0, 0.2, 2.0), ("friction", 1.0), ("damping", 1.0), ("mass", "mass"), (60.0, 8.0, 0.3), [0.2, 0.6]),
    Device("furuta", runge_kutta(furuta), 0.004, 400,
           ["theta [rad]", "alpha [rad]", "theta_dot [rad/s]", "alpha_dot [rad/s]"], "voltage [V]",
           dict(rotary_damping=3e-4, pole_damping=2e-5, motor_resistance=8.4, motor_constant=0.042, rotary_mass=0.095,
                pole_mass=0.024, rotary_length=0.085, pole_length=0.129, dry_friction=0.0),
           dict(rotary_damping=(0.0, 1e-3), pole_damping=(0.0, 5e-5), motor_resistance=(5.0, 12.0),
                pole_mass=(0.012, 0.036), pole_length=(0.09, 0.17)),
           dict(rotary_mass=(0.05, 0.15), rotary_length=(0.06, 0.12), motor_constant=(0.02, 0.07)),
           (0.8, 1.0, 5.0), ("dry_friction", 2e-3), ("rotary_damping", 8e-4), ("motor_resistance", "rotary_length"),
           (8.0, 0.4, 0.6), [0.3, 0.3, 0.5, 0.5]),
)
HIDDEN = "dry_friction"  # of a device; no simulator has it under that name


def sines(r):
    amplitude, *band = r.device.sines
    t = np.arange(r.steps + 1) * r.device.dt
    frequencies = np.geomspace(*band, 4) * r.rng.uniform(0.85, 1.15, 4)
    phases = r.rng.uniform(0, 2 * np.pi, 4)
    return amplitude * np.minimum(t / 0.4, 1.0) * sum(
        np.sin(2 * np.pi * f * t + p) for f, p in zip(frequencies, phases))


class Recording:
    """Rollouts and their study. Faults and variants edit it; functions among its fields take it first."""

    excite = staticmethod(sines)
    feel = staticmethod(lambda r, actions: actions)  # what the device feels of them
    feedback = staticmethod(lambda r, t, y: None)  # in place of an action
    change = staticmethod(lambda r, rollout: {})  # parameters of a rollout that differ
    sense = staticmethod(lambda r, states: states)  # what sensors give, before noise
    draw_noise = staticmethod(lambda r, shape: r.rng.standard_normal(shape))
    log = staticmethod(lambda r, t, states, actions: (t, states, actions))  # what files say
    rollouts, held_out = 3, 1
    noise = 0.02  # of the largest magnitude
    is_first_noisy = False
    declared = None  # [observation_noise]; None: as it is
    copies = {}  # rollouts that are copies of the one before
    refine = ""
    methods = ("default", "refine")
    worker = None  # lines of spring.py and what replaces them: a simulator in Python

    def __init__(self, device, rng):
        self.device, self.rng, self.steps = device, rng, device.steps
        self.num_positions = len(device.columns) // 2
        self.first = [0.0] * len(device.columns)
        self.truth = dict(device.nominal)
        for name in device.spread:
            self.truth[name] *= rng.uniform(0.85, 1.15)
        self.telling = list(device.spread)[-1 if device.name == "furuta" else 0]  # what tells most
        self.prior, self.known = {}, {name: value for name, value in device.nominal.items() if name != HIDDEN}
        self.infer(*device.spread)

    def infer(self, *names):
        """These parameters, and no other; what isn't inferred is known."""
        ranges = self.device.spread | self.device.more
        self.known |= {name: self.truth[name] for name in self.prior if name not in names}
        self.prior = {name: "uniform = [{}, {}]".format(*ranges[name]) for name in names}

    def set_known(self, name, value):
        self.prior.pop(name, None)
        self.known[name] = value

    def rollout(self, number):
        d, p = self.device, self.truth | self.change(self, number)
        actions = self.excite(self)
        felt = self.feel(self, actions)
        states = [list(self.first)]
        for t in range(self.steps):
            forced = self.feedback(self, t * d.dt, states[-1])
            states.append(d.step(p, states[-1], felt[t] if forced is None else forced, d.dt))
        states = self.sense(self, np.array(states))
        noise = self.noise * np.abs(states[1:]).max(axis=0) * self.draw_noise(self, states.shape)
        if not self.is_first_noisy:
            noise[0] = 0.0
        return self.log(self, np.arange(self.steps + 1) * d.dt, states + noise, actions)

    def write(self, folder, options):
        """Files of a user; the command that imports them."""
        files = []
        for i in range(self.rollouts):
            t, states, actions = rollout = self.rollout(i) if i not in self.copies else rollout
            files.append(f"rollout{i + 1}.csv")
            header = ",".join(["t [s]", *self.device.columns, self.device.action])
            np.savetxt(folder / files[-1], np.column_stack([t, states, actions]), "%.9g", ",", header=header, comments="")
        (folder / "study.toml").write_text("\n".join(self.study(options)) + "\n")
        if self.worker is not None:
            text = (ROOT / "experiments/external/spring/spring.py").read_text()
            for old, new in self.worker:
                assert old in text
                text = text.replace(old, new)
            (folder / "sim.py").write_text(text)
        channels = ["--states", ",".join(self.device.columns), "--actions", self.device.action]
        if self.device.name != "spring":
            channels = ["--simulator", self.device.name]
        return ["import", *files, *channels, "-o", "recording.h5"]

    def simulator(self, options):
        yield f"store_every = {10 if self.device.name == 'furuta' else 5}"
        known = {name: value for name, value in self.known.items() if name not in self.prior}
        if known:
            yield "parameters = { " + ", ".join(f"{name} = {value:.9g}" for name, value in known.items()) + " }"
        if self.device.name != "spring":
            yield f'name = "{self.device.name}"'
        elif self.worker is None:
            yield f'library = "{options.library}"'
        else:
            yield from [f'worker = "{sys.executable} sim.py"', 'states = ["q [m]", "v [m/s]"]', 'actions = ["force [N]"]']
            for name, value in self.device.nominal.items():
                yield from ["[[simulator.parameter]]", f'name = "{name}"', f"nominal = {value}"]

    def study(self, options):
        yield from ["[study]", 'name = "world"', "[target]", 'recording = "recording.h5"']
        if self.held_out:
            yield from [f"num_rollouts = {self.rollouts - self.held_out}", f"held_out = {self.held_out}"]
        yield from ["[simulator]", *self.simulator(options), "[prior]"]
        yield from [f"{name} = {{ {text} }}" for name, text in self.prior.items()]
        yield from ["[observation_noise]", self.declared or f"scale = {self.noise}"]
        if "default" in self.methods:
            yield from network_lines("default", options.num_simulations, options)
        if "refine" in self.methods:
            start = 'start = "default", ' if "default" in self.methods else ""
            yield from ["[[method]]", 'name = "refine"', 'algorithm = "refine"',
                        f"refine = {{ {start}{self.refine}level_size = 2000, min_ess = 300, max_simulations = 50000 }}"]
        yield from ["[evaluate]", "num_samples = 300", 'metrics = ["rmse"]']
        if self.worker is not None:
            yield "floor = false"  # Python is slow


def network_lines(method, num_simulations, options):
    return ["[[method]]", f'name = "{method}"', f"num_simulations = {num_simulations}",
            f"density_estimator = {{ num_networks = {options.num_networks} }}",
            f"training = {{ stop_after_epochs = {options.patience} }}"]


def sets(**fields):
    """A fault or variant that is no more than other fields."""
    return lambda r: r.__dict__.update(fields)


def moved(values, steps):
    """Values (n, ...) that come `steps` later; the first stands for all before it."""
    return values[np.maximum(np.arange(len(values)) - steps, 0)]


def late_rates(steps):
    def log(r, t, states, actions):
        n = r.num_positions
        return t, np.hstack([states[:, :n], moved(states[:, n:], steps)]), actions

    return sets(log=log)


def late_actions(steps):
    return sets(log=lambda r, t, states, actions: (t, states, moved(actions, steps)))


def delay(steps):
    return sets(feel=lambda r, actions: moved(actions, steps))


def clock(factor):
    return sets(log=lambda r, t, states, actions: (factor * t, states, actions))


def scales(factor, of):
    """`of` (C): columns of the states of a device with so many positions."""
    return sets(log=lambda r, t, states, actions: (
        t, states * np.where(np.isin(np.arange(states.shape[1]), of(r.num_positions)), factor, 1.0), actions))


def scaled_action(r):
    name = r.device.known[0]
    r.set_known(name, r.truth[name])
    r.log = lambda r, t, states, actions: (t, states, 1.1 * actions)


def lacks(which):
    def fault(r):
        name, r.truth[name] = getattr(r.device, which)[0], getattr(r.device, which)[1]
        if name != HIDDEN:
            r.set_known(name, 0.0)

    return fault


def wrong_constant(r):
    name = r.device.known[1]
    r.truth[name] = 1.2 * r.device.nominal[name]
    r.set_known(name, r.device.nominal[name])


def play(r, actions):
    """What a gear makes of them."""
    width, felt = 0.15 * np.abs(actions).max(), [actions[0]]
    for action in actions[1:]:
        felt.append(min(max(felt[-1], action - width), action + width))
    return np.array(felt)


def drift(r, states):
    states[:, 0] += 0.15 * np.abs(states[:, 0]).max() * np.linspace(0, 1, len(states))
    return states


def homing(r):
    stiffness, damping, r.first[0] = r.device.homing
    r.feedback = lambda r, t, y: -stiffness * y[0] - damping * y[r.num_positions] if t < 0.6 else None


def swapped(r, t, states, actions):
    return t, states[:, [1, 0, 3, 2][: states.shape[1]]], actions


def glitches(r, t, states, actions):
    rows = r.rng.choice(np.arange(20, len(states) - 20), 3, replace=False)
    states[rows, 0] += 4 * np.abs(states[:, 0]).max()
    return t, states, actions


def stuck(r, t, states, actions):
    begin = len(states) // 2
    states[begin : begin + len(states) // 8] = states[begin]
    return t, states, actions


def lost_rows(r, t, states, actions):
    kept = np.r_[0 : len(t) // 2, len(t) // 2 + 8 : len(t)]
    return t[: len(kept)], states[kept], actions[kept]


def lasting_noise(r, shape):
    noise = r.rng.standard_normal(shape)
    for t in range(1, len(noise)):
        noise[t] = 0.98 * noise[t - 1] + math.sqrt(1 - 0.98**2) * noise[t]
    return noise


def heavy_noise(r, shape):
    return r.rng.standard_normal(shape) * np.where(r.rng.random(shape) < 0.02, 12.0, 1.0)


def prior_elsewhere(r):
    r.prior[r.telling] = f"uniform = [{1.25 * r.truth[r.telling]:.6g}, {2 * r.truth[r.telling]:.6g}]"


# What was done, and the words of a finding, or of its id, that name it.
UNITS, LACK, NOISE = r"--scale|times as fast", r"lack", r"noise"
FAULTS = {
    "position_x1.1": (scales(1.1, lambda n: range(n)), UNITS),
    "states_x1.1": (scales(1.1, lambda n: range(2 * n)), UNITS + "|states were about"),
    "action_x1.1": (scaled_action, r"actions were about"),
    "clock_1.02": (clock(1.02), r"clock|\bdt\b|time step"),
    "clock_1.05": (clock(1.05), r"clock|\bdt\b|time step"),
    **{f"late_rates_{k}": (late_rates(k), r"rates were recorded . samples? late|wrong_rate") for k in (1, 3, 5)},
    **{f"late_actions_{k}": (late_actions(k), r"actions were recorded . samples? late") for k in (1, 3, 5)},
    **{f"delay_{k}": (delay(k), r"reacted to actions . samples? late") for k in (1, 3, 5)},
    "lacks_friction": (lacks("friction"), LACK + "|friction"),
    "lacks_damping": (lacks("damping"), LACK + "|friction|damping"),
    "wrong_constant": (wrong_constant, LACK + "|widen"),
    "backlash": (sets(feel=play), LACK + "|backlash|play"),
    "saturation": (sets(feel=lambda r, a: np.clip(a, -0.5 * np.abs(a).max(), 0.5 * np.abs(a).max())), LACK + "|saturat"),
    "drift": (sets(sense=drift), r"drift|zero"),
    "homing": (homing, r"homing|first .* s\b|begin"),
    "noise_half": (sets(declared="scale = 0.01"), NOISE),
    "noise_double": (sets(declared="scale = 0.04"), NOISE),
    "noise_x10": (sets(declared="scale = 0.2"), NOISE),
    "lasting_noise": (sets(noise=0.04, draw_noise=lasting_noise), r"correlation|in a row"),
    "outliers": (sets(draw_noise=heavy_noise), r"degrees_of_freedom|glitch|outlier"),
    "degrees_rate": (scales(57.29578, lambda n: range(n, 2 * n)), UNITS),
    "swapped": (sets(log=swapped), r"swap"),
    "sign_action": (sets(log=lambda r, t, s, a: (t, s, -a)), r"actions .*sign"),
    "sign_rate": (scales(-1.0, lambda n: range(n, 2 * n)), r"sign|--scale"),
    "sign_position": (scales(-1.0, lambda n: [1, 3] if n == 2 else [0]), r"sign|--scale"),
    "prior_elsewhere": (prior_elsewhere, r"widen|prior may exclude"),
    "mixed_devices": (sets(change=lambda r, i: {r.telling: 1.3 * r.truth[r.telling]} if i == 1 else {}), r"rollout|device"),
    "copied_rollout": (sets(copies={1}), r"same numbers"),
    "glitches": (sets(log=glitches), r"glitch"),
    "stuck": (sets(log=stuck), r"stood still|stuck|leap"),
    "lost_rows": (sets(log=lost_rows), r"missing|leap|clock"),
}


def one_pulse(r):
    t = np.arange(r.steps + 1) * r.device.dt
    height = (1.5 if r.device.name == "furuta" else 2.0) * r.device.sines[0]
    return height * ((t >= 0.1) & (t < 0.1 + r.rng.uniform(0.2, 0.4)))


def squares(r):
    period = r.rng.integers(25, 60)
    phase = 2 * np.pi * (np.arange(r.steps + 1) // 5 * 5 + 1) / (4 * period)
    return 1.3 * r.device.sines[0] * np.sign(np.sin(phase))


def encoder(r, t, states, actions):
    """Positions by counts, far finer than their noise."""
    n = r.num_positions
    return t, np.hstack([np.round(states[:, :n] / 2e-3) * 2e-3, states[:, n:]]), actions


def narrow_prior(r):
    r.prior = {name: f"uniform = [{0.93 * r.truth[name]:.6g}, {1.06 * r.truth[name]:.6g}]" for name in r.prior}


def wide_prior(r):
    for name, (a, b) in r.device.spread.items():
        r.prior[name] = f"log_uniform = [{max(a, b / 200) / 2:.6g}, {1.5 * b:.6g}]"


def near_the_end(r):
    low, high = r.device.spread[r.telling]
    r.truth[r.telling] = low + 0.93 * (high - low)


def in_motion(r):
    r.first = r.device.first


RIGHT = {
    "plain": sets(),
    "plain_again": sets(),
    "noise_0.003": sets(noise=0.003),
    "noise_0.1": sets(noise=0.1),
    "noise_unknown": sets(declared="scale_prior = [0.05, 1.0]"),
    "noise_0.1_unknown": sets(noise=0.1, declared="scale_prior = [0.05, 1.0]"),
    "short": lambda r: sets(rollouts=1, held_out=0, steps=r.device.steps // 4)(r),
    "one_rollout": sets(rollouts=1, held_out=0),
    "six_rollouts": sets(rollouts=6, held_out=2),
    "one_parameter": lambda r: r.infer("pole_mass" if r.device.name == "furuta" else r.telling),
    "many_parameters": lambda r: r.infer(*r.device.spread, *r.device.more),
    "narrow_prior": narrow_prior,
    "wide_prior": wide_prior,
    "near_the_end": near_the_end,
    "in_motion": in_motion,
    "one_pulse": sets(excite=one_pulse),
    "squares": sets(excite=squares),
    "encoder": sets(log=encoder),
    "noisy_first_states": lambda r: (in_motion(r), sets(
        noise=0.05, is_first_noisy=True, methods=("refine",), refine="infer_first_states = true, ")(r)),
}

def of_worker(lines):
    return lambda r: (in_motion(r), sets(worker=lines, methods=("default",))(r))


# A simulator in Python that a user has written: the lines of spring.py that faults replace.
ALLOCATION, LAST_LINE = "states = np.empty((rows, len(actions), 2))", "return states"
WORKERS = {
    "worker": ([], ""),
    "worker_late_states": ([(LAST_LINE, "return np.concatenate([np.tile(first_state, (rows, 1, 1)), states[:, :-1]], axis=1)")],
                           r"\blate"),
    "worker_not_repeatable": ([(ALLOCATION, ALLOCATION + "; q = q + 0.05 * np.random.default_rng().standard_normal(rows)")],
                              r"not_repeatable|repeat|seed"),
    "worker_same_rows": ([(LAST_LINE, "states[theta['stiffness'] < 12] = 1.0; return states")], r"same_rows|the same"),
}


def worlds():
    """Device, name, whether it is right, what names its fault, how to begin it, what edits it."""
    for name, (lines, cause) in WORKERS.items():
        yield "worker", name, not lines, cause, partial(Recording, DEVICES[1]), of_worker(lines)
    for name, variant in RIGHT.items():
        yield from ((d.name, name, True, "", partial(Recording, d), variant) for d in DEVICES)
    for name, (fault, cause) in FAULTS.items():
        yield from ((d.name, name, False, cause, partial(Recording, d), fault) for d in DEVICES)
