// Posterior files, which people hand to each other.
#include "inference/estimators/ratio_estimator.h"
#include "inference/pooled_posterior.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/sealed_model.h"

namespace npdr::pipeline {
namespace {

using inference::EstimatorKind;
using inference::NetworkRole;

const std::vector<inference::Marginal> kPrior = {
    {"a", "1", inference::Marginal::Kind::uniform, 0.0, 1.0},
    {"b", "kg", inference::Marginal::Kind::log_normal, 0.0, 1.0}};

inference::NetworkParts network(NetworkRole role, EstimatorKind kind) {
  inference::NetworkParts parts{
      .prior = inference::Prior(kPrior),
      .of_role = inference::role_parts(role),
      .estimator = {.kind = kind, .num_transforms = 2, .num_components = 3, .hidden_features = 4},
      .structure_seed = 5,
      .transform = {VectorF::Zero(2), VectorF::Ones(2), {}},
      .parameters = {},
      .x_o = VectorF::Zero(2)};
  const StreamId id{1, "initial", 0, 0, 0};
  parts.parameters =
      role == NetworkRole::ratio
          ? inference::RatioEstimator<float>(parts.estimator, 2, 2).initial_parameters(id)
          : inference::make_network(parts.estimator, 2, {}, 2, 5).initial_parameters(id);
  return parts;
}

// Of components of which the likelihood has fewer.
inference::NetworkParts pool() {
  inference::NetworkParts parts = network(NetworkRole::posterior, EstimatorKind::nsf);
  inference::NetworkParts likelihood = network(NetworkRole::likelihood, EstimatorKind::maf);
  parts.transform.basis = RowMatrixF::Identity(2, 2);
  likelihood.transform.basis = RowMatrixF::Constant(2, 1, 0.7F);
  likelihood.parameters = inference::make_network(likelihood.estimator, 2, {}, 1, 5)
                              .initial_parameters({1, "initial", 0, 0, 0});
  parts.of_role = inference::DirectParts{
      .likelihood = inference::PooledLikelihood{
          likelihood.estimator, likelihood.transform, likelihood.parameters, {0.5, 0.75}}};
  return parts;
}

void write_network(h5::File& file, const inference::NetworkParts& parts) {
  MethodConfig method;
  method.density_estimator = parts.estimator;
  inference::TrainingState state;
  state.training_loss = state.validation_loss = {1.0, 0.5};
  const std::vector<inference::TrainingState> trainings(parts.pooled_likelihood() ? 2 : 1, state);
  RowMatrixF x(40, 2);
  for (Index i = 0; i < x.size(); ++i) x(i) = static_cast<float>(i * i % 17);
  write_posterior(file, method, *inference::make_posterior(parts), {}, trainings, {},
                  inference::usual_features(x));
}

void write_abc(h5::File& file, bool is_smooth) {
  inference::ParticleParts parts{.prior = inference::Prior(kPrior),
                                 .theta = RowMatrix::Constant(4, 2, 0.5),
                                 .weights = Vector::Constant(4, 0.25)};
  parts.theta.col(0) << 0.1, 0.2, 0.3, 0.4;
  parts.smooth = is_smooth;
  parts.num_chains = is_smooth ? 0 : 2;
  write_particles(file, "abc_smc", parts, {100, 3});
  write_population(file, {.theta = parts.theta,
                          .weights = parts.weights,
                          .distances = Vector::LinSpaced(4, 0.1, 0.4),
                          .epsilon = 0.5,
                          .kernel = Eigen::MatrixXd::Identity(2, 2),
                          .num_chains = parts.num_chains});
  write_part(file, inference::ImportanceCertificate{});
  write_part(file, PowerScores{.power = Vector::LinSpaced(2, 0.1, 0.2),
                               .noise_factor = Vector::Ones(2),
                               .crps = RowMatrix::Ones(2, 3)});
}

const std::vector<H5Model>& models() {
  static const std::vector<H5Model> all = [] {
    inference::NetworkParts corrected = network(NetworkRole::posterior, EstimatorKind::mdn);
    corrected.of_role = inference::DirectParts{
        .proposal = inference::GaussianMixture{
            Vector::Zero(1), {Vector::Zero(2)}, {Eigen::MatrixXd::Identity(2, 2)}}};
    std::vector<inference::NetworkParts> networks = {
        corrected, pool(), network(NetworkRole::likelihood, EstimatorKind::maf)};
    for (const EstimatorKind kind : values_of<EstimatorKind>()) {
      const bool is_ratio = traits_of(kind).gives(inference::Estimate::ratio);
      networks.push_back(network(is_ratio ? NetworkRole::ratio : NetworkRole::posterior, kind));
    }
    std::vector<H5Model> made;
    for (const inference::NetworkParts& parts : networks) {
      made.push_back(model_of(kPosteriorSchema, [&](h5::File& f) { write_network(f, parts); }));
    }
    for (const bool is_smooth : {false, true}) {
      made.push_back(model_of(kPosteriorSchema, [&](h5::File& f) { write_abc(f, is_smooth); }));
    }
    return made;
  }();
  return all;
}

// Others are drawn by chains and need an integral, which take their time.
bool is_direct(const inference::Posterior& posterior) {
  return dynamic_cast<const inference::PooledPosterior*>(&posterior) == nullptr &&
         dynamic_cast<const inference::SurrogatePosterior*>(&posterior) == nullptr;
}

}  // namespace

std::vector<std::string> posterior_seeds() {
  std::vector<std::string> seeds;
  for (std::size_t i = 0; i < models().size(); ++i) seeds.emplace_back(1, static_cast<char>(i));
  return seeds;
}

void fuzz_posterior(std::string_view input, const std::filesystem::path& folder) {
  InputBytes bytes(input);
  H5Model model = bytes.one_of(models());
  model.edit(bytes);
  const std::filesystem::path path = folder / "a.h5";
  write_sealed(model, path);
  read_artefact_info(path);
  const auto posterior = read_posterior(path);
  const RowMatrix theta = RowMatrix::Constant(2, posterior->prior().dimension(), 0.5);
  if (is_direct(*posterior)) {
    posterior->sample(3, {1, "fuzz", 0, 0, 0});
    posterior->log_prob(theta);
  } else {
    posterior->relative_log_prob(theta);
  }
  read_posterior_notes(path);
  const h5::File file = open_artefact(path, kPosteriorSchema);
  if (holds_particles(file)) {
    read_population(file);
    read_part<PowerScores>(file).value_or(PowerScores()).noise_factor_at(0.15);
  } else {
    if (const auto usual = read_usual_features(path)) {
      inference::test_out_of_distribution(*usual, VectorF::Constant(usual->lowest.size(), 3.0F));
    }
    require_like_observation("a", {}, path);
  }
}

}  // namespace npdr::pipeline
