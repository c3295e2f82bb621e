#include "pipeline/config/method_settings.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/text.h"
#include "inference/algorithms/pool_powers.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {
namespace {

template <std::size_t N>
bool is_one_of(const std::array<std::string_view, N>& keys, const std::string& key) {
  return std::ranges::find(keys, key) != keys.end();
}

constexpr std::array<std::string_view, 3> kOfAll = {"name", "algorithm", "policy_iterations"};
constexpr std::array<std::string_view, 3> kOfInference = {"num_rollouts", "num_iterations",
                                                          "published"};
constexpr std::array<std::string_view, 3> kOfSimulations = {"num_rounds", "num_simulations",
                                                            "embedding"};

constexpr std::array<std::string_view, 2> kOfNetworks = {"density_estimator", "training"};

bool network_reads(const inference::AlgorithmTraits& algorithm, const std::string& key) {
  if (is_one_of(kOfNetworks, key)) return true;
  const std::vector<std::string> own = split(std::string(algorithm.settings), ' ');
  if (std::ranges::find(own, key) != own.end()) return true;
  return key == "sampler" && algorithm.role != inference::NetworkRole::posterior;
}

}  // namespace

bool reads_setting(inference::Algorithm algorithm, const std::string& key) {
  if (is_one_of(kOfAll, key)) return true;
  const inference::AlgorithmTraits& traits = inference::traits_of(algorithm);
  const inference::AlgorithmFamily family = traits.family;
  if (family != inference::AlgorithmFamily::fixed && is_one_of(kOfInference, key)) return true;
  switch (family) {
    case inference::AlgorithmFamily::fixed:
      return false;
    case inference::AlgorithmFamily::regression:
      return key == "linear_regression";
    case inference::AlgorithmFamily::likelihood:
      return key == "refine";
    case inference::AlgorithmFamily::abc:
      return key == "abc" || is_one_of(kOfSimulations, key);
    case inference::AlgorithmFamily::network:
      break;
  }
  return is_one_of(kOfSimulations, key) || network_reads(traits, key);
}

Index num_learned_from(const MethodConfig& method) {
  const Index count = method.algorithm.num_simulations;
  const bool is_pooled = method.algorithm.kind == inference::Algorithm::npe_nle;
  return is_pooled ? count - inference::num_judging_rows(count) : count;
}

}  // namespace npdr::pipeline
