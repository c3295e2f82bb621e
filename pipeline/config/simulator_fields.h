/// The fields of the table [simulator], of built-in simulators and of the user's: a part of
/// study_fields.h, which says what a description is.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "pipeline/config/constraint.h"
#include "pipeline/config/external_config.h"
#include "pipeline/config/study_json.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

template <class Fields>
void describe(Fields& f, sim::MinigolfConfig& c) {
  choice(f, "strike", c.strike, "the recorded joint angles, or the policy of Table A4");
  choice(f, "ball_start", c.ball_start, "the ball's start: as recorded, or its nominal place");
  choice(f, "rolling", c.rolling, "away from everything: in closed form, or by Bullet, too");
  f("substeps", c.substeps, between(c.kSubsteps), "of Bullet per time step of the target");
  f("substeps_near", c.substeps_near, between(c.kSubsteps),
    "the same where the ball is near something");
  f("linear_damping", c.linear_damping, between(c.kPart),
    "part of its velocity that the ball loses in a second by itself");
  f("angular_damping", c.angular_damping, between(c.kPart), "the same of its spin");
  f("solver_iterations", c.solver_iterations, between(c.kSolverIterations),
    "of Bullet's contact solver, at most");
  f("solver_cfm", c.solver_cfm, between(c.kPart), "constraint force mixing: softness of contacts");
  f("solver_erp", c.solver_erp, between(c.kPart), "part of an overlap that a substep takes away");
  f("restitution_threshold", c.restitution_threshold, between(c.kRestitutionThreshold),
    "slower contacts don't bounce [m/s]");
}

/// `source`: what is simulated.
template <class Fields>
void describe(Fields& f, sim::SimulatorConfig& c,
              const SourceTraits& source = traits_of(SourceKind::built_in)) {
  Constraint<std::string> name = one_of(sim::simulator_names());
  name.allows = [is_name = name.allows](const std::string& value) {
    return value.empty() || is_name(value);  // something else takes its place
  };
  f("name", c.name, name,
    "a built-in simulator; exactly one of name, command, worker, library, mjcf and dataset",
    {.affects = source.is_built_in ? Affects::results : Affects::report});
  // Not all built-in simulators read a setting, and others none.
  const std::string reader =
      source.is_built_in ? "the simulator '" + c.name + "'" : std::string("a ") + source.name;
  const auto unused = name.allows(c.name) && !c.name.empty() ? sim::unused_settings(c.name)
                                                             : std::vector<std::string>();
  const auto use_of = [&](const char* key) {
    const bool is_read = source.is_built_in && std::ranges::count(unused, key) == 0;
    return FieldUse{.unused = unless(is_read, "it means nothing to " + reader)};
  };
  // Rollouts of the user's simulators are cut, and kept, like those of the built-in ones.
  const auto use_of_rollouts = [&](const char* key) {
    return source.is_built_in || !source.gives_motion ? use_of(key) : FieldUse{};
  };
  f("parameters", c.parameters, few_numbers(), "values that replace the simulator's nominal ones");
  f("segment_length", c.segment_length, count_from(0),
    "steps until the simulation restarts from the recorded state; 0: never",
    use_of_rollouts("segment_length"));
  choice(f, "integrator", c.integrator, "method for the ODE", use_of("integrator"));
  f("substeps", c.substeps, count_from(1),
    "integrator steps per time step of the target; 1 with \"cvode\"", use_of("substeps"));
  f("store_every", c.store_every, count_from(1), "keep every k-th state of a simulated rollout",
    use_of_rollouts("store_every"));
  f.table(
      "minigolf", "settings of the simulator \"minigolf\"",
      [&](auto& t) { describe(t, c.minigolf); }, use_of("minigolf"));
}

template <class Fields>
void describe(Fields& f, DescribedParameter& c) {
  f("name", c.name, column_name(), "the domain parameter, as the program knows it");
  f("unit", c.unit, label(), "such as \"kg\"; \"1\": without dimension");
  f("nominal", c.nominal, anything<double>(), "value where nothing else is said");
  f("lower", c.lower, anything<double>(), "smallest value that can be simulated");
  f("upper", c.upper, anything<double>(), "largest value that can be simulated");
  f("period", c.period, not_negative(), "values this far apart are the same system; 0: none are",
    {.affects = Affects::report});
  f("description", c.description, anything<std::string>(), "what it is, for people",
    {.affects = Affects::report});
}

template <class Fields>
void describe(Fields& f, GoalConfig& c) {
  f("place", c.place, few_numbers(), "state channel = value of the goal");
  f("radius", c.radius, not_negative(), "Euclidean, around that place; 0: there is no goal");
  f("speed", c.speed, not_negative(), "largest speed over the last step that is rest; 0: any");
  f("description", c.description, anything<std::string>(), "such as \"rests near the hole\"",
    {.affects = Affects::report});
}

template <class Fields>
void describe(Fields& f, ExternalConfig& c) {
  const SourceTraits& source = traits_of(c.kind());
  const std::string a_source = std::string("a ") + source.name;
  const auto only = [](bool applies, const std::string& why, Affects affects = Affects::results) {
    return FieldUse{affects, unless(applies, why)};
  };
  const FieldUse by_source = {.affects = Affects::elsewhere};
  const FieldUse of_channels =
      only(source.gives_motion && (!source.describes_itself || c.mjcf),
           a_source + (source.gives_motion ? " describes its own" : " gives no rollouts"),
           Affects::elsewhere);
  const FieldUse of_rollouts =
      only(!source.is_built_in && source.gives_motion,
           "it belongs to simulators of the user's that give rollouts", Affects::elsewhere);
  const auto of_code = [&](Affects affects) {
    return only(source.runs_users_code(), "it belongs to simulators of the user's", affects);
  };
  const auto of_programs = [&](Affects affects) {
    return only(source.calls_program, "it belongs to simulator.command and simulator.worker",
                affects);
  };
  f("command", c.command, shell_command(),
    "shell command that reads a file of theta and writes a file of x");
  f("worker", c.worker, shell_command(),
    "shell command of a program that stays and answers requests, such as one with npdr_worker.py");
  f("library", c.library, file_path(),
    "shared library with the interface of npdr_simulator.h, relative to the study file's folder",
    by_source);
  f("mjcf", c.mjcf, file_path(),
    "model of MuJoCo, relative to the study file's folder; the prior names what is unknown in it",
    by_source);
  f("dataset", c.dataset, file_path(),
    "HDF5 file of finished simulations, relative to the study file's folder", by_source);
  f("states", c.states, anything<std::vector<std::string>>(),
    "state channels of rollouts, each a label or \"label [unit]\"; empty: a command gives "
    "features",
    of_channels);
  f("actions", c.actions, anything<std::vector<std::string>>(), "the same of the actions",
    of_channels);
  f.list(
      "parameter", c.parameters, 0, "a domain parameter of the user's simulator",
      [](auto& t, auto& p) { describe(t, p); },
      only(!source.describes_itself, a_source + " describes its own", Affects::elsewhere));
  f("files", c.files, anything<std::vector<std::string>>(),
    "further files that results depend on, seen from the folder where the program runs",
    of_code(Affects::elsewhere));
  f("settings", c.settings, anything<FreeTable>(), "what the library reads",
    only(c.library.has_value(), "it belongs to simulator.library"));
  f("dt", c.dt, not_negative(), "step of a truth's rollouts [s]", of_rollouts);
  f("num_steps", c.num_steps, count_from(0), "steps of a truth's rollouts", of_rollouts);
  f("initial_states", c.initial_states, anything<std::vector<std::vector<double>>>(),
    "a truth's rollouts begin there, in turn; their actions are 0", of_rollouts);
  f.table(
      "goal", "where rollouts of the user's simulator should come to rest",
      [&](auto& t) { describe(t, c.goal); }, of_rollouts);
  choice(f, "format", c.format, "of the command's files",
         only(c.command.has_value(), "it belongs to simulator.command"));
  f("folder", c.folder, anything<std::string>(),
    "where the program runs, seen from the study file's folder; empty: there",
    of_code(Affects::elsewhere));
  // A call of a library that takes longer ends the stage: no row depends on it.
  f("time_limit", c.time_limit, positive(),
    "for a call with all rows of a shard, or of a function of a library [s]",
    of_code(source.calls_program ? Affects::results : Affects::report));
  f("start_time", c.start_time, not_negative(),
    "added to the share of the time limit that a call with fewer rows has [s]",
    of_programs(Affects::results));
  f("retries", c.retries, between(0, 100),
    "of a call that failed, before its rows are split, and of rows that a call names as failed",
    of_programs(Affects::results));
  f("parallel_calls", c.parallel_calls, between(0, 4096),
    "calls that share a shard's rows at the same time; 0: one for each thread",
    of_programs(Affects::report));
  f("features", c.features, anything<std::vector<std::string>>(),
    "names of what x holds, each a label or \"label [unit]\"; empty: those of x_o, or x0, x1, ...",
    only(!source.gives_motion, "the simulator has state channels", Affects::elsewhere));
}

template <class Fields>
void describe(Fields& f, SimulatorTable& c) {
  describe(f, c.built_in, traits_of(c.external.kind()));
  describe(f, c.external);
}

}  // namespace npdr::pipeline
