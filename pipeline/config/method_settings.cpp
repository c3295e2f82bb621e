#include "pipeline/config/method_settings.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "inference/algorithms/algorithm_config.h"

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

bool network_reads(const std::string& algorithm, const std::string& key) {
  if (key == "density_estimator" || key == "training") return true;
  if (key == "component_perturbation") return algorithm == "npe_a";
  if (key == "num_atoms") return algorithm == "npe_c" || algorithm == "nre_b";
  if (key == "loss" || key == "combined_loss") return algorithm == "npe_c";
  return key == "sampler" &&
         inference::role_of_algorithm(algorithm) != inference::NetworkRole::posterior;
}

}  // namespace

bool reads_setting(const std::string& algorithm, const std::string& key) {
  if (is_one_of(kOfAll, key)) return true;
  const auto family = inference::family_of_algorithm(algorithm);
  if (family != inference::AlgorithmFamily::fixed && is_one_of(kOfInference, key)) return true;
  switch (family) {
    case inference::AlgorithmFamily::fixed:
      return false;
    case inference::AlgorithmFamily::regression:
      return key == "linear_regression";
    case inference::AlgorithmFamily::abc:
      return key == "abc" || is_one_of(kOfSimulations, key);
    case inference::AlgorithmFamily::network:
      break;
  }
  return is_one_of(kOfSimulations, key) || network_reads(algorithm, key);
}

}  // namespace npdr::pipeline
