# A mass on a spring with viscous damping and dry friction, a force acting on it:
#     mass q'' = force - stiffness q - damping q' - friction sign(q')
# All rows at once, as numpy likes it; semi-implicit Euler in ten substeps.
import numpy as np
import npdr_worker


def simulate(theta, first_state, actions, dt, seeds):
    rows, h = len(seeds), dt / 10
    q, v = np.full(rows, first_state[0]), np.full(rows, first_state[1])
    states = np.empty((rows, len(actions), 2))
    for t, (force,) in enumerate(actions):
        for _ in range(10):
            pull = force - theta["stiffness"] * q - theta["damping"] * v
            v = v + h / theta["mass"] * (pull - theta["friction"] * np.tanh(100.0 * v))
            q = q + h * v
        states[:, t, 0], states[:, t, 1] = q, v
    return states


npdr_worker.serve(simulate, batch=True)
