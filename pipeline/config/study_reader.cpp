#include "pipeline/config/study_reader.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/check.h"
#include "pipeline/config/field_reader.h"
#include "pipeline/config/method_settings.h"
#include "pipeline/config/study_check.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/toml_document.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = 10'000'000;
constexpr Index kTruthRollouts = 5;

std::string read_text(const fs::path& file) {
  const std::string name = file.string();
  std::error_code unreadable;
  if (fs::is_directory(file, unreadable))
    throw InputError(name + ": is a folder, must be a study file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(name + ": can't be opened; does it exist and may you read it?");
  // Read through a limit instead of asking for the size, which pipes and devices don't have.
  std::string text(kMaxBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (stream.bad()) throw InputError(name + ": reading failed");
  if (text.size() > kMaxBytes) {
    throw InputError(name + ": is larger than 10 MB: not a study file");
  }
  return text;
}

// A relative path of a study starts at its folder, one of the command line at the current folder.
void resolve_path(std::optional<std::string>& value, const std::string& key, const fs::path& file,
                  const Reading& reading) {
  if (!value || reading.place(key).is_override()) return;
  const fs::path path = *value;
  if (path.is_relative()) value = (file.parent_path() / path).lexically_normal();
}

void resolve_target(TargetConfig& target, const fs::path& file, const Reading& reading) {
  resolve_path(target.recording, "target.recording", file, reading);
  resolve_path(target.observation, "target.observation", file, reading);
  resolve_path(target.inputs, "target.inputs", file, reading);
  if (target.truth && !target.inputs && !reading.has("target.num_rollouts")) {
    target.num_rollouts = kTruthRollouts;
  }
}

void resolve_networks(MethodConfig& method, std::size_t i, const Reading& reading) {
  const std::string key = "method[" + std::to_string(i) + "].density_estimator.num_networks";
  const bool has_one = !inference::allows_ensembles(inference::traits_of(method.algorithm.kind));
  if (has_one && !reading.has(key)) method.density_estimator.num_networks = 1;
}

// A method that names no algorithm means NPE-C by what that alone has.
void resolve_algorithm(MethodConfig& method, std::size_t i, const Reading& reading) {
  constexpr auto npe_c = inference::Algorithm::npe_c;
  const std::string path = "method[" + std::to_string(i) + "]";
  if (reading.has(path + ".algorithm")) return;
  const auto means_npe_c = [&](const UnusedField& field) {
    const std::string setting = field.path.substr(path.size() + 1);
    return field.use.settable && reading.has(field.path) && reads_setting(npe_c, setting);
  };
  if (std::ranges::any_of(unused_fields(method, {}, path), means_npe_c)) {
    method.algorithm.kind = npe_c;
  }
}

// A network sees principal components of all steps where nothing else is said, some for each
// parameter. What is said of layers means that they are trained, where they can be.
void resolve_default_embedding(MethodConfig& method, Index num_parameters, const std::string& path,
                               const Reading& reading) {
  constexpr Index fewest = 20, for_each = 4, most = 50;
  inference::EmbeddingConfig& embedding = method.embedding;
  if (reading.has(path + "kind") || reading.has(path + "principal_components")) return;
  const bool has_layers = reading.has(path + "features") || embedding.average_rollouts;
  const auto role = inference::traits_of(method.algorithm.kind).role;
  if (has_layers && role == inference::NetworkRole::posterior) {
    embedding.kind = inference::EmbeddingKind::convolution;
  } else {
    embedding.principal_components = std::clamp(for_each * num_parameters, fewest, most);
  }
}

// All states that are stored are seen. Features are as many as tell the parameters apart: a wider
// layer learns the simulations by heart.
void resolve_embedding(Study& study, std::size_t i, const Reading& reading) {
  const std::string path = "method[" + std::to_string(i) + "].embedding.";
  MethodConfig& method = study.methods[i];
  inference::EmbeddingConfig& embedding = method.embedding;
  if (!reading.has(path + "downsample")) embedding.downsample = study.simulator.store_every;
  const auto family = inference::traits_of(method.algorithm.kind).family;
  if (study.source().gives_motion && family == inference::AlgorithmFamily::network) {
    resolve_default_embedding(method, std::ssize(study.prior), path, reading);
  }
  if (reading.has(path + "features")) return;
  const Index twice = std::min<Index>(2 * std::ssize(study.prior), kMaxWidth);
  embedding.features = std::max(embedding.features, twice);
}

// Few simulations make smaller batches.
void resolve_batches(MethodConfig& method, std::size_t i, const Reading& reading) {
  if (reading.has("method[" + std::to_string(i) + "].training.batch_size")) return;
  const double rows =
      static_cast<double>(num_learned_from(method)) * (1.0 - method.training.validation_fraction);
  const Index most = std::max<Index>(1, static_cast<Index>(rows));
  method.training.batch_size = std::min(method.training.batch_size, most);
}

void resolve_without_network(MethodConfig& method, std::size_t i, const Reading& reading) {
  const auto family = inference::traits_of(method.algorithm.kind).family;
  if (family == inference::AlgorithmFamily::network) return;
  // Each population is that share of the last one: 0.1 would leave none after a few rounds.
  constexpr double smc_quantile = 0.5;
  const std::string quantile = "method[" + std::to_string(i) + "].abc.quantile";
  if (method.algorithm.kind == inference::Algorithm::abc_smc && !reading.has(quantile)) {
    method.abc.quantile = smc_quantile;
  }
  const bool has_rounds = family == inference::AlgorithmFamily::abc;
  if (!has_rounds) method.algorithm.num_rounds = 1;
}

void resolve_files(ExternalConfig& external, const fs::path& file, const Reading& reading) {
  resolve_path(external.dataset, "simulator.dataset", file, reading);
  resolve_path(external.library, "simulator.library", file, reading);
  resolve_path(external.mjcf, "simulator.mjcf", file, reading);
  std::optional<std::string> folder = external.folder;
  resolve_path(folder, "simulator.folder", file, reading);
  std::error_code error;
  external.folder = fs::absolute(folder->empty() ? "." : *folder, error).lexically_normal();
}

// Where the simulator gives features of x: one rollout of one step, that is measured as a whole.
void resolve_external(Study& study, const fs::path& file, const Reading& reading) {
  if (study.source().is_built_in) return;
  resolve_files(study.external, file, reading);
  if (study.source().gives_motion) return;
  study.target.num_rollouts = 1;
  study.evaluate.floor = false;
  if (!reading.has("evaluate.metrics")) {
    study.evaluate.metrics.clear();
    if (study.source().predicts_features()) study.evaluate.metrics = {Metric::distance};
  }
  for (std::size_t i = 0; i < study.methods.size(); ++i) {
    const std::string kind = "method[" + std::to_string(i) + "].embedding.kind";
    if (!reading.has(kind)) study.methods[i].embedding.kind = inference::EmbeddingKind::identity;
  }
}

// Whether fresh simulations of the prior cost little: at most a quarter of those that each method
// makes anyway, and posteriors of which a sample costs next to nothing.
bool can_calibrate_cheaply(const Study& study) {
  return std::ranges::all_of(study.methods, [&](const MethodConfig& method) {
    const inference::AlgorithmTraits& traits = inference::traits_of(method.algorithm.kind);
    if (traits.family != inference::AlgorithmFamily::network) return true;
    return traits.role == inference::NetworkRole::posterior &&
           method.algorithm.num_rounds * method.algorithm.num_simulations >=
               4 * study.diagnose.num_simulations;
  });
}

// Every study is checked, unless it says that it isn't: without [diagnose] by what costs little.
void resolve_checks(Study& study, const Reading& reading) {
  DiagnoseConfig& diagnose = study.diagnose;
  if (reading.has("diagnose.checks")) return;
  diagnose.checks = values_of<Check>();
  if (study.target.held_out == 0) std::erase(diagnose.checks, Check::held_out);
  if (study.source().simulates) std::erase(diagnose.checks, Check::dataset);
  const bool refines = std::ranges::any_of(study.methods, [](const MethodConfig& method) {
    return method.algorithm.kind == inference::Algorithm::refine;
  });
  if (!refines) std::erase(diagnose.checks, Check::residuals);
  if (reading.has("diagnose")) return;
  diagnose.num_samples = 200;
  const bool calibrates = can_calibrate_cheaply(study);
  std::erase_if(diagnose.checks, [&](Check check) {
    return traits_of(check).input == CheckInput::calibration &&
           (!calibrates || check == Check::tarp || check == Check::local_c2st);
  });
}

// Defaults that depend on other keys.
void resolve(Study& study, const fs::path& file, const Reading& reading) {
  resolve_target(study.target, file, reading);
  resolve_checks(study, reading);
  if (reading.has("policy") && !reading.has("policy.optimizer")) {
    study.policy.search.kind = inference::PolicyOptimizerKind::power;
  }
  resolve_external(study, file, reading);
  for (std::size_t i = 0; i < study.methods.size(); ++i) {
    resolve_algorithm(study.methods[i], i, reading);
    resolve_without_network(study.methods[i], i, reading);
    resolve_networks(study.methods[i], i, reading);
    resolve_embedding(study, i, reading);
    resolve_batches(study.methods[i], i, reading);
  }
}

}  // namespace

Study read_study(const fs::path& file, const std::vector<std::string>& overrides,
                 const ClusterConfig& site) {
  return parse_study(read_text(file), file, overrides, site);
}

Study parse_study(std::string_view text, const fs::path& file,
                  const std::vector<std::string>& overrides, const ClusterConfig& site) {
  Reading reading(file.string());
  const nlohmann::json document = read_toml(text, overrides, reading);
  Study study;
  study.cluster = site;
  FieldReader fields(&document, "", reading);
  describe(fields, study);
  fields.reject_unknown_keys();
  resolve(study, file, reading);
  check_study(study, reading);
  reading.problems().throw_if_any();
  study.places = reading.places();
  return study;
}

ClusterConfig read_site(const fs::path& file) {
  Reading reading(file.string());
  const nlohmann::json document = read_toml(read_text(file), {}, reading);
  ClusterConfig cluster;
  FieldReader fields(&document, "", reading);
  fields.table("cluster", "", [&](auto& table) { describe(table, cluster); });
  fields.reject_unknown_keys();
  reading.problems().throw_if_any();
  return cluster;
}

}  // namespace npdr::pipeline
