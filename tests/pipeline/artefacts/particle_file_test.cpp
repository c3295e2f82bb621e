#include "pipeline/artefacts/particle_file.h"

#include <functional>

#include "core/constants.h"
#include "core/error.h"
#include "pipeline/artefacts/schemas.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

inference::ParticleParts small_parts() {
  inference::ParticleParts parts{
      .prior = inference::Prior({{"a", "1", inference::Marginal::Kind::uniform, 0.0, 1.0},
                                 {"b", "kg", inference::Marginal::Kind::uniform, 0.0, 2.0}}),
      .theta = RowMatrix(4, 2),
      .weights = Vector::Constant(4, 0.25)};
  parts.theta << 0.1, 0.2, 0.3, 0.5, 0.6, 1.5, 0.9, 1.1;
  parts.weights(0) = 0.5;
  parts.weights(3) = 0.0;
  return parts;
}

inference::AbcPopulation population_of(const inference::ParticleParts& parts) {
  return {.theta = parts.theta,
          .weights = parts.weights,
          .distances = Vector::LinSpaced(4, 0.1, 0.4),
          .epsilon = 0.5,
          .kernel = 2.0 * Eigen::MatrixXd::Identity(2, 2),
          .num_chains = parts.num_chains};
}

class ParticleFile : public ::testing::Test {
 protected:
  using Write = std::function<void(h5::File&)>;

  std::filesystem::path written(const Write& write) const {
    const Identity identity{key_document(kPosteriorSchema), {}, {{"name", "s"}}, 1};
    ArtefactWriter writer(folder_ / "p.h5", kPosteriorSchema, identity);
    write(writer.file());
    writer.finish();
    return folder_ / "p.h5";
  }

  std::filesystem::path written(const inference::ParticleParts& parts) const {
    return written([&](h5::File& file) {
      write_particles(file, "abc_smc", parts, {100, 3});
      write_population(file, population_of(parts));
    });
  }

  // Message of reading after `change` of good parts.
  std::string message_after(const std::function<void(inference::ParticleParts&)>& change) const {
    inference::ParticleParts parts = small_parts();
    change(parts);
    const auto path = written(parts);
    return message_of<InputError>([&] { read_posterior(path); }, &folder_);
  }

  TempFolder folder_;
};

TEST_F(ParticleFile, ComesBackAsItWas) {
  inference::ParticleParts parts = small_parts();
  parts.smooth = true;
  parts.num_chains = 2;
  const auto path = written(parts);
  const auto posterior = read_posterior(path);
  const auto& found = dynamic_cast<const inference::ParticlePosterior&>(*posterior).parts();
  EXPECT_EQ(found.theta, parts.theta);
  EXPECT_EQ(found.weights, parts.weights);
  EXPECT_EQ(found.prior.marginals()[1].name, "b");
  EXPECT_TRUE(found.smooth);
  EXPECT_EQ(found.num_chains, 2);
  const inference::AbcPopulation population =
      read_population(open_artefact(path, kPosteriorSchema));
  EXPECT_EQ(population.distances, population_of(parts).distances);
  EXPECT_EQ(population.kernel, population_of(parts).kernel);
  EXPECT_EQ(population.epsilon, 0.5);
}

TEST_F(ParticleFile, OfARegressionMayHoldWhatIsNotFinite) {
  inference::ParticleParts parts = small_parts();
  parts.space = inference::ParticleSpace::theta;
  parts.theta(1, 0) = kNaN;
  const auto path = written([&](h5::File& file) {
    write_particles(file, "linear_regression", parts, {});
    write_part(file,
               RegressionCounts{4, 2, 1, {Vector::Ones(2), Eigen::MatrixXd::Identity(2, 2), {}}});
  });
  EXPECT_TRUE(std::isnan(dynamic_cast<const inference::ParticlePosterior&>(*read_posterior(path))
                             .parts()
                             .theta(1, 0)));
  const auto counts = read_part<RegressionCounts>(open_artefact(path, kPosteriorSchema));
  ASSERT_TRUE(counts);
  EXPECT_EQ(counts->samples, 4);
  EXPECT_EQ(counts->non_physical, 2);
  EXPECT_EQ(counts->outside_prior, 1);
}

TEST_F(ParticleFile, HasNoNetworkForAnotherObservation) {
  const auto path = written(small_parts());
  EXPECT_TRUE(
      says(message_of<InputError>([&] { read_network_posterior(path); }, &folder_),
           {"p.h5: a posterior of 'abc_smc' has no network and holds for its own observation alone",
            "infer from another one in a study of its own"}));
}

TEST_F(ParticleFile, WhatMakesNoPosteriorIsRefused) {
  EXPECT_TRUE(says(message_after([](auto& parts) { parts.weights(2) = -0.25; }),
                   {"p.h5: posterior: weights of particles", "must be >= 0, and not all of them 0",
                    "rerun stage 'infer'"}));
  EXPECT_TRUE(says(message_after([](auto& parts) { parts.num_chains = 3; }),
                   {"p.h5: posterior: 4 particles of 2 parameters, 4 weights and 3 chains for a "
                    "prior of 2 parameters don't go together",
                    "rerun stage 'infer'"}));
  EXPECT_TRUE(says(message_after([](auto& parts) { parts.theta.setConstant(0.5); }),
                   {"p.h5: kernel density: no parameter of the 4 finite samples varies",
                    "rerun stage 'infer'"}));
  EXPECT_NE(message_after([](auto& parts) { parts.theta(0, 0) = kNaN; }).find("'particles/theta'"),
            std::string::npos);
  EXPECT_NE(message_after([](auto& parts) { parts.weights(0) = kNaN; }).find("'particles/weight'"),
            std::string::npos);
  EXPECT_NE(message_after([](auto& parts) { parts.theta.conservativeResize(4, 1); }).find("(4, 1)"),
            std::string::npos);
}

TEST_F(ParticleFile, WhatMakesNoPopulationIsRefused) {
  const auto message = [&](const std::function<void(inference::AbcPopulation&)>& change) {
    inference::AbcPopulation population = population_of(small_parts());
    change(population);
    const auto path = written([&](h5::File& file) {
      write_particles(file, "abc_smc", small_parts(), {});
      write_population(file, population);
    });
    return message_of<InputError>([&] { read_population(open_artefact(path, kPosteriorSchema)); },
                                  &folder_);
  };
  EXPECT_TRUE(
      says(message([](auto& p) { p.distances(1) = -1.0; }),
           {"p.h5: distances and epsilon", "must be finite and >= 0", "rerun stage 'infer'"}));
  EXPECT_TRUE(
      says(message([](auto& p) { p.epsilon = kNaN; }),
           {"p.h5: distances and epsilon", "must be finite and >= 0", "rerun stage 'infer'"}));
  EXPECT_NE(message([](auto& p) { p.distances = Vector::Ones(3); }).find("(3)"), std::string::npos);
  EXPECT_NE(message([](auto& p) { p.kernel = Eigen::MatrixXd::Ones(3, 3); }).find("(3, 3)"),
            std::string::npos);
  // A regression's file, or a damaged one, has none.
  const auto path =
      written([&](h5::File& file) { write_particles(file, "abc_smc", small_parts(), {}); });
  EXPECT_THROW(read_population(open_artefact(path, kPosteriorSchema)), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
