/// Where a study's rows come from: a built-in simulator, one of the user's, a dataset.
///
/// A source says what its rows are about, what they depend on, and how to get them. Whoever has one
/// needn't know which of them it is. Another kind is a class like those of make_source().
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/finding.h"
#include "core/random.h"
#include "core/target.h"
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/config/study.h"
#include "sim/segments.h"
#include "sim/simulator.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// The stream that names the random numbers of a simulation's rows.
inline constexpr const char* kSimulationStream = "external_simulation";
/// The same of a simulated target domain.
inline constexpr const char* kTruthStream = "external_truth";

/// The number of no row: for simulations beside a study's own, whose rows count on from there.
inline constexpr std::uint64_t kNoRow = std::uint64_t{1} << 62;

/// One way to simulate rows of theta, whatever the study's simulator is.
class RowSimulator {
 public:
  virtual ~RowSimulator() = default;

  /// Rows of all parameters (n, P) as rollouts (n, H, T, C), or features (n, 1, 1, F). `first`
  /// names the random numbers of row 0, and with its row counted on those of the others. Throws
  /// InputError for a damaged dataset, and what ExternalSimulator::simulate() throws.
  virtual sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) = 0;

  /// Rows that are worth simulating at once, of a shard of `num_rows`.
  virtual Index block_size(Index num_rows) const = 0;

  /// Calls of programs that share out rows among them and work at the same time.
  virtual Index num_calls() const { return 1; }

  /// Completes the log, and begins another; empty: none. For programs, whose output is kept.
  virtual void log_to(const std::filesystem::path& /*log*/) {}

  /// Why rows were lost, for people: the problem of a call, or else a number; where none was, that
  /// of a call which went well when it was repeated; "": there was none, or it can't say.
  virtual std::string last_failure() const { return ""; }

  /// What is probably wrong with rows that it gave last, as far as it can say.
  virtual Findings last_warnings() const { return {}; }
};

/// The map between the D parameters of a study's prior and the P parameters of its simulator. Const
/// calls are thread-safe.
class ParameterMap {
 public:
  /// `info`: of the study's simulator. Throws InputError for a parameter of the prior that it
  /// doesn't have.
  ParameterMap(const Study& study, const sim::SimulatorInfo& info);

  /// All parameters (P): the study's nominal ones, `values` in place of some. Throws InputError for
  /// an unknown name, here or in simulator.parameters.
  Vector nominal(const std::map<std::string, double>& values = {}) const;

  /// All parameters (n, P) for theta (n, D): what isn't in the prior is nominal.
  RowMatrix complete(const RowMatrix& theta) const;

  /// theta (n, D) among all parameters (n, P).
  RowMatrix pick(const RowMatrix& complete) const { return complete(Eigen::all, columns_); }
  /// theta (D) among all parameters (P).
  Vector pick_one(const Vector& complete) const { return complete(columns_); }

 private:
  sim::SimulatorInfo info_;
  std::map<std::string, double> nominal_values_;  // of the study
  std::vector<Index> columns_;                    // (D) among the P
};

/// Parts of key documents: what rows depend on.
struct SourceKeys {
  nlohmann::ordered_json rows;    ///< a simulation
  nlohmann::ordered_json states;  ///< the same with every state kept
  nlohmann::ordered_json truth;   ///< a simulated target domain, and closed loops
  nlohmann::ordered_json theta;   ///< proposals: {} where they are drawn
};

/// Rows that are asked for.
struct RowsConfig {
  sim::SimulatorConfig simulator = {};  ///< segments, stored states; settings of a built-in one
  Target target = {};                   ///< that it replays
  std::filesystem::path log = {};       ///< of programs; empty: none
  std::uint64_t seed = 0;               ///< of the experiment: picks rows of a dataset
  Index num_rows = 0;                   ///< of the simulation
};

class Source {
 public:
  /// Takes a study that has been resolved (resolve_source()). Throws InputError.
  explicit Source(Study study);
  virtual ~Source() = default;

  const SourceTraits& traits() const { return study_.source(); }
  const sim::SimulatorInfo& info() const { return info_; }
  const ParameterMap& parameters() const { return parameters_; }

  /// Whether every parameter has a nominal value, so that there are nominal rollouts.
  bool has_nominal() const { return parameters_.nominal().allFinite(); }

  /// Reads what a study refers to. Throws InputError.
  virtual SourceKeys keys() const = 0;

  /// theta (count, D) that comes with the rows of an experiment; none: it has to be proposed.
  virtual std::optional<RowMatrix> theta(std::uint64_t /*seed*/, Index /*count*/) const {
    return std::nullopt;
  }

  /// Opens the simulator of rows. Throws InputError for settings, or a dataset, that can't be used.
  virtual std::unique_ptr<RowSimulator> open(const RowsConfig& config) const = 0;

  /// The simulated target domain, held-out rollouts last, numbered in that order; of a source that
  /// gives features x_o at the truth. Throws Error when its simulation fails.
  Target behave(const std::filesystem::path& log) const;

 protected:
  const Study& study() const { return study_; }

  /// Settings of the table [simulator] that rows depend on as they stand; what a source notes down
  /// in another form is not among them.
  nlohmann::ordered_json settings() const;
  /// The same but for nominal parameters, segments and stored states, which keys of the user's
  /// simulators have at their end.
  nlohmann::ordered_json own_settings() const;

  /// The parts of keys when `rows` is what every simulation depends on: adds segments, stored
  /// states, and how a truth's rollouts begin.
  SourceKeys keys_of_motion(const nlohmann::ordered_json& rows) const;

  /// Rollouts of a truth with initial states and actions, those of target.inputs or else of
  /// simulator.initial_states, in turn, with actions 0; held-out ones last. All other states are 0.
  /// Throws InputError for inputs that can't be read, have other channels or too few rollouts, and
  /// for initial states of another width.
  Target begun_truth() const;

 private:
  Target resting_truth() const;
  Target replay_truth(Target begun, const std::filesystem::path& log) const;

  Study study_;
  sim::SimulatorInfo info_;
  ParameterMap parameters_;
};

/// Throws InputError for a study that its source can't be made of.
std::unique_ptr<Source> make_source(const Study& study);

/// The kinds of sources: simulators of sim/; shared libraries of the user's, or npdr's own for
/// models of MuJoCo; programs that exchange files or answer requests (external_simulator.h), with
/// the files that their commands name; finished datasets.
std::unique_ptr<Source> make_built_in_source(const Study& study);
std::unique_ptr<Source> make_library_source(const Study& study);
std::unique_ptr<Source> make_program_source(const Study& study);
std::unique_ptr<Source> make_dataset_source(const Study& study);

/// Completes a study by what its files say: how many rollouts a truth has that begins like a
/// recording; where the source gives features, their names, and x_o, which is returned where the
/// study names a file. Throws InputError.
std::optional<Target> resolve_source(Study& study);

/// `count` different rows of `num_rows`: the first ones of a random order that depends on the seed
/// and on num_rows alone. So a larger count keeps the rows of a smaller one, and any part of them
/// is like the whole, also of a file that is sorted.
std::vector<Index> dataset_rows(std::uint64_t seed, Index num_rows, Index count);

/// The study's dataset, with the prior's parameters and the study's features. Throws InputError.
DatasetFile open_dataset(const Study& study);

/// Rows of x (n, F) as a simulator would hand them back: out of limits where theta (n, D) is
/// outside of the prior's support, diverged where an x isn't finite.
sim::Trajectories as_simulated(const inference::Prior& prior, const RowMatrix& theta,
                               const RowMatrix& x);

/// Features of a simulator that gives these, as (n, F).
inline Eigen::Map<const RowMatrixF> features_of(const sim::Trajectories& x) {
  return {x.values.data(), x.num_rows, x.row_size()};
}

/// Features as the states of a rollout of one step.
sim::Segments feature_segments(Index num_features);

/// The first number of a row that isn't finite, or isn't one that a float holds: "nan in 'omega',
/// step 17 of rollout 2". `row`: (N, C), N steps of all rollouts; without the step where
/// `num_steps`, those of one rollout, is 1, as of features. "": there is none.
std::string find_lost_number(std::span<const double> row, const std::vector<Channel>& channels,
                             Index num_steps);

/// The seed of row `i` after the row that `first` names: one that fits into a signed 32-bit
/// integer, as many programs want it.
std::uint32_t row_seed(const StreamId& first, Index i);

/// The log of the programs that make an artefact: it lies beside it.
std::filesystem::path log_of(const std::filesystem::path& artefact);

}  // namespace npdr::pipeline
