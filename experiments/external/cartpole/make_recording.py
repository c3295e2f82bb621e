# Records rollouts of a cart-pole that differs from cartpole.xml in what the study calls unknown:
# masses, damping, friction, the motor's gear, and a delay until the force acts. It stands for the
# real one here.
#     python3 make_recording.py            writes rollout-0.csv, ... , which npdr import joins
#     python3 make_recording.py 7          another cart-pole, and other pushes
import sys

import mujoco
import numpy as np

DT, STEPS, ROLLOUTS = 0.02, 250, 4
seed = int(sys.argv[1]) if len(sys.argv) > 1 else 0
rng = np.random.default_rng(seed)
spec = mujoco.MjSpec.from_file("cartpole.xml")
truth = {
    "geom.pole.mass": rng.uniform(0.12, 0.3),
    "geom.cart.mass": rng.uniform(0.6, 1.2),
    "joint.x.damping": rng.uniform(0.2, 1.5),
    "joint.x.frictionloss": rng.uniform(0.05, 0.5),
    "joint.theta.damping": rng.uniform(0.002, 0.02),
    "actuator.force.delay": rng.uniform(0.0, 3.0),
}
spec.geom("pole").mass, spec.geom("cart").mass = truth["geom.pole.mass"], truth["geom.cart.mass"]
model = spec.compile()
model.dof_damping[:] = truth["joint.x.damping"], truth["joint.theta.damping"]
model.dof_frictionloss[0] = truth["joint.x.frictionloss"]
substeps = round(DT / model.opt.timestep)
late = round(truth["actuator.force.delay"] * substeps)
for h in range(ROLLOUTS):
    data = mujoco.MjData(model)
    data.qpos[1] = rng.uniform(-1.0, 1.0)
    phases, periods = rng.uniform(0, 2 * np.pi, 3), rng.uniform(0.4, 2.5, 3)
    force = [2.0 * np.sin(2 * np.pi * t * DT / periods + phases).sum() for t in range(STEPS)]
    rows = []
    for t in range(STEPS + 1):
        state = np.r_[data.qpos, data.qvel]
        noise = np.array([1e-3, 2e-3, 1e-2, 2e-2]) * rng.standard_normal(4)
        rows.append([t * DT, *(state + noise), force[min(t, STEPS - 1)]])
        if t == STEPS:
            break
        for k in range(substeps):
            now = t * substeps + k - late
            data.ctrl[0] = force[max(now, 0) // substeps]
            mujoco.mj_step(model, data)
    header = "t [s],x [m],theta [rad],x_dot [m/s],theta_dot [rad/s],force [1]"
    np.savetxt("rollout-%d.csv" % h, rows, delimiter=",", header=header, comments="")
print("\n".join("%s = %.4g" % item for item in truth.items()))
