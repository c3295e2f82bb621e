"""Times sbi on the simulations that bench_peers wrote, and prints both. See against_sbi."""
import argparse
import contextlib
import io
import pathlib
import time
import warnings

import numpy as np
import sbi
import torch
from sbi.inference import NLE, NPE, NRE_B
from sbi.neural_nets import classifier_nn, likelihood_nn, posterior_nn
from sbi.utils import BoxUniform

CHAINS = dict(num_chains=200, warmup_steps=100, thin=5)
METHODS = {
    "NPE, MAF": (NPE, dict(density_estimator=posterior_nn("maf")), {}),
    "NPE, NSF": (NPE, dict(density_estimator=posterior_nn("nsf")), {}),
    "NPE, MDN": (NPE, dict(density_estimator=posterior_nn("mdn")), {}),
    "NLE, MAF": (NLE, dict(density_estimator=likelihood_nn("maf")), dict(mcmc_parameters=CHAINS)),
    "NRE-B": (NRE_B, dict(classifier=classifier_nn("resnet")), dict(mcmc_parameters=CHAINS)),
}


def seconds_of(method, theta, x, x_o, options):
    kind, network, sampler = METHODS[method]
    torch.manual_seed(1)
    start = time.perf_counter()
    inference = kind(prior=BoxUniform(-3 * torch.ones(5), 3 * torch.ones(5)), show_progress_bars=False, **network)
    inference.append_simulations(theta, x)
    # The number of epochs counts from 0, and one more is made.
    inference.train(training_batch_size=options.batch_size, max_num_epochs=options.epochs - 1,
                    stop_after_epochs=options.epochs + 1)
    training = time.perf_counter() - start
    start = time.perf_counter()
    inference.build_posterior(**sampler).sample((options.num_samples,), x=x_o, show_progress_bars=False)
    return training, time.perf_counter() - start, inference.summary["epochs_trained"][-1]


parser = argparse.ArgumentParser()
parser.add_argument("data", type=pathlib.Path)
parser.add_argument("--num-simulations", type=int)
parser.add_argument("--epochs", type=int, default=20)
parser.add_argument("--batch-size", type=int, default=50)
parser.add_argument("--num-samples", type=int, default=10_000)
options = parser.parse_args()
warnings.simplefilter("ignore")
torch.set_num_threads(1)
theta, x, x_o = (torch.tensor(np.loadtxt(options.data / f"{name}.csv", delimiter=",", ndmin=2), dtype=torch.float32)
                 for name in ("theta", "x", "x_o"))

print(f"slcp, {len(theta)} simulations, {options.epochs} epochs in batches of {options.batch_size}, "
      f"{options.num_samples} samples, one thread; sbi {sbi.__version__}, torch {torch.__version__}\n")
print("| method | training: npdr [s] | sbi [s] | ratio | samples: npdr [s] | sbi [s] | ratio |")
print("|:--|--:|--:|--:|--:|--:|--:|", flush=True)
for line in (options.data / "npdr.csv").read_text().splitlines():
    method, training, sampling = line.split(";")
    with contextlib.redirect_stdout(io.StringIO()):
        their_training, their_sampling, epochs = seconds_of(method, theta, x, x_o, options)
    assert epochs == options.epochs, f"{method}: sbi made {epochs} epochs"
    print(f"| {method} | {training} | {their_training:.2f} | {their_training / float(training):.0f} "
          f"| {sampling} | {their_sampling:.2f} | {their_sampling / float(sampling):.0f} |", flush=True)
