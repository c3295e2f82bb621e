/// One description of every field of a study: key, place in memory, what it may hold, one line of
/// documentation. One visitor reads it from files (field_reader.h) and lists it with its values
/// (study_json.h) for all that writes, so that neither can forget a field.
///
/// A visitor has three members, whose last argument may be left out (study_json.h):
///   f(key, value, constraint, doc, use)  a field; a default that isn't allowed makes it required
///   f.table(key, doc, body, use)         a table: body(visitor of its members)
///   f.list(key, values, minimum, doc, body, use)
///                                        a list of tables: body(visitor of its members, element)
#pragma once

#include <fmt/format.h>

#include "analysis/pair_plot.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "pipeline/config/check.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/method_fields.h"
#include "pipeline/config/simulator_fields.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {
template <class Fields>
void describe(Fields& f, ReferenceConfig& c) {
  f("name", c.name, label(), "column title in the tables; unique");
  f("parameters", c.parameters, few_numbers(), "values that differ from the study's nominal ones");
}

template <class Fields>
void describe(Fields& f, TargetConfig& c) {
  f("recording", c.recording, file_path(),
    "HDF5 file of recorded rollouts, relative to the study file's folder");
  f("observation", c.observation, file_path(),
    "CSV or HDF5 file of x_o, where the simulator gives features, not rollouts");
  f("truth", c.truth, few_numbers(),
    "parameters of a simulated target that aren't nominal; {}: none");
  f("inputs", c.inputs, file_path(),
    "recording whose initial states and actions a truth's rollouts have; without it those of the "
    "simulator");
  f("rollouts", c.rollouts, rollouts_constraint(),
    "those of the recording that are used, counted from 1: [3, 4, 5, 1]; all when left out");
  f("num_rollouts", c.num_rollouts, count_from(0),
    "use the first k rollouts; 0: all of a recording; 5 for a truth without inputs when left out");
  f("held_out", c.held_out, count_from(0),
    "rollouts after those, which only the evaluation sees; needs num_rollouts");
  f("seed", c.seed, not_negative(), "picks a truth's random behavior, and its observation noise");
}

template <class Fields>
void describe(Fields& f, ObservationNoise& c) {
  f("scale", c.scale, not_negative(),
    "standard deviation / largest recorded magnitude of the channel in a rollout");
  const auto without = [&](const char* number, bool is_given) {
    const std::string key = std::string("observation_noise.") + number;
    return FieldUse{.unused = unless(!is_given, key + " is given")};
  };
  const FieldUse of_noise = {.unused = unless(!c.is_silent(),
                                              "there is no noise without observation_noise.scale, "
                                              "scale_prior or std")};
  f("scale_prior", c.scale_prior, noise_prior(0.0, "scale"),
    "[median, deviation of the logarithm], in place of scale: it isn't known",
    without("scale", c.scale > 0.0));
  f("std", c.std, few_numbers(),
    "standard deviation of some channels in their units, in place of scale: { theta = 0.01 }");
  f("correlation", c.correlation, interval(End::closed, 0, 1, End::open),
    "of neighboring stored states' noise, which begins anew in each segment; none when left out",
    of_noise);
  f("correlation_prior", c.correlation_prior, noise_prior(0.0, "correlation", 1.0),
    "[median, deviation of log(c / (1 - c))], in place of correlation",
    c.is_silent() ? of_noise : without("correlation", c.correlation.has_value()));
  f("degrees_of_freedom", c.degrees_of_freedom, above(1.0),
    "of Student's t, in place of Gaussian noise", of_noise);
  f("degrees_of_freedom_prior", c.degrees_of_freedom_prior, noise_prior(1.0, "degrees of freedom"),
    "[median, deviation of log(nu - 1)], in place of degrees_of_freedom",
    c.is_silent() ? of_noise : without("degrees_of_freedom", c.degrees_of_freedom.has_value()));
  f("redraw", c.redraw, anything<bool>(),
    "fresh noise in each training epoch, instead of once per simulation",
    {.affects = Affects::training});
}

template <class Fields>
void describe(Fields& f, EvaluateConfig& c) {
  f("num_samples", c.num_samples, count_from(1),
    "posterior samples that are simulated and measured");
  choices(f, "metrics", c.metrics, 1, "what simulated rollouts are measured by");
  choice(f, "rounds", c.rounds, "which rounds' posteriors are evaluated");
  f("floor", c.floor, anything<bool>(),
    "of a recording: also fit it by least squares, which posteriors are compared with");
  f("leave_out", c.leave_out, folds_constraint(),
    "folds: every method is repeated without each k-th part of the rollouts, to predict it; 0: "
    "not");
}

template <class Fields>
void describe(Fields& f, DiagnoseConfig& c) {
  choices(f, "checks", c.checks, 0,
          "what posteriors are checked by; all of them when left out, [] for none; without the "
          "table, those that cost little");
  f("num_simulations", c.num_simulations, between(inference::kFewestSimulations, 1'000'000),
    "fresh draws of the prior that are simulated, to calibrate with",
    {.affects = c.calibrates() ? Affects::results : Affects::report});
  f("num_samples", c.num_samples, between(inference::kFewestSimulations, 1'000'000),
    "posterior samples per observation");
  f("alpha", c.alpha, interval(End::open, 0, 1, End::open),
    "probability that a method without fault fails any of its checks",
    {.affects = Affects::report});
}

template <class Fields>
void describe(Fields& f, PolicyGridAxis& c) {
  f("parameter", c.parameter, anything<std::string>(),
    "a domain parameter of the simulator, another for each axis");
  f("range", c.range, range_constraint(), "its first and last value");
  f("steps", c.steps, between(2, 100), "values in that range, at equal distances");
  f("values", c.values, ascending(), "its values, in place of range and steps");
}

template <class Fields>
void describe(Fields& f, PolicyGrid& c) {
  table(f, "x", c.x, "one axis of the grid");
  table(f, "y", c.y, "the other axis");
}

template <class Fields>
void describe(Fields& f, PolicyConfig& c) {
  using enum inference::PolicyOptimizerKind;
  const FieldUse of_task = {.affects = Affects::task}, of_tests = {.affects = Affects::elsewhere};
  const auto only_of = [&](inference::PolicyOptimizerKind optimizer) {
    return FieldUse{.unused = unless(c.search.kind == optimizer,
                                     fmt::format("it means nothing to the optimizer '{}'",
                                                 name_of(c.search.kind))),
                    .settable = true};
  };
  choice(f, "optimizer", c.search.kind, "how policies are searched for; \"power\" when left out");
  f("population", c.search.population, between(2, 100'000),
    "candidates per search iteration, beside the current policy");
  f("num_domain_parameters", c.num_domain_parameters, between(1, 1'000'000),
    "fresh posterior samples that each candidate of an iteration is tried on");
  f("num_initial_states", c.num_initial_states, between(1, 1'000'000),
    "initial states that each candidate is tried from, for each of them");
  f("num_test_states", c.num_test_states, between(20, 1'000'000),
    "initial states that a policy is tested from", of_tests);
  f("num_steps", c.num_steps, count_from(0), "of a rollout; 0: as many as the simulator has",
    of_task);
  f("initial", c.initial, few_numbers(),
    "parameters of the policy that begin elsewhere: { energy_gain = 30.0 }", of_task);
  f("model", c.model, few_numbers(),
    "domain parameters that the policy believes in, in place of the nominal ones", of_task);
  f("initial_std", c.search.initial_std, positive(),
    "deviation of the first candidates, in the coordinates of the search");
  f("min_std", c.search.min_std, positive(),
    "the deviation never falls below, in any direction; <= initial_std");
  f("num_importance_samples", c.search.num_importance_samples, between(1, 100'000),
    "\"power\": the best candidates so far, of which the next policy is made", only_of(power));
  f("elite_fraction", c.search.elite_fraction, interval(End::open, 0, 1, End::closed),
    "\"cross_entropy\": share of the candidates of which the next policy is made",
    only_of(cross_entropy));
  f("smoothing", c.search.smoothing, interval(End::open, 0, 1, End::closed),
    "\"cross_entropy\": weight of the new distribution against the old one",
    only_of(cross_entropy));
  table(f, "grid", c.grid, "domain parameters that policies are tested on", of_tests);
}

template <class Fields>
void describe(Fields& f, ReportConfig& c) {
  f("title", c.title, anything<std::string>(), "title of the report; empty: the study's name");
  f("caption", c.caption, anything<std::string>(),
    "text below the main tables; blank lines separate paragraphs");
  f("parameters", c.parameters, anything<std::vector<std::string>>(),
    fmt::format("{} to {} parameters of the prior that pair plots show; empty: its first {}",
                analysis::kMinPairParameters, analysis::kMaxPairParameters,
                analysis::kMaxPairParameters));
  f("symbols", c.symbols, anything<std::map<std::string, std::string>>(),
    "LaTeX of parameters, for tables in papers, such as { pole_mass = 'm_p' }");
}

template <class Fields>
void describe(Fields& f, StageResources& c) {
  f("cpus", c.cpus, between(0, 4096), "cores of a task; 0: as [cluster] says");
  f("memory", c.memory, memory_constraint(), "of a task; empty: as [cluster] says");
  f("time", c.time, time_constraint(), "limit of a task; empty: as [cluster] says");
  f("sbatch", c.sbatch, options_constraint(), "further options, after those of [cluster]");
}

template <class Fields>
void describe(Fields& f, ClusterConfig& c) {
  f("partition", c.partition, option_value(), "of the cluster; empty: its default");
  f("account", c.account, option_value(), "that pays; empty: the user's default");
  f("cpus", c.cpus, between(1, 4096), "cores of a task");
  f("memory", c.memory, memory_constraint(),
    "of a task, such as \"2G\"; empty: the site's default");
  f("time", c.time, time_constraint(),
    "limit of a task, such as \"01:00:00\"; empty: the site's default");
  f("array_limit", c.array_limit, count_from(0),
    "tasks of an array that run at once; 0: as many as the cluster likes");
  f("max_array_size", c.max_array_size, count_from(0),
    "larger arrays are split; 0: the cluster is asked");
  f("task_minutes", c.task_minutes, positive(),
    "short shards are packed into tasks of about this length");
  f("refine_tasks", c.refine_tasks, between(0, kMostHelpers),
    "tasks beside a refinement's own job that simulate its rows with it, for slow simulators");
  f("signal_seconds", c.signal_seconds, between(1, 65'535),
    "before its time limit a task saves its work and is queued again");
  f("scratch", c.scratch, option_value(),
    "folder of the node for shards in the making, such as \"$TMPDIR\"; empty: none");
  f("mail", c.mail, option_value(), "address for mail when the study ends or a job fails");
  f("setup", c.setup, shell_lines(), "lines of shell before the work, such as \"module load gcc\"");
  f("sbatch", c.sbatch, options_constraint(),
    "further options of all jobs, such as \"--qos=long\"");
  table(f, "prepare", c.prepare, "what jobs of targets and proposals ask for");
  table(f, "simulate", c.simulate, "what tasks that simulate ask for");
  table(f, "infer", c.infer, "what jobs that train ask for");
  table(f, "baseline", c.baseline, "what the job of the baseline asks for");
  table(f, "evaluate", c.evaluate, "what jobs that evaluate ask for");
  table(f, "diagnose", c.diagnose, "what jobs that diagnose ask for");
  table(f, "policy", c.policy, "what jobs that search for policies, and test them, ask for");
  table(f, "report", c.report, "what the job of the report asks for");
}

template <class Fields>
void describe(Fields& f, SimulateConfig& c) {
  f("shard_size", c.shard_size, count_from(1),
    "simulations per job: what is scheduled, retried and resumed");
}

template <class Fields>
void describe(Fields& f, LimitsConfig& c) {
  f("max_failed_fraction", c.max_failed_fraction, between(0, 1),
    "share of failed simulations above which the study stops, with exit status 3");
}

template <class Fields>
void describe(Fields& f, Study& c) {
  const FieldUse by_plan = {.affects = Affects::elsewhere};
  const FieldUse of_report = {.affects = Affects::report};
  f.table("study", "what the study is called and repeated over", [&](auto& t) {
    t("name", c.name, folder_name(), "names the study's folder and its report", of_report);
    t("seeds", c.seeds, seeds_constraint(),
      "one experiment each; tables report mean and standard deviation", by_plan);
  });
  table(f, "target", c.target, "the target domain, whose motion is explained", by_plan);
  f.table("simulator", "the simulator whose parameters are inferred", [&](auto& t) {
    describe(t, c.simulator, c.source());
    describe(t, c.external);
  });
  f("prior", c.prior, prior_constraint(),
    "parameter = " + marginal_words() + "; the rest stay nominal", by_plan);
  table(f, "observation_noise", c.observation_noise,
        "noise on the simulated states that the inference sees");
  table(f, "simulate", c.simulate, "how simulations are cut into jobs", of_report);
  f.list("method", c.methods, 1, "a method to compare",
         [&](auto& t, auto& m) { describe(t, m, c.policy); });
  table(f, "evaluate", c.evaluate, "how posteriors are judged", by_plan);
  table(f, "diagnose", c.diagnose, "how posteriors are checked");
  table(f, "policy", c.policy, "search for a policy", {.omitted = !c.policy.is_used()});
  f.list(
      "reference", c.references, 0, "a parameter vector to compare posteriors with",
      [](auto& t, auto& r) { describe(t, r); }, by_plan);
  table(f, "limits", c.limits, "when to give up", of_report);
  table(f, "report", c.report, "how results are shown", of_report);
  table(f, "cluster", c.cluster, "how a batch system runs the study",
        {.affects = Affects::nothing});
}

}  // namespace npdr::pipeline
