#include "pipeline/config/source_check.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <set>
#include <system_error>

#include "core/feature_names.h"
#include "core/text.h"
#include "inference/embeddings/embedding_config.h"
#include "pipeline/config/checker.h"
#include "pipeline/config/constraint.h"

namespace npdr::pipeline {
namespace {

class SourceChecker : Checker {
 public:
  SourceChecker(const Study& study, Reading& reading)
      : Checker(reading), study_(study), source_(study.source()), what_(source_.name) {}

  void check() {
    if (!source_.calls_program) {
      for (const char* key :
           {"format", "folder", "time_limit", "start_time", "retries", "parallel_calls"}) {
        must_be_left_out(std::string("simulator.") + key, "it belongs to simulator.command");
      }
    }
    source_.gives_motion ? check_motion() : check_features();
    if (source_.calls_program) check_program();
    if (!source_.simulates) check_dataset();
  }

 private:
  void check_features() {
    check_unused();
    check_names();
    check_target();
    for (std::size_t i = 0; i < study_.references.size(); ++i) {
      check_complete(fmt::format("reference[{}].parameters", i), study_.references[i].parameters);
    }
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      check_method(fmt::format("method[{}]", i), study_.methods[i]);
    }
  }

  void check_motion() {
    must_be_left_out("simulator.features", "the simulator has state channels");
    must_be_left_out("target.observation", "it is for a simulator.command or dataset");
    for (const Metric metric : study_.evaluate.metrics) {
      if (metric != Metric::distance) continue;
      fail("evaluate.metrics", quoted(name_of(metric)), "left out: it is for a simulator.command");
    }
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      if (study_.methods[i].embedding.kind != inference::EmbeddingKind::identity) continue;
      fail(fmt::format("method[{}].embedding.kind", i), "'identity'",
           "another: it is for a simulator.command or dataset; 'all_steps' keeps all states");
    }
  }

  void check_unused() {
    for (const char* key :
         {"segment_length", "integrator", "substeps", "store_every", "minigolf"}) {
      must_be_left_out(std::string("simulator.") + key, "it means nothing to a " + what_);
    }
    for (const char* path : {"target.recording", "target.num_rollouts", "target.held_out"}) {
      must_be_left_out(path, no_rollouts());
    }
    must_be_left_out("evaluate.floor", "no search is made with a " + what_);
    const std::vector<Metric> only_metric = {Metric::distance};
    if (!source_.simulates || study_.evaluate.metrics != only_metric) {
      must_be_left_out("evaluate.metrics", no_rollouts());
    }
  }

  // They head the columns of CSV files.
  void check_names() {
    const Constraint<std::string> allowed = column_name();
    std::set<std::string> features;
    for (const std::string& name : study_.external.features) {
      const std::string label = parse_feature(name).label;
      if (!satisfies(label, allowed)) fail("simulator.features", quoted(name), allowed.words);
      if (!features.insert(label).second) fail("simulator.features", quoted(name), "there once");
    }
    for (const inference::Marginal& marginal : study_.prior) {
      if (satisfies(marginal.name, allowed)) continue;
      reading_.fail("prior." + marginal.name, fmt::format("prior: the name {} must be {}",
                                                          quoted(marginal.name), allowed.words));
    }
    for (const auto& [name, value] : study_.simulator.parameters) {
      if (satisfies(name, allowed)) continue;
      reading_.fail(
          "simulator.parameters." + name,
          fmt::format("simulator.parameters: the name {} must be {}", quoted(name), allowed.words));
    }
  }

  // Without nominal values, whoever names parameters must name all of the prior.
  void check_complete(const std::string& path, const std::map<std::string, double>& values) {
    for (const inference::Marginal& marginal : study_.prior) {
      if (values.contains(marginal.name)) continue;
      reading_.fail(path, fmt::format("{}: '{}' is missing: a {} has no nominal values",
                                      display(path), marginal.name, what_));
    }
  }

  void check_target() {
    const TargetConfig& target = study_.target;
    if (!reading_.good("target.observation") || !reading_.good("target.truth")) return;
    if (target.observation.has_value() == target.truth.has_value()) {
      reading_.fail("target",
                    fmt::format("target has {} observation = \"x_o.csv\" {} truth = {{ parameter = "
                                "value }}, must have one of them",
                                target.truth ? "both" : "neither", target.truth ? "and" : "nor"));
    } else if (target.truth) {
      check_truth(*target.truth);
    } else {
      must_be_left_out("target.seed", "it picks the random behavior of a truth");
      require_file("target.observation", *target.observation, "an existing CSV or HDF5 file");
    }
  }

  void check_truth(const std::map<std::string, double>& truth) {
    check_complete("target.truth", truth);
    if (!study_.external.features.empty() || !source_.simulates) return;
    reading_.fail("simulator.features",
                  "simulator.features is missing, must be the names of what x holds: with a truth "
                  "there is no file of x_o to take them from");
  }

  void check_method(const std::string& path, const MethodConfig& method) {
    for (const char* key : {".num_rollouts", ".embedding.downsample", ".embedding.features"}) {
      must_be_left_out(path + key, no_rollouts());
    }
    const inference::EmbeddingKind kind = method.embedding.kind;
    if (kind != inference::EmbeddingKind::identity && reading_.good(path + ".embedding.kind")) {
      fail(path + ".embedding.kind", quoted(name_of(kind)), "'identity': " + no_rollouts());
    }
    const Index rounds = method.algorithm.num_rounds;
    if (!source_.simulates && rounds != 1 && reading_.good(path + ".num_rounds")) {
      fail(path + ".num_rounds", std::to_string(rounds),
           "1 with a dataset: nothing simulates what later rounds propose");
    }
  }

  void check_program() {
    std::error_code unreadable;
    if (std::filesystem::is_directory(study_.external.folder, unreadable)) return;
    fail("simulator.folder", quoted(study_.external.folder), "an existing folder");
  }

  void check_dataset() {
    for (const char* path : {"simulator.parameters", "target.truth", "target.seed"}) {
      must_be_left_out(path, "a dataset can't be simulated again");
    }
    require_file("simulator.dataset", *study_.external.dataset,
                 "an existing HDF5 file; 'npdr import --theta' makes one of CSV files");
  }

  std::string no_rollouts() const { return "a " + what_ + " gives no rollouts"; }

  const Study& study_;
  const SourceTraits& source_;
  std::string what_;
};

}  // namespace

void check_source(const Study& study, Reading& reading) {
  if (!reading.good("simulator")) return;
  std::vector<std::string> found;
  if (!study.simulator.name.empty()) found.emplace_back("name");
  if (study.external.command) found.emplace_back("command");
  if (study.external.dataset) found.emplace_back("dataset");
  if (found.empty()) {
    reading.fail("simulator.name", "simulator.name is missing, must be text, one of " +
                                       join(sim::simulator_names()) +
                                       "; a command or a dataset may take its place");
  } else if (found.size() > 1) {
    reading.fail("simulator." + found.back(),
                 "simulator has " + join(found, " and ") + ", must have one of them");
  }
}

void check_source_settings(const Study& study, Reading& reading) {
  for (const char* source : {"name", "command", "dataset"}) {
    if (!reading.good(std::string("simulator.") + source)) return;
  }
  SourceChecker(study, reading).check();
}

void check_dataset_rows(const Study& study, Index num_rows) {
  Reading reading(study.places);
  for (std::size_t i = 0; i < study.methods.size(); ++i) {
    const Index wanted = study.methods[i].algorithm.num_simulations;
    if (wanted <= num_rows) continue;
    const std::string path = "method[" + std::to_string(i) + "].num_simulations";
    Checker(reading).fail(path, std::to_string(wanted),
                          "<= " + std::to_string(num_rows) + ", the rows of the dataset");
  }
  if (num_rows > std::numeric_limits<std::uint32_t>::max()) {
    Checker(reading).fail("simulator.dataset", std::to_string(num_rows) + " rows",
                          "of < 2^32 rows");
  }
  reading.problems().throw_if_any();
}

}  // namespace npdr::pipeline
