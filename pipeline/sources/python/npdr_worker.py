"""Makes a Python function a simulator of npdr.

    import npdr_worker

    def simulate(theta, first_state, actions, dt, rng):
        states = ...            # (steps, number of state channels)
        return states

    npdr_worker.serve(simulate)

npdr starts the program once per thread and keeps it. theta["mass"] is a domain parameter; the
state that is returned for step t is the one after actions[t] was held for dt seconds, so that
first_state isn't among them. rng is numpy's random generator with the row's own seed. An exception
fails the row that it comes from, and no other; so do states that aren't finite. What the program
prints is kept in the logs beside the simulations.

A function that simulates all rows at once, in numpy or on a GPU, is faster:

    def simulate(theta, first_state, actions, dt, seeds):
        mass = theta["mass"]    # (rows,)
        return states           # (rows, steps, number of state channels)

    npdr_worker.serve(simulate, batch=True)

One that takes all rollouts and segments as well, which are rows for it, is faster still:

    def simulate(theta, first_state, actions, dt, seeds):
        mass = theta["mass"]    # (rows,); first_state (rows, states), actions (rows, steps, actions)
        return states           # (rows, steps, number of state channels)

    npdr_worker.serve(simulate, batch="segments")

A simulator with memory, such as a delay, may have an argument past_actions more: the actions of the
same rollout before the segment, (steps before it, actions); not with batch="segments".

A result must depend on nothing but these arguments. The protocol is in docs/worker-protocol.md.
"""

import inspect
import json
import os
import sys
import sysconfig
import traceback

import numpy as np

PROTOCOL = 1
OK, CRASHED = 0, 4

# Replies go where standard output went; what is printed from now on goes to standard error.
_replies = os.fdopen(os.dup(1), "wb")
_requests = os.fdopen(os.dup(0), "rb")
os.dup2(2, 1)
os.dup2(os.open(os.devnull, os.O_RDONLY), 0)


def serve(simulate, batch=False):
    """Answers npdr's requests until there are no more. batch: False, True or "segments"."""
    if batch not in (False, True, "segments"):
        sys.exit("npdr_worker: batch = %r, must be False, True or 'segments'" % (batch,))
    try:
        wants_past = "past_actions" in inspect.signature(simulate).parameters
    except (TypeError, ValueError):  # built in, and of some extensions
        wants_past = False
    if wants_past and batch == "segments":
        sys.exit("npdr_worker: past_actions has another length in each segment; use batch=True")
    if _requests.isatty():
        sys.exit("npdr_worker: started by hand; a study names this program: "
                 'simulator.worker = "python3 %s"' % os.path.basename(sys.argv[0]))
    while True:
        line = _requests.readline()
        if not line:
            return
        header = json.loads(line)
        if header["npdr_worker"] != PROTOCOL:
            sys.exit("npdr_worker: protocol %s, must be %d: use the npdr_worker.py of this npdr"
                     % (header["npdr_worker"], PROTOCOL))
        if header["request"] == "hello":
            _write({"reply": "hello", "files": _own_files()})
            continue
        arrays = {a["name"]: _read_array(a) for a in header["arrays"]}
        try:
            if batch == "segments":
                states = _replay_at_once(simulate, header, arrays)
                status, message = np.full(len(states), OK, np.uint8), ""
            else:
                states, status, message = _replay(simulate, batch, wants_past, header, arrays)
            said = {"message": message} if message else {}
            _write({"reply": "states", "shape": list(states.shape), **said}, states, status)
        except Exception:  # of the whole request; rows have theirs caught one by one
            traceback.print_exc()
            _write({"reply": "error", "message": _last_line()})


def _own_files():
    """Where the program's modules lie, but for those that are installed."""
    # Not all below sys.prefix: a project may hold its virtual environment, or lie in /usr itself.
    libraries = [sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")]
    installed = tuple(os.path.realpath(path) + os.sep for path in libraries)
    links = tuple(path + os.sep for path in libraries)  # Debian has one to /etc there
    paths = set()
    for module in list(sys.modules.values()):
        try:  # asking a lazy module for an attribute would import it
            name = object.__getattribute__(module, "__dict__")["__file__"]
            path = os.path.realpath(name)
        except Exception:  # without a file, or none that has a path
            continue
        is_package = "site-packages" in path or "dist-packages" in path
        if not path.startswith(installed) and not name.startswith(links) and not is_package:
            paths.add(path)
    return sorted(paths - {os.path.realpath(__file__)})


def _read_array(description):
    array = np.empty(description["shape"], description["type"])
    view, done = memoryview(array).cast("B") if array.size else b"", 0
    while done < len(view):
        count = _requests.readinto(view[done:])
        if not count:
            sys.exit("npdr_worker: the request ends too early")
        done += count
    return array


def _write(header, *arrays):
    text = json.dumps({"npdr_worker": PROTOCOL, **header}, ensure_ascii=False)
    _replies.write(text.encode("utf-8", "replace") + b"\n")  # messages may hold what isn't UTF-8
    for array in arrays:
        _replies.write(memoryview(np.ascontiguousarray(array)).cast("B"))
    _replies.flush()


def _last_line():
    kind, error = sys.exc_info()[:2]
    return "%s: %s" % (kind.__name__, error)


def _replay_at_once(simulate, header, arrays):
    """States of all rows; segments of the same length are rows of one call."""
    theta, lengths = arrays["theta"], arrays["steps"]
    rows, channels = len(theta), len(header["states"])
    begins = np.cumsum(lengths) - lengths
    states = np.empty((rows, int(lengths.sum()), channels))
    for length in np.unique(lengths).tolist():
        segments = np.flatnonzero(lengths == length)
        steps = begins[segments, None] + np.arange(length)  # (segments, length)
        seeds = np.stack([_seeds_of(arrays["seeds"], int(s)) for s in segments], axis=1)
        columns = np.repeat(theta, len(segments), axis=0).T.copy()
        part = simulate(_Parameters(zip(header["parameters"], columns)),
                        np.tile(arrays["first_states"][segments], (rows, 1)),
                        np.tile(arrays["actions"][steps], (rows, 1, 1)), header["dt"], seeds.ravel())
        part = _checked(part, (rows * len(segments), length, channels))
        states[:, steps] = part.reshape(rows, len(segments), length, channels)
    return states


def _replay(simulate, batch, wants_past, header, arrays):
    rows, steps = len(arrays["theta"]), int(arrays["steps"].sum())
    states = np.empty((rows, steps, len(header["states"])))
    status = np.full(rows, OK, np.uint8)
    message = ""
    ends = np.cumsum(arrays["steps"]).tolist()
    for segment, (begin, end) in enumerate(zip([0] + ends, ends)):
        first_state, actions = arrays["first_states"][segment], arrays["actions"][begin:end]
        past = arrays["actions"][begin - int(arrays["past"][segment]):begin]
        more = {"past_actions": past.copy()} if wants_past else {}
        if batch:
            columns = _Parameters(zip(header["parameters"], arrays["theta"].T.copy()))
            shape = (rows, len(actions), len(header["states"]))
            part = _checked(simulate(columns, first_state, actions, header["dt"],
                                     _seeds_of(arrays["seeds"], segment), **more), shape)
            if shape[1] == steps:
                return part, status, message
            states[:, begin:end] = part
            continue
        for row in np.flatnonzero(status == OK):
            theta = _Parameters(zip(header["parameters"], arrays["theta"][row].tolist()))
            rng = _seeded(arrays["seeds"][row], segment)
            try:
                result = simulate(theta, first_state.copy(), actions.copy(), header["dt"], rng,
                                  **more)
                states[row, begin:end] = _checked(result, states[row, begin:end].shape)
            except Exception:
                if not message:
                    traceback.print_exc()
                    message = _last_line()
                status[row] = CRASHED
                states[row] = np.nan
    return states, status, message


class _Parameters(dict):
    def __missing__(self, name):
        raise KeyError("the study has no parameter '%s'; it has %s" % (name, ", ".join(self)))


def _seeds_of(seeds, segment):
    """Seeds of the rows, others for each segment: noise mustn't repeat itself."""
    mixed = seeds.astype(np.uint64) + np.uint64(segment * 0x9E3779B97F4A7C15 % 2**64)
    mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    return ((mixed ^ (mixed >> np.uint64(27))) >> np.uint64(33)).astype(np.uint32)


def _checked(result, shape):
    result = np.asarray(result)
    if np.iscomplexobj(result):
        raise TypeError("simulate() returned complex numbers, must be real ones")
    result = result.astype(float, copy=False)
    if result.shape != shape:
        raise ValueError("simulate() returned an array of shape %s, must be %s: %s"
                         % (result.shape, shape,
                            ("(rows, steps, states)" if len(shape) == 3 else "(steps, states)")
                            + ", the states after each action"))
    return result


_bits = np.random.Philox(0)
_generator = np.random.Generator(_bits)
_key, _zeros = np.zeros(2, np.uint64), np.zeros(4, np.uint64)
_start = {"bit_generator": "Philox", "state": {"counter": _zeros, "key": _key}, "buffer": _zeros,
          "buffer_pos": 4, "has_uint32": 0, "uinteger": 0}


def _seeded(seed, segment):
    """numpy's generator with a stream of its own for each row and segment. Making one takes longer
    than giving it another key."""
    _key[:] = seed, segment
    _bits.state = _start
    return _generator
