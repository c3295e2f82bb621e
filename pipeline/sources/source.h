/// Where a study's rows come from: a built-in simulator, a command, a dataset.
///
/// A source says what its rows are about, what they depend on, and how to get them. Whoever has one
/// needn't know which of the three it is. Another kind is a class like those of make_source().
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
  sim::SimulatorConfig simulator;  ///< settings of a built-in simulator
  Target target;                   ///< that it replays
  std::filesystem::path log = {};  ///< of programs; empty: none
  std::uint64_t seed = 0;          ///< of the experiment: picks rows of a dataset
  Index num_rows = 0;              ///< of the simulation
};

class Source {
 public:
  /// Takes a study that has been resolved (resolve_source()). Throws InputError for names that its
  /// simulator doesn't have.
  explicit Source(Study study);
  virtual ~Source() = default;

  const SourceTraits& traits() const { return study_.source(); }
  const sim::SimulatorInfo& info() const { return info_; }
  const ParameterMap& parameters() const { return parameters_; }

  /// Reads what a study refers to. Throws InputError.
  virtual SourceKeys keys() const = 0;

  /// theta (count, D) that comes with the rows of an experiment; none: it has to be proposed.
  /// Throws InputError.
  virtual std::optional<RowMatrix> theta(std::uint64_t /*seed*/, Index /*count*/) const {
    return std::nullopt;
  }

  /// Opens what simulates rows of theta, or has them already. Throws InputError.
  virtual std::unique_ptr<RowSimulator> open(const RowsConfig& config) const = 0;

  /// The simulated target domain, held-out rollouts last. Throws Error when its simulation fails.
  virtual Target behave(const std::filesystem::path& log) const = 0;

 protected:
  const Study& study() const { return study_; }

 private:
  Study study_;
  sim::SimulatorInfo info_;
  ParameterMap parameters_;
};

/// The source of a study that has been resolved. Throws InputError as its constructor.
std::unique_ptr<Source> make_source(const Study& study);

/// Completes a study whose source gives features by what its files say: names of the features, and
/// x_o, which is returned where the study names a file. Throws InputError.
std::optional<Target> resolve_source(Study& study);

}  // namespace npdr::pipeline
