#include "pipeline/artefacts/posterior_file.h"

#include <functional>
#include <memory>

#include "core/error.h"
#include "inference/direct_posterior.h"
#include "inference/ensemble.h"
#include "inference/estimators/ratio_estimator.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_json.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

// An untrained posterior of one parameter, one feature and a small flow.
inference::DirectPosterior small_posterior(const MethodConfig& method) {
  inference::NetworkParts parts{
      .prior = inference::Prior({{"a", "1", inference::Marginal::Kind::uniform, 0.0, 1.0}}),
      .estimator = method.density_estimator,
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
      .of_role = inference::role_parts(role),
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
  if (auto* const surrogate = std::get_if<inference::SurrogateParts>(&parts.of_role)) {
    surrogate->sampler.num_chains = 7;
  }
  return parts;
}

auto& direct(auto& parts) { return std::get<inference::DirectParts>(parts.of_role); }

class PosteriorFile : public FolderTest {
 protected:
  using Write = std::function<void(h5::File&)>;

  PosteriorFile() {
    method_.density_estimator = {
        .kind = inference::EstimatorKind::maf, .num_transforms = 2, .hidden_features = 8};
  }

  std::filesystem::path written(const Write& write, const Write& change = {}) const {
    const Identity identity{key_document(kPosteriorSchema), {}, {{"name", "s"}}, 1};
    ArtefactWriter writer(folder_ / "p.h5", kPosteriorSchema, identity);
    write(writer.file());
    if (change) change(writer.file());
    writer.finish();
    return folder_ / "p.h5";
  }
  // As they come back from a file, after `change` of it.
  std::unique_ptr<inference::NetworkPosterior> reread(const inference::NetworkParts& parts,
                                                      const Write& change = {}) const {
    const auto posterior = inference::make_posterior(parts);
    return read_network_posterior(
        written([&](h5::File& file) { write_posterior(file, method_, *posterior, {}, {}, {}, {}); },
                change));
  }
  std::unique_ptr<inference::NetworkPosterior> reread(const Write& change = {}) const {
    return reread(small_posterior(method_).parts(), change);
  }
  // It comes back with the same densities.
  std::unique_ptr<inference::NetworkPosterior> expect_same(
      const inference::NetworkParts& parts) const {
    const RowMatrix theta{{0.2}, {0.9}};
    auto found = reread(parts);
    EXPECT_EQ(found->parts().role(), parts.role());
    EXPECT_EQ(found->parts().parameters, parts.parameters);
    EXPECT_EQ(found->parts().structure_seed, parts.structure_seed);
    if (const auto* given = std::get_if<inference::SurrogateParts>(&parts.of_role)) {
      const auto& surrogate = std::get<inference::SurrogateParts>(found->parts().of_role);
      EXPECT_EQ(surrogate.sampler.num_chains, given->sampler.num_chains);
    } else {
      EXPECT_EQ(direct(found->parts()).embedding, direct(parts).embedding);
    }
    EXPECT_EQ(found->log_prob(theta), inference::make_posterior(parts)->log_prob(theta));
    return found;
  }
  // What is said of a file after `change`, or with another attribute.
  std::string message_after(const Write& change) const {
    return problem([&] { reread(change); });
  }
  std::string message_with(const std::string& attribute, const std::string& value) const {
    return message_after([&](h5::File& file) { file.set_attribute(attribute, value); });
  }

  MethodConfig method_;
};

TEST_F(PosteriorFile, EveryRoleComesBackAsItWas) {
  using enum inference::NetworkRole;
  using inference::Estimate, inference::EstimatorKind, inference::kinds_that_give;
  for (const EstimatorKind kind : kinds_that_give(Estimate::density)) {
    expect_same(parts_of(posterior, kind));
    expect_same(parts_of(likelihood, kind));
  }
  for (const EstimatorKind kind : kinds_that_give(Estimate::ratio)) {
    expect_same(parts_of(ratio, kind));
  }
  expect_same(small_posterior(method_).parts());
  inference::NetworkParts convolved = parts_of(posterior, EstimatorKind::nsf);
  direct(convolved).embedding = {3, {convolved.transform.num_outputs(), 1, 1}, true};
  convolved.parameters =
      inference::make_network(convolved).initial_parameters({1, "initial", 0, 0, 0});
  const auto found = reread(convolved);
  EXPECT_EQ(direct(found->parts()).embedding, direct(convolved).embedding);
  EXPECT_EQ(found->parts().parameters, convolved.parameters);
}

TEST_F(PosteriorFile, WhatXUsuallyIsComesBackAsItWasOrIsRefused) {
  using inference::UsualFeatures;
  const UsualFeatures usual = inference::usual_features(RowMatrixF::NullaryExpr(
      80, 1, [](Index i, Index) { return static_cast<float>(i * i % 17); }));
  const auto reread_usual = [&](const std::optional<UsualFeatures>& of) {
    return read_usual_features(written([&](h5::File& file) {
      write_posterior(file, method_, small_posterior(method_), {}, {}, {}, of);
    }));
  };
  const auto found = reread_usual(usual);
  for (const float x : {3.0F, 40.0F}) {
    const VectorF x_o = VectorF::Constant(1, x);
    EXPECT_EQ(inference::test_out_of_distribution(*found, x_o).p_value,
              inference::test_out_of_distribution(usual, x_o).p_value);
  }
  EXPECT_FALSE(reread_usual({})) << "of too few";
  const std::vector<std::pair<std::string, void (*)(UsualFeatures&)>> cases = {
      {"dataset 'usual/distances' has shape", [](UsualFeatures& u) { u.distances.resize(4, 2); }},
      {"group 'usual': nothing to compare an x with",
       [](UsualFeatures& u) { u.known.resize(0, 1); }},
      {"group 'usual': nothing to compare an x with",
       [](UsualFeatures& u) {
         u.known.resize(40, 0);
         u.transform.basis.resize(0, 0);
       }},
      {"dataset 'usual/lowest' has shape", [](UsualFeatures& u) { u.lowest.resize(2); }}};
  for (const auto& [said, spoil] : cases) {
    UsualFeatures broken = usual;
    spoil(broken);
    EXPECT_TRUE(says(problem([&] { reread_usual(broken); }), {"p.h5: " + said}));
  }
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
  direct(parts).likelihood = {likelihood.estimator,
                              likelihood.transform,
                              likelihood.parameters,
                              {.posterior = 0.5, .likelihood = 0.75}};
  const auto posterior = expect_same(parts);
  EXPECT_EQ(posterior->parts().transform.basis, parts.transform.basis);
  const auto& found = *posterior->parts().pooled_likelihood();
  const auto& given = *parts.pooled_likelihood();
  EXPECT_EQ(found.powers, given.powers);
  EXPECT_EQ(found.estimator.kind, inference::EstimatorKind::maf);
  EXPECT_EQ(found.parameters, given.parameters);
  EXPECT_EQ(found.transform.basis, given.transform.basis);
  const auto spoil = [&](h5::File& file) {
    file.group("likelihood").set_attribute("likelihood_power", 2.5);
  };
  EXPECT_TRUE(says(problem([&] { reread(parts, spoil); }),
                   {"p.h5: group 'likelihood': powers of a pool = 0.5 and 2.5",
                    "must be at least 0 and 2 together"}));
  const auto rename = [](h5::File& file) {
    file.set_attribute("network_role", std::string("likelihood"));
  };
  EXPECT_TRUE(says(problem([&] { reread(parts, rename); }),
                   {"p.h5: pool: its networks' role is 'likelihood', must be 'posterior'"}));
}

TEST_F(PosteriorFile, APoolHasAsManyNetworksAsTheLikelihood) {
  inference::NetworkParts parts =
      parts_of(inference::NetworkRole::posterior, inference::EstimatorKind::maf);
  const inference::NetworkParts one =
      parts_of(inference::NetworkRole::likelihood, inference::EstimatorKind::maf);
  auto& likelihood = direct(parts).likelihood;
  likelihood = {one.estimator,
                one.transform,
                inference::joined({one.parameters, one.parameters}),
                {0.5, 0.5}};
  likelihood->estimator.num_networks = 2;
  EXPECT_TRUE(says(message_of<ShapeError>([&] { inference::make_posterior(parts); }),
                   {"pool: 2 networks of the likelihood, must be 1, as many as the posterior's"}));
}

TEST_F(PosteriorFile, AProposalComesBackAsItWasOrIsRefused) {
  inference::NetworkParts parts =
      parts_of(inference::NetworkRole::posterior, inference::EstimatorKind::mdn);
  direct(parts).proposal = {
      Vector::Zero(1), {Vector::Constant(1, 0.3)}, {Eigen::MatrixXd::Ones(1, 1)}};
  expect_same(parts);
  const h5::File file = open_artefact(folder_ / "p.h5", kPosteriorSchema);
  const auto log_weights = file.group("mixture").dataset("log_weight").read<double>();
  EXPECT_EQ(Vector::Map(log_weights.data(), std::ssize(log_weights)),
            inference::DirectPosterior(parts).mixture().log_weights);
  EXPECT_EQ(file.group("mixture").dataset("factor").shape(), (h5::Shape{3, 1, 1}));
  const auto spoil = [&](h5::File& spoiled) {
    const double singular = 0.0;
    spoiled.group("proposal").dataset("precision_factor").write_rows<double>(0, 1, {&singular, 1});
  };
  EXPECT_TRUE(says(problem([&] { reread(parts, spoil); }),
                   {"p.h5: group 'proposal': precision_factor", "must have a positive diagonal",
                    "rerun stage 'infer'"}));
}

TEST_F(PosteriorFile, AStructureSeedMustBeAnInteger) {
  for (const std::string text : {"abc", "", "5x", "-1", "99999999999999999999"}) {
    EXPECT_TRUE(
        says(message_with("structure_seed", text),
             {"p.h5: attribute 'structure_seed' = '" + text + "'", "must be an integer >= 0"}));
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
  EXPECT_TRUE(says(message_after([](h5::File& file) {
                     const std::int64_t order = 7;
                     file.group("network_1")
                         .dataset("transform_2.order")
                         .write_rows<std::int64_t>(0, 1, {&order, 1});
                   }),
                   {"p.h5: group 'network_1': transform_2.order isn't what", "structure_seed",
                    "rerun stage 'infer'"}));
}

TEST_F(PosteriorFile, LayersOfAbsurdSizesAreRefused) {
  const std::string estimator = "attribute 'density_estimator': ";
  const std::string embedding = "attribute 'trained_embedding': ";
  const std::vector<std::pair<inference::EstimatorConfig, std::string>> estimators = {
      {{.hidden_features = 200000},
       estimator + "hidden_features = 200000, must be >= 1 and <= 4096"},
      {{.num_hidden_layers = 1000000},
       estimator + "num_hidden_layers = 1000000, must be >= 1 and <= 128"},
      // Before it is made.
      {{.num_transforms = 128, .hidden_features = 4096, .num_hidden_layers = 128},
       "group 'network_1': 246 weights, but the file's density_estimator and trained_embedding "
       "have at least 272730947584; rerun stage 'infer'"},
      {{.kind = inference::EstimatorKind::mdn, .num_components = 1, .hidden_features = 2},
       "group 'network_1': has no dataset 'hidden_1.weight'"}};
  for (const auto& [config, said] : estimators) {
    EXPECT_TRUE(says(message_with("density_estimator", to_json(config).dump()), {"p.h5: " + said}));
  }
  const std::vector<std::pair<inference::TrainedEmbeddingConfig, std::string>> embeddings = {
      {{-1}, embedding + "features = -1, must be >= 0 and <= 4096"},
      {{Index{1} << 40}, embedding + "features = 1099511627776, must be >= 0 and <= 4096"},
      {{4096}, "group 'network_1': "},
      {{4, {2, 10, 3}},
       "group 'network_1': attribute 'trained_embedding' has series of 60 values, but there are 1 "
       "features"},
      {{4, {1, Index{1} << 40, 1}}, embedding + "num_steps = 1099511627776"}};
  for (const auto& [config, said] : embeddings) {
    EXPECT_TRUE(says(message_with("trained_embedding", to_json(config).dump()), {"p.h5: " + said}));
  }
}

}  // namespace
}  // namespace npdr::pipeline
