/// Where a study's rows come from: a built-in simulator, one of the user's, a dataset.
///
/// A source says what its rows are about, what they depend on, and how to get them. Whoever has one
/// needn't know which of them it is. Another kind is a class like those of make_source().
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/target.h"
#include "pipeline/config/study.h"
#include "pipeline/sources/parameter_map.h"
#include "pipeline/sources/row_simulator.h"

namespace npdr::pipeline {

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

 private:
  Target replay_truth(Target begun, const std::filesystem::path& log) const;

  Study study_;
  sim::SimulatorInfo info_;
  ParameterMap parameters_;
};

std::unique_ptr<Source> make_source(const Study& study);

/// Completes a study by what its files say: how many rollouts a truth has that begins like a
/// recording; where the source gives features, their names, and x_o, which is returned where the
/// study names a file. Throws InputError.
std::optional<Target> resolve_source(Study& study);

}  // namespace npdr::pipeline
