#include <algorithm>
#include <array>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "inference/algorithms/algorithm_config.h"

namespace npdr::inference {
namespace {

struct Entry {
  const char* name;
  AlgorithmFamily family;
  NetworkRole role;                     // of a network
  std::vector<std::string> estimators;  // the usual one first
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = {
      {"npe_a", AlgorithmFamily::network, NetworkRole::posterior, {"mdn"}},
      {"npe_b", AlgorithmFamily::network, NetworkRole::posterior, {"maf", "mdn", "nsf"}},
      {"npe_c", AlgorithmFamily::network, NetworkRole::posterior, {"maf", "mdn", "nsf"}},
      {"nle", AlgorithmFamily::network, NetworkRole::likelihood, {"maf", "mdn", "nsf"}},
      {"nre_a", AlgorithmFamily::network, NetworkRole::ratio, {"resnet"}},
      {"nre_b", AlgorithmFamily::network, NetworkRole::ratio, {"resnet"}},
      {"abc_rejection", AlgorithmFamily::abc, {}, {}},
      {"abc_mcmc", AlgorithmFamily::abc, {}, {}},
      {"abc_smc", AlgorithmFamily::abc, {}, {}},
      {"linear_regression", AlgorithmFamily::regression, {}, {}},
      {"prior", AlgorithmFamily::fixed, {}, {}},
      {"nominal", AlgorithmFamily::fixed, {}, {}},
  };
  return all;
}

// Names that older papers and tools use for the same algorithm.
constexpr std::array<std::pair<const char*, const char*>, 20> kOlderSpellings = {{
    {"snpe_a", "npe_a"},
    {"snpe-a", "npe_a"},
    {"bayessim", "npe_a"},
    {"snpe_b", "npe_b"},
    {"snpe-b", "npe_b"},
    {"snpe_c", "npe_c"},
    {"snpe-c", "npe_c"},
    {"apt", "npe_c"},
    {"snle", "nle"},
    {"aalr", "nre_a"},
    {"snre_a", "nre_a"},
    {"snre_b", "nre_b"},
    {"abc", "abc_rejection"},
    {"rejection_abc", "abc_rejection"},
    {"mcabc", "abc_rejection"},
    {"mcmc_abc", "abc_mcmc"},
    {"smc_abc", "abc_smc"},
    {"blr", "linear_regression"},
    {"bayesian_linear_regression", "linear_regression"},
    {"domain_randomization", "prior"},
}};

const Entry& find_entry(const std::string& spelling) {
  const std::string name = canonical_algorithm(spelling);
  return *std::ranges::find(entries(), name, &Entry::name);
}

}  // namespace

std::vector<std::string> algorithm_names() {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) names.emplace_back(entry.name);
  return names;
}

std::string canonical_algorithm(const std::string& spelling) {
  for (const std::string& name : algorithm_names()) {
    if (spelling == name) return name;
  }
  for (const auto& [older, name] : kOlderSpellings) {
    if (spelling == older) return name;
  }
  throw InputError(unknown_name("algorithm", spelling, algorithm_names()));
}

AlgorithmFamily family_of_algorithm(const std::string& name) { return find_entry(name).family; }

NetworkRole role_of_algorithm(const std::string& name) {
  const Entry& entry = find_entry(name);
  if (entry.family == AlgorithmFamily::network) return entry.role;
  throw Error(std::string("algorithm '") + entry.name + "' has no network");
}

std::vector<std::string> estimators_of_algorithm(const std::string& name) {
  return find_entry(name).estimators;
}

void check_estimator(const std::string& algorithm, const EstimatorConfig& estimator) {
  const std::vector<std::string>& allowed = find_entry(algorithm).estimators;
  if (std::ranges::find(allowed, estimator.kind) != allowed.end()) return;
  throw InputError("density_estimator.kind = '" + estimator.kind + "', must be one of " +
                   join(allowed) + " with algorithm '" + algorithm + "'");
}

}  // namespace npdr::inference
