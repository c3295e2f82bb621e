#include "pipeline/config/study_reader.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/check.h"
#include "pipeline/config/checker.h"
#include "pipeline/config/field_reader.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = 10'000'000;
constexpr Index kTruthRollouts = 5;

// The study that a name of none may mean: its end left out, or a letter wrong.
std::string advice_on_name(const fs::path& file, const std::string& otherwise) {
  std::error_code error;
  if (fs::is_regular_file(file, error)) return otherwise;
  std::string meant = file.filename().string() + ".toml";
  if (!fs::is_regular_file(file.parent_path() / meant, error)) {
    std::vector<std::string> studies;
    for (const auto& entry : fs::directory_iterator(file.parent_path() / ".", error)) {
      if (entry.path().extension() == ".toml" && entry.is_regular_file(error))
        studies.push_back(entry.path().filename().string());
    }
    std::ranges::sort(studies);
    meant = nearest_name(file.filename().string(), studies);
  }
  return meant.empty() ? otherwise : "did you mean " + (file.parent_path() / meant).string() + "?";
}

std::string read_text(const fs::path& file) {
  const std::string name = file.string();
  std::error_code unreadable;
  if (fs::is_directory(file, unreadable))
    throw InputError(name + ": is a folder, " + advice_on_name(file, "must be a study file"));
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw InputError(name + ": can't be opened; " +
                     advice_on_name(file, "does it exist and may you read it?"));
  }
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

// Defaults that depend on other keys.
class Resolver {
 public:
  Resolver(Study& study, const fs::path& file, const Reading& reading)
      : study_(study), file_(file), reading_(reading) {}

  void resolve() {
    resolve_target();
    resolve_checks();
    if (reading_.has("policy") && !reading_.has("policy.optimizer")) {
      study_.policy.search.kind = inference::PolicyOptimizerKind::power;
    }
    resolve_external();
    add_fit();
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      resolve_method(study_.methods[i], path_of(i));
    }
  }

 private:
  static std::string path_of(std::size_t i) { return "method[" + std::to_string(i) + "]"; }

  // A relative path of a study starts at its folder, one of the command line at the current folder.
  void resolve_path(std::optional<std::string>& value, const std::string& key) {
    if (!value || reading_.place(key).is_override()) return;
    const fs::path path = *value;
    if (path.is_relative()) value = (file_.parent_path() / path).lexically_normal();
  }

  void resolve_target() {
    TargetConfig& target = study_.target;
    resolve_path(target.recording, "target.recording");
    resolve_path(target.observation, "target.observation");
    resolve_path(target.inputs, "target.inputs");
    if (target.truth && !target.inputs && !reading_.has("target.num_rollouts")) {
      target.num_rollouts = kTruthRollouts;
    }
  }

  // Every study is checked, unless it says that it isn't: without [diagnose] by what costs little.
  void resolve_checks() {
    DiagnoseConfig& diagnose = study_.diagnose;
    if (reading_.has("diagnose.checks")) return;
    diagnose.checks = values_of<Check>();
    if (study_.target.held_out == 0) std::erase(diagnose.checks, Check::held_out);
    if (study_.source().simulates) std::erase(diagnose.checks, Check::dataset);
    const bool refines = std::ranges::any_of(study_.methods, [](const MethodConfig& method) {
      return method.algorithm.kind == inference::Algorithm::refine;
    });
    if (!refines) std::erase(diagnose.checks, Check::residuals);
    if (reading_.has("diagnose")) return;
    diagnose.num_samples = 200;
    const bool calibrates = can_calibrate_cheaply(study_);
    std::erase_if(diagnose.checks, [&](Check check) {
      return traits_of(check).input == CheckInput::calibration &&
             (!calibrates || check == Check::tarp || check == Check::local_c2st);
    });
  }

  // Where the simulator gives features of x: one rollout of one step, that is measured as a whole.
  void resolve_external() {
    if (study_.source().is_built_in) return;
    resolve_files();
    if (study_.source().gives_motion) return;
    study_.target.num_rollouts = 1;
    study_.evaluate.floor = false;
    if (!reading_.has("evaluate.metrics")) {
      study_.evaluate.metrics.clear();
      if (study_.source().predicts_features()) study_.evaluate.metrics = {Metric::distance};
    }
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      if (reading_.has(path_of(i) + ".embedding.kind")) continue;
      inference::EmbeddingConfig& embedding = study_.methods[i].embedding;
      embedding.kind = embedding.shape.empty() ? inference::EmbeddingKind::identity
                                               : inference::EmbeddingKind::convolution;
    }
  }

  // Every recording is fitted, which is the first answer and what others are compared with.
  void add_fit() {
    constexpr const char* name = "Least squares";
    if (!study_.target.recording || !study_.source().gives_motion || !study_.evaluate.floor) return;
    const bool is_there = std::ranges::any_of(study_.methods, [](const MethodConfig& method) {
      return family_of(method) == inference::AlgorithmFamily::fit;
    });
    const bool is_taken =
        std::ranges::any_of(study_.methods, [](const MethodConfig& m) { return m.name == name; });
    study_.evaluate.floor =
        is_there || (study_.source().simulates && !reading_.has("policy") && !is_taken);
    if (is_there || !study_.evaluate.floor) return;
    MethodConfig& fit = study_.methods.emplace_back();
    fit.name = name;
    fit.algorithm.kind = inference::Algorithm::least_squares;
  }

  // Of users' simulators, which may be slow, not more rows than for other methods.
  void resolve_fit(MethodConfig& method) {
    if (study_.source().is_built_in) return;
    Index most = 0;
    for (const MethodConfig& other : study_.methods) {
      if (learns(other)) {
        most = std::max(most, other.algorithm.num_rounds * other.algorithm.num_simulations);
      }
    }
    inference::LeastSquaresConfig& fit = method.least_squares;
    if (most > 0) fit.max_simulations = std::min(fit.max_simulations, most);
  }

  void resolve_files() {
    ExternalConfig& external = study_.external;
    resolve_path(external.dataset, "simulator.dataset");
    resolve_path(external.library, "simulator.library");
    resolve_path(external.mjcf, "simulator.mjcf");
    std::optional<std::string> folder = external.folder;
    resolve_path(folder, "simulator.folder");
    std::error_code error;
    external.folder = fs::absolute(folder->empty() ? "." : *folder, error).lexically_normal();
  }

  // A method that names no algorithm means NPE-C by what that alone has.
  void resolve_algorithm(MethodConfig& method, const std::string& path) {
    constexpr auto npe_c = inference::Algorithm::npe_c;
    if (reading_.has(path + ".algorithm")) return;
    const auto means_npe_c = [&](const UnusedField& field) {
      const std::string setting = field.path.substr(path.size() + 1);
      return field.use.settable && reading_.has(field.path) && reads_setting(npe_c, setting);
    };
    if (std::ranges::any_of(unused_fields(fields_of(method), path), means_npe_c)) {
      method.algorithm.kind = npe_c;
    }
  }

  void resolve_method(MethodConfig& method, const std::string& path) {
    using enum inference::AlgorithmFamily;
    resolve_algorithm(method, path);
    const auto leaves_out = [&](const char* key) { return !reading_.has(path + key); };
    const inference::AlgorithmTraits& traits = inference::traits_of(method.algorithm.kind);
    // Each population is that share of the last one: 0.1 would leave none after a few rounds.
    constexpr double smc_quantile = 0.5;
    if (method.algorithm.kind == inference::Algorithm::abc_smc && leaves_out(".abc.quantile")) {
      method.abc.quantile = smc_quantile;
    }
    if (traits.family != network && traits.family != abc) method.algorithm.num_rounds = 1;
    if (traits.family == network && leaves_out(".density_estimator.kind")) {
      method.density_estimator.kind = inference::estimators_of(traits).front();
    }
    if (!inference::allows_ensembles(traits) && leaves_out(".density_estimator.num_networks")) {
      method.density_estimator.num_networks = 1;
    }
    if (traits.family == fit && leaves_out(".least_squares.max_simulations")) resolve_fit(method);
    resolve_embedding(method, path + ".embedding.");
    if (leaves_out(".training.batch_size")) {  // few simulations make smaller batches
      const auto rows = static_cast<Index>(static_cast<double>(num_learned_from(method)) *
                                           (1.0 - method.training.validation_fraction));
      method.training.batch_size = std::min(method.training.batch_size, std::max<Index>(1, rows));
    }
  }

  // All states that are stored are seen. Features are as many as tell the parameters apart: a wider
  // layer learns the simulations by heart.
  void resolve_embedding(MethodConfig& method, const std::string& path) {
    inference::EmbeddingConfig& embedding = method.embedding;
    if (!reading_.has(path + "downsample")) embedding.downsample = study_.simulator.store_every;
    if (study_.source().gives_motion && family_of(method) == inference::AlgorithmFamily::network) {
      resolve_default_embedding(method, path);
    }
    if (reading_.has(path + "features")) return;
    const Index twice = std::min<Index>(2 * std::ssize(study_.prior), kMaxWidth);
    embedding.features = std::max(embedding.features, twice);
  }

  // A network sees principal components of all steps where nothing else is said, some for each
  // parameter. What is said of layers means that they are trained, where they can be.
  void resolve_default_embedding(MethodConfig& method, const std::string& path) {
    constexpr Index fewest = 20, for_each = 4, most = 50;
    inference::EmbeddingConfig& embedding = method.embedding;
    if (reading_.has(path + "kind") || reading_.has(path + "principal_components")) return;
    const bool has_layers = reading_.has(path + "features") || embedding.average_rollouts;
    const auto role = inference::traits_of(method.algorithm.kind).role;
    if (has_layers && role == inference::NetworkRole::posterior) {
      embedding.kind = inference::EmbeddingKind::convolution;
    } else {
      embedding.principal_components =
          std::clamp(for_each * std::ssize(study_.prior), fewest, most);
    }
  }

  Study& study_;
  const fs::path& file_;
  const Reading& reading_;
};

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
  read_fields(study, &document, reading);
  Resolver(study, file, reading).resolve();
  check_study(study, reading);
  reading.throw_if_bad();
  study.places = reading.places();
  return study;
}

ClusterConfig read_site(const fs::path& file) {
  Reading reading(file.string());
  const nlohmann::json document = read_toml(read_text(file), {}, reading);
  ClusterConfig cluster;
  FieldReader(&document, "", reading).read([&](auto& root) {
    root.table("cluster", "", [&](auto& table) { describe(table, cluster); });
  });
  reading.throw_if_bad();
  return cluster;
}

}  // namespace npdr::pipeline
