#include "pipeline/artefacts/posterior_file.h"

#include <functional>

#include "core/error.h"
#include "inference/direct_posterior.h"
#include "inference/ensemble.h"
#include "inference/estimators/ratio_estimator.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/usual_features_file.h"
#include "pipeline/config/study_json.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

// An untrained posterior of one parameter, one feature and a small flow.
inference::DirectPosterior small_posterior(const MethodConfig& method) {
  inference::NetworkParts parts{
      .prior = inference::Prior({{"a", "1", inference::Marginal::Kind::uniform, 0.0, 1.0}}),
      .estimator = method.density_estimator,
      .embedding = {},
      .structure_seed = 5,
      .transform = {VectorF::Zero(1), VectorF::Ones(1), {}},
      .parameters = {},
      .x_o = VectorF::Zero(1)};
  const auto network = inference::make_network(parts.estimator, 1, {}, 1, 5);
  parts.parameters = network.initial_parameters({1, "initial", 0, 0, 0});
  return inference::DirectPosterior(parts);
}

// Untrained posteriors in the other roles.
inference::NetworkParts parts_of(inference::NetworkRole role, inference::EstimatorKind kind) {
  inference::NetworkParts parts{
      .prior = inference::Prior({{"a", "1", inference::Marginal::Kind::uniform, 0.0, 1.0}}),
      .role = role,
      .estimator = {.kind = kind, .num_transforms = 2, .num_components = 3, .hidden_features = 8},
      .structure_seed = 5,
      .transform = {VectorF::Zero(2), VectorF::Ones(2), {}},
      .parameters = {},
      .x_o = VectorF::Zero(2)};
  const StreamId id{1, "initial", 0, 0, 0};
  if (role == inference::NetworkRole::ratio) {
    parts.parameters =
        inference::RatioEstimator<float>(parts.estimator, 1, 2).initial_parameters(id);
  } else {
    const bool is_likelihood = role == inference::NetworkRole::likelihood;
    parts.parameters = inference::make_network(parts.estimator, is_likelihood ? 1 : 2, {},
                                               is_likelihood ? 2 : 1, 5)
                           .initial_parameters(id);
  }
  parts.sampler.num_chains = 7;
  return parts;
}

class PosteriorFile : public ::testing::Test {
 protected:
  PosteriorFile() {
    method_.density_estimator = {
        .kind = inference::EstimatorKind::maf, .num_transforms = 2, .hidden_features = 8};
  }

  // Reads the posterior's file after `change` of its attributes.
  template <class Change>
  std::unique_ptr<inference::NetworkPosterior> reread(const Change& change) const {
    const Identity identity{key_document(kPosteriorSchema), {}, {{"name", "s"}}, 1};
    ArtefactWriter writer(folder_ / "p.h5", kPosteriorSchema, identity);
    write_posterior(writer.file(), method_, small_posterior(method_), {}, {}, {}, {});
    change(writer.file());
    writer.finish();
    return read_network_posterior(folder_ / "p.h5");
  }

  template <class T>
  std::string message_after(const std::string& attribute, const T& value) const {
    return message_of<InputError>(
        [&] { reread([&](h5::File& file) { file.set_attribute(attribute, value); }); }, &folder_);
  }

  std::string message_of_estimator(const inference::EstimatorConfig& config) const {
    return message_after("density_estimator", to_json(config).dump());
  }

  std::string message_of_embedding(const inference::TrainedEmbeddingConfig& config) const {
    return message_after("trained_embedding", to_json(config).dump());
  }

  // As it comes back from a file.
  std::unique_ptr<inference::NetworkPosterior> reread(
      const inference::NetworkParts& parts,
      const std::function<void(h5::File&)>& change = [](h5::File&) {}) const {
    const Identity identity{key_document(kPosteriorSchema), {}, {{"name", "s"}}, 1};
    ArtefactWriter writer(folder_ / "p.h5", kPosteriorSchema, identity);
    write_posterior(writer.file(), method_, *inference::make_posterior(parts), {}, {}, {}, {});
    change(writer.file());
    writer.finish();
    return read_network_posterior(folder_ / "p.h5");
  }

  MethodConfig method_;
  TempFolder folder_;
};

TEST_F(PosteriorFile, EveryRoleComesBackAsItWas) {
  using inference::NetworkRole;
  RowMatrix theta(2, 1);
  theta << 0.2, 0.9;
  for (const auto& [role, kind] :
       {std::pair{NetworkRole::likelihood, inference::EstimatorKind::nsf},
        {NetworkRole::likelihood, inference::EstimatorKind::mdn},
        {NetworkRole::ratio, inference::EstimatorKind::resnet}}) {
    const inference::NetworkParts parts = parts_of(role, kind);
    const auto posterior = reread(parts);
    EXPECT_EQ(posterior->parts().role, role);
    EXPECT_EQ(posterior->parts().parameters, parts.parameters);
    EXPECT_EQ(posterior->parts().sampler.num_chains, 7);
    EXPECT_EQ(posterior->log_prob(theta), inference::make_posterior(parts)->log_prob(theta));
  }
}

TEST_F(PosteriorFile, WhatXUsuallyIsComesBackAsItWasOrIsRefused) {
  const inference::UsualFeatures usual = inference::usual_features(RowMatrixF::NullaryExpr(
      80, 1, [](Index i, Index) { return static_cast<float>(i * i % 17); }));
  const auto reread_usual = [&](const std::optional<inference::UsualFeatures>& written) {
    const Identity identity{key_document(kPosteriorSchema), {}, {{"name", "s"}}, 1};
    ArtefactWriter writer(folder_ / "p.h5", kPosteriorSchema, identity);
    write_posterior(writer.file(), method_, small_posterior(method_), {}, {}, {}, written);
    writer.finish();
    return read_usual_features(folder_ / "p.h5");
  };
  const auto found = reread_usual(usual);
  for (const float x : {3.0F, 40.0F}) {
    const VectorF x_o = VectorF::Constant(1, x);
    EXPECT_EQ(inference::test_out_of_distribution(*found, x_o).p_value,
              inference::test_out_of_distribution(usual, x_o).p_value);
  }
  EXPECT_FALSE(reread_usual({})) << "of too few";

  const auto refusal = [&](const inference::UsualFeatures& written) {
    return message_of<InputError>([&] { reread_usual(written); }, &folder_);
  };
  inference::UsualFeatures broken = usual;
  broken.distances.resize(4, 2);
  EXPECT_TRUE(says(refusal(broken), {"p.h5: dataset 'usual/distances' has shape"}));
  broken = usual;
  broken.known.resize(0, 1);
  EXPECT_TRUE(says(refusal(broken), {"p.h5: group 'usual': nothing to compare an x with"}));
  broken = usual;
  broken.known.resize(40, 0);
  broken.transform.basis.resize(0, 0);
  EXPECT_TRUE(says(refusal(broken), {"p.h5: group 'usual': nothing to compare an x with"}));
  broken = usual;
  broken.lowest.resize(2);
  EXPECT_TRUE(says(refusal(broken), {"p.h5: dataset 'usual/lowest' has shape"}));
}

TEST_F(PosteriorFile, APoolComesBackAsItWasOrIsRefused) {
  inference::NetworkParts parts =
      parts_of(inference::NetworkRole::posterior, inference::EstimatorKind::nsf);
  parts.transform.basis = RowMatrixF::Identity(2, 2);
  inference::NetworkParts likelihood =
      parts_of(inference::NetworkRole::likelihood, inference::EstimatorKind::maf);
  likelihood.transform.basis = RowMatrixF::Constant(2, 1, 0.7F);
  likelihood.parameters = inference::make_network(likelihood.estimator, 1, {}, 1, 5)
                              .initial_parameters({1, "initial", 0, 0, 0});
  parts.likelihood = {likelihood.estimator,
                      likelihood.transform,
                      likelihood.parameters,
                      {.posterior = 0.5, .likelihood = 0.75}};
  RowMatrix theta(2, 1);
  theta << 0.2, 0.9;
  const auto posterior = reread(parts);
  EXPECT_EQ(posterior->parts().likelihood->powers, parts.likelihood->powers);
  EXPECT_EQ(posterior->parts().likelihood->estimator.kind, inference::EstimatorKind::maf);
  EXPECT_EQ(posterior->parts().likelihood->parameters, parts.likelihood->parameters);
  EXPECT_EQ(posterior->parts().transform.basis, parts.transform.basis);
  EXPECT_EQ(posterior->parts().likelihood->transform.basis, parts.likelihood->transform.basis);
  EXPECT_EQ(posterior->log_prob(theta), inference::make_posterior(parts)->log_prob(theta));
  const auto spoil = [&](h5::File& file) {
    file.group("likelihood").set_attribute("likelihood_power", 2.5);
  };
  EXPECT_TRUE(says(message_of<InputError>([&] { reread(parts, spoil); }, &folder_),
                   {"p.h5: group 'likelihood': powers of a pool = 0.5 and 2.5",
                    "must be at least 0 and 2 together"}));
}

// An NLE's file with a likelihood beside it has the shapes of a pool, but for the role.
TEST_F(PosteriorFile, APoolsNetworksAreOfAPosteriorAndAsManyAsTheLikelihoods) {
  inference::NetworkParts parts =
      parts_of(inference::NetworkRole::likelihood, inference::EstimatorKind::maf);
  parts.likelihood = {parts.estimator, parts.transform, parts.parameters, {0.5, 0.5}};
  EXPECT_TRUE(says(message_of<ShapeError>([&] { inference::make_posterior(parts); }),
                   {"pool: its networks' role is 'likelihood', must be 'posterior'"}));
  const inference::NetworkParts posterior =
      parts_of(inference::NetworkRole::posterior, inference::EstimatorKind::maf);
  parts.role = posterior.role;
  parts.parameters = posterior.parameters;
  parts.likelihood->estimator.num_networks = 2;
  parts.likelihood->parameters =
      inference::joined({parts.likelihood->parameters, parts.likelihood->parameters});
  EXPECT_TRUE(says(message_of<ShapeError>([&] { inference::make_posterior(parts); }),
                   {"pool: 2 networks of the likelihood, must be 1, as many as the posterior's"}));
}

TEST_F(PosteriorFile, AProposalComesBackAsItWasOrIsRefused) {
  inference::NetworkParts parts =
      parts_of(inference::NetworkRole::posterior, inference::EstimatorKind::mdn);
  parts.proposal = {Vector::Zero(1), {Vector::Constant(1, 0.3)}, {Eigen::MatrixXd::Ones(1, 1)}};
  RowMatrix theta(2, 1);
  theta << 0.2, 0.9;
  EXPECT_EQ(reread(parts)->log_prob(theta), inference::make_posterior(parts)->log_prob(theta));
  const h5::File written = open_artefact(folder_ / "p.h5", kPosteriorSchema);
  EXPECT_EQ(written.group("mixture").read_vector<double>("log_weight"),
            inference::DirectPosterior(parts).mixture().log_weights);
  EXPECT_EQ(written.group("mixture").dataset("factor").shape(), (h5::Shape{3, 1, 1}));
  const auto spoil = [&](h5::File& file) {
    const RowMatrix singular = RowMatrix::Zero(1, 1);
    file.group("proposal")
        .dataset("precision_factor")
        .write_rows<double>(0, 1, {singular.data(), 1});
  };
  EXPECT_TRUE(says(message_of<InputError>([&] { reread(parts, spoil); }, &folder_),
                   {"p.h5: group 'proposal': precision_factor", "must have a positive diagonal",
                    "rerun stage 'infer'"}));
}

TEST_F(PosteriorFile, ComesBackAsItWas) {
  const auto posterior = reread([](h5::File&) {});
  EXPECT_EQ(posterior->parts().parameters, small_posterior(method_).parts().parameters);
  EXPECT_EQ(posterior->parts().structure_seed, 5u);
}

TEST_F(PosteriorFile, AStructureSeedMustBeAnInteger) {
  for (const char* text : {"abc", "", "5x", "-1", "99999999999999999999"}) {
    EXPECT_TRUE(says(message_after("structure_seed", std::string(text)),
                     {"p.h5: attribute 'structure_seed' = '" + std::string(text) + "'",
                      "must be an integer >= 0"}));
  }
}

TEST_F(PosteriorFile, LayersHaveNamesAndShapes) {
  reread(parts_of(inference::NetworkRole::posterior, inference::EstimatorKind::nsf));
  const h5::File file = open_artefact(folder_ / "p.h5", kPosteriorSchema);
  const h5::Group network = file.group("network_1");
  EXPECT_EQ(
      network.names(),
      (std::vector<std::string>{
          "context.bias", "context.weight", "transform_1.degree", "transform_1.hidden_1.bias",
          "transform_1.hidden_1.weight", "transform_1.input.weight", "transform_1.order",
          "transform_1.output.bias", "transform_1.output.weight", "transform_2.degree",
          "transform_2.hidden_1.bias", "transform_2.hidden_1.weight", "transform_2.input.weight",
          "transform_2.order", "transform_2.output.bias", "transform_2.output.weight"}));
  EXPECT_EQ(network.dataset("context.weight").shape(), (h5::Shape{2, 16}));
  EXPECT_EQ(network.dataset("transform_2.output.bias").shape(), (h5::Shape{16}));
}

TEST_F(PosteriorFile, AnotherOrderOfVariablesIsRefused) {
  const auto spoil = [](h5::File& file) {
    const std::int64_t order = 7;
    file.group("network_1")
        .dataset("transform_2.order")
        .write_rows<std::int64_t>(0, 1, {&order, 1});
  };
  EXPECT_TRUE(says(message_of<InputError>([&] { reread(spoil); }, &folder_),
                   {"p.h5: group 'network_1': transform_2.order isn't what", "structure_seed",
                    "rerun stage 'infer'"}));
}

TEST_F(PosteriorFile, LayersOfAbsurdSizesAreRefused) {
  EXPECT_TRUE(says(message_of_estimator({.hidden_features = 200000}),
                   {"p.h5: attribute 'density_estimator': hidden_features = 200000",
                    "must be >= 1 and <= 4096"}));
  EXPECT_TRUE(says(message_of_estimator({.num_hidden_layers = 1000000}),
                   {"p.h5: attribute 'density_estimator': num_hidden_layers = 1000000",
                    "must be >= 1 and <= 128"}));
  for (const Index width : {Index{-1}, Index{1} << 40}) {
    EXPECT_TRUE(says(message_of_embedding({width}),
                     {"p.h5: attribute 'trained_embedding': features = " + std::to_string(width),
                      "must be >= 0 and <= 4096"}));
  }
  EXPECT_TRUE(says(message_of_embedding({4096}),
                   {"p.h5: group 'network_1': ", " weights, but the file's"}));
}

TEST_F(PosteriorFile, ConvolutionsOfOtherSeriesThanTheFeaturesAreRefused) {
  EXPECT_TRUE(
      says(message_of_embedding({4, {2, 10, 3}}),
           {"p.h5: group 'network_1': attribute 'trained_embedding' has series of 60 values, "
            "but there are 1 features"}));
  EXPECT_TRUE(says(message_of_embedding({4, {1, Index{1} << 40, 1}}),
                   {"p.h5: attribute 'trained_embedding': num_steps = 1099511627776"}));
}

TEST_F(PosteriorFile, ConvolutionsComeBackAsTheyWere) {
  inference::NetworkParts parts =
      parts_of(inference::NetworkRole::posterior, inference::EstimatorKind::nsf);
  const Index features = parts.transform.num_outputs();
  parts.embedding = {3, {features, 1, 1}, true};
  parts.parameters = inference::make_network(parts).initial_parameters({1, "initial", 0, 0, 0});
  const auto posterior = reread(parts);
  EXPECT_EQ(posterior->parts().embedding, parts.embedding);
  EXPECT_EQ(posterior->parts().parameters, parts.parameters);
}

TEST_F(PosteriorFile, ANetworkWithoutItsWeightsIsRefusedBeforeItIsMade) {
  EXPECT_TRUE(says(message_of_estimator(
                       {.num_transforms = 128, .hidden_features = 4096, .num_hidden_layers = 128}),
                   {"p.h5: group 'network_1': 246 weights, but the file's density_estimator and "
                    "trained_embedding have at least 272730947584; rerun stage 'infer'"}));
  EXPECT_TRUE(
      says(message_of_estimator(
               {.kind = inference::EstimatorKind::mdn, .num_components = 1, .hidden_features = 2}),
           {"p.h5: group 'network_1': has no dataset 'hidden_1.weight'"}));
}

}  // namespace
}  // namespace npdr::pipeline
