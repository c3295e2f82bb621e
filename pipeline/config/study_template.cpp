#include "pipeline/config/study_template.h"

#include "core/error.h"
#include "pipeline/config/constraint.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kPlaceholder = "@NAME@";

constexpr const char* kTemplate =
    R"toml(# A study: infer the physics parameters of a simulator from recorded motion.
# Check it with `npdr validate`, run it with `npdr run`. Lines that begin with "# key =" show a
# default. `npdr list keys` lists all keys, `npdr list simulators` the simulators' parameters.

[study]
name = "@NAME@"                 # names the folder of the results
seeds = [1, 2, 3]               # one experiment each; tables report mean and standard deviation

# The target domain: whose motion to explain. Either recorded rollouts, or, as here, rollouts that the
# simulator itself makes at a known truth:
[target]
truth = { pole_mass = 1.2, pole_length = 0.8 }  # parameters that aren't nominal; {}: all nominal
num_rollouts = 1                # how many; of a recording: use the first k, 0: all
# held_out = 0                  # so many rollouts after those, which only the evaluation sees
# seed = 0                      # picks a truth's random behaviour (the pendulum has none)
# Recorded rollouts take the place of truth and seed:
#   recording = "rollouts.h5"   # HDF5, relative to this file; `npdr import` makes one from CSV files
# Of a simulator that gives features x and no rollouts, x_o itself, or a truth:
#   observation = "x_o.csv"     # one row, CSV or HDF5

[simulator]
name = "pendulum"
# parameters = { gravity = 9.81 }  # values that replace the nominal ones
# segment_length = 0            # restart from the recorded state every k steps; 0: never
# integrator = "erk4"           # method for the ODE
# substeps = 1                  # integrator steps per time step of the target
# store_every = 1               # keep every k-th state
# In place of a name, a program of your own or finished simulations: docs/external-simulators.md.
#   command = "python3 sim.py {theta} {x}"  # reads a file of theta, writes a file of x
#   dataset = "dataset.h5"      # or theta and x, as `npdr import --theta` writes them
#   format = "csv"              # of the command's files, or "hdf5"
#   folder = ""                 # where the command runs; empty: the folder of this file
#   time_limit = 3600.0         # [s] of a call with all rows of a shard
#   start_time = 2.0            # [s] added to the share of that for a call with fewer rows
#   retries = 1                 # of a call that failed, before its rows are split
#   parallel_calls = 0          # calls that share a shard's rows at the same time; 0: one a thread
#   features = ["peak [m]", "mean"]  # what x holds; empty: as x_o says, or x0, x1, ...
# The simulator "minigolf" has settings of its own:
#   [simulator.minigolf]
#   strike = "recorded"         # the recorded joint angles, or Table A4's "policy"
#   ball_start = "recorded"     # where the ball begins: as recorded, or "nominal"
#   rolling = "exact"           # away from everything in closed form, or all by Bullet: "engine"
#   substeps = 2                # of Bullet per time step of the target
#   substeps_near = 5           # the same where the ball is near something
#   linear_damping = 0.1        # part of its velocity that the ball loses in a second by itself
#   angular_damping = 0.0       # the same of its spin
#   solver_iterations = 100     # of Bullet's solver, at most
#   solver_cfm = 1e-4           # constraint force mixing: softness of contacts
#   solver_erp = 0.2            # part of an overlap that a substep takes away
#   restitution_threshold = 0.2 # slower contacts don't bounce [m/s]

# What to infer: parameter = { uniform = [low, high] }, { log_uniform = [low, high] },
# { normal = [mean, std] } or { log_normal = [mean of log, std of log] }, in the simulator's units.
# The rest stay nominal.
[prior]
pole_mass = { uniform = [0.3, 1.7] }    # [kg]
pole_length = { uniform = [0.3, 1.7] }  # [m]

# Gaussian noise on the simulated states that the inference sees. When no parameter reproduces the
# recordings, noise of the size of what is left makes them look like simulations.
[observation_noise]
# scale = 0.0                   # standard deviation / largest recorded magnitude of the channel
# redraw = true                 # fresh noise in each training epoch, not once per simulation

[simulate]
# shard_size = 1000             # simulations per job: what is scheduled, retried and resumed

# The methods to compare: one [[method]] each.
[[method]]
name = "NPDR (MAF)"             # column title in the tables
algorithm = "npe_c"
num_rounds = 2                  # rounds of proposing, simulating and training
num_simulations = 500           # per round
# num_atoms = 10                # parameter sets that the atomic loss compares per simulation
# loss = "auto"                 # or "atomic", "analytic" (mixtures of Gaussians only)
#   component_perturbation = 0.01  # "npe_a": noise on the Gaussians that its last round makes of one
# combined_loss = false         # atomic loss: also fit the simulations of the prior
# num_rollouts = 0              # use the first k rollouts of the target only; 0: all
#   num_iterations = 1          # with [policy]: of target rollouts, inference and policy search
#   policy_iterations = 20      # with [policy]: steps of each policy search
# published = { rmse = { mean = 0.263, std = 0.004 } }  # somebody's figures to print beside ours

[method.embedding]              # how rollouts become features
kind = "bayessim"
# features = 256                # width of the trained layer ("linear" only)
# principal_components = 0      # of the features, for the network to see; 0: the features themselves
# downsample = 1                # keep every k-th state; a multiple of simulator.store_every
# channels = []                 # state channels to keep; empty: all

[method.density_estimator]      # the network that learns the posterior
kind = "maf"                    # masked autoregressive flow; "mdn": mixture of Gaussians; "nsf": splines
num_transforms = 2              # autoregressive transforms ("maf" and "nsf" only)
hidden_features = 20            # width of each hidden layer
# num_hidden_layers = 2         # per transform; residual blocks of "resnet"
# num_bins = 8                  # bins of each spline ("nsf" only)
# num_components = 10           # Gaussians in the mixture ("mdn" only)

[method.training]
learning_rate = 5e-4            # step size of Adam
# batch_size = 50               # simulations per optimiser step
# validation_fraction = 0.2     # share of the simulations that early stopping is judged on
# stop_after_epochs = 20        # epochs without a better validation loss
# max_epochs = 5000
# clip_norm = 5.0               # largest norm of a gradient
# average_epochs = 2.0          # memory of the moving average of the weights; 0: none

# Of "nle", "nre_a" and "nre_b", whose posteriors have to be sampled:
#   [method.sampler]
#   kind = "slice"              # Markov chains, or "importance": resampled draws of the prior
#   num_chains = 200            # side by side
#   num_warmup = 100            # sweeps that each chain makes first
#   thin = 5                    # sweeps between two samples of a chain
#   num_candidates = 100000     # draws of the prior that chains begin from, or that are resampled

# Methods without a network. Of "abc_rejection", "abc_mcmc" and "abc_smc", in place of
# density_estimator, training and sampler:
#   [method.abc]
#   distance = "euclidean"      # of features; or a metric of trajectories, "dtw" or "rmse"
#   quantile = 0.1              # the nearest simulations that are accepted, as a share; "abc_smc": 0.5
#   epsilon = 0.0               # largest distance that is accepted; 0: by quantile
#   smooth = false              # move posterior samples by a draw of the density's kernel
# Of "linear_regression", which needs no simulations (simulator "furuta" only):
#   [method.linear_regression]
#   window = 11                 # states that are smoothed over to differentiate a recording
#   num_samples = 1000          # of the regression's weights

# Two that infer nothing, to compare policies with (studies with [policy] only): algorithm = "prior"
# is domain randomisation over the prior, "nominal" takes the nominal parameters for granted.

[[method]]
name = "NPDR (MoG)"
num_rounds = 2
num_simulations = 500
embedding = { kind = "bayessim" }
density_estimator = { kind = "mdn", num_components = 5, hidden_features = 20 }

[evaluate]
num_samples = 100               # posterior samples that are simulated and measured
# metrics = ["dtw", "rmse"]     # also "final_error", and "goal" where the simulator has one
# rounds = "last"               # or "all": every round's posterior
# floor = true                  # of a recording: also search for the smallest RMSE in the prior

# Checks of the posteriors: calibration over fresh simulations, and whether the observation is like
# what was simulated. Without this table there are none.
#   [diagnose]
#   checks = ["sbc", "coverage", "tarp", "local_c2st", "predictive", "ood", "training"]
#   num_simulations = 300       # fresh draws of the prior that are simulated, to calibrate with
#   num_samples = 1000          # posterior samples per observation
#   alpha = 0.01                # probability that a method without fault fails any of its checks

# Search for a policy that does well under the posterior, and tests of it in the target domain
# (simulator "furuta" only). Without this table there is none. A whole study to start from:
# experiments/furuta_policy.toml.
#   [policy]
#   optimizer = "power"         # or "cross_entropy"
#   population = 25             # candidates per search iteration
#   num_domain_parameters = 50  # posterior samples that each candidate is tried on
#   num_initial_states = 4      # initial states for each of them
#   num_test_states = 100       # initial states that a policy is tested from
#   num_steps = 0               # of a rollout; 0: as many as the simulator has
#   initial = {}                # parameters of the policy that begin elsewhere: { energy_gain = 30.0 }
#   model = {}                  # domain parameters that the policy believes in; the rest are nominal
#   initial_std = 2.0           # of the first candidates, in the coordinates of the search
#   min_std = 0.02              # it never falls below
#   num_importance_samples = 10 # "power": the best candidates, of which the next policy is made
#   elite_fraction = 0.25       # "cross_entropy": share of the candidates that makes the next policy
#   smoothing = 0.7             # "cross_entropy": weight of the new distribution against the old one
# Domain parameters that policies are tested on, in [policy.grid.x] and [policy.grid.y]:
#   [policy.grid.x]
#   parameter = "pole_mass"
#   range = [0.018, 0.03]       # first and last value
#   steps = 7                   # values in that range
#   values = [0.018, 0.024]     # or these values, in place of range and steps

# Named parameters to compare with, such as measured ones: a column in the tables each.
#   [[reference]]
#   name = "measured"
#   parameters = {}             # values that differ from the nominal ones

[limits]
# max_failed_fraction = 0.05    # share of failed simulations above which the study stops

[report]
title = "Pendulum"
# caption = ""                  # text below the main tables
# parameters = []               # 2 to 15 that pair plots show; empty: the prior's first 15

# What 'npdr submit' asks a cluster for; no result depends on it. Empty: the site's defaults.
#   [cluster]
#   partition = ""
#   account = ""
#   cpus = 1                    # cores of a task
#   memory = ""                 # of a task, such as "2G"
#   time = ""                   # limit of a task, such as "01:00:00"
#   array_limit = 0             # tasks of an array at the same time; 0: as the cluster likes
#   max_array_size = 0          # larger arrays are split; 0: the cluster is asked
#   task_minutes = 5.0          # short shards are packed into tasks of about this length
#   signal_seconds = 120        # before its limit a task saves its work and is queued again
#   scratch = ""                # folder of the node for shards in the making, such as "$TMPDIR"
#   mail = ""                   # address for mail when the study ends or a job fails
#   setup = []                  # lines of shell before the work, such as "module load gcc"
#   sbatch = []                 # further options, such as "--qos=long"
# Stages of their own: prepare, simulate, infer, baseline, evaluate, diagnose, policy, report.
#   [cluster.infer]
#   cpus = 0                    # 0 and "": as [cluster] says
#   memory = ""
#   time = ""
#   sbatch = []
)toml";

}  // namespace

std::string study_template(const std::string& name) {
  const Constraint<std::string> allowed = folder_name();
  if (!satisfies(name, allowed)) {
    throw InputError(must_be("study.name", quoted(name), allowed.words));
  }
  std::string text = kTemplate;
  return text.replace(text.find(kPlaceholder), std::string(kPlaceholder).size(), name);
}

}  // namespace npdr::pipeline
