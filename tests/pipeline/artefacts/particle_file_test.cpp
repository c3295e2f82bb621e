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

class ParticleFile : public FolderTest {
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
  EXPECT_TRUE(has(problem([&] { read_network_posterior(path); }),
                  "p.h5: a posterior of 'abc_smc' has no network"));
}

TEST_F(ParticleFile, WhatMakesNoPosteriorIsRefused) {
  using Parts = inference::ParticleParts;
  const std::vector<std::pair<std::string, void (*)(Parts&)>> cases = {
      {"posterior: weights of particles must be >= 0, and not all of them 0",
       [](Parts& p) { p.weights(2) = -0.25; }},
      {"posterior: 4 particles of 2 parameters, 4 weights and 3 chains for a prior of 2 parameters "
       "don't go together",
       [](Parts& p) { p.num_chains = 3; }},
      {"kernel density: no parameter of the 4 finite samples varies",
       [](Parts& p) { p.theta.setConstant(0.5); }},
      {"'particles/theta'", [](Parts& p) { p.theta(0, 0) = kNaN; }},
      {"'particles/weight'", [](Parts& p) { p.weights(0) = kNaN; }},
      {"(4, 1)", [](Parts& p) { p.theta.conservativeResize(4, 1); }}};
  for (const auto& [said, spoil] : cases) {
    Parts parts = small_parts();
    spoil(parts);
    const auto path = written(parts);
    EXPECT_TRUE(has(problem([&] { read_posterior(path); }), {"p.h5: ", said}));
  }
}

TEST_F(ParticleFile, WhatMakesNoPopulationIsRefused) {
  using Population = inference::AbcPopulation;
  const std::string sizes = "p.h5: distances and epsilon must be finite and >= 0";
  const std::vector<std::pair<std::string, void (*)(Population&)>> cases = {
      {sizes, [](Population& p) { p.distances(1) = -1.0; }},
      {sizes, [](Population& p) { p.epsilon = kNaN; }},
      {"(3)", [](Population& p) { p.distances = Vector::Ones(3); }},
      {"(3, 3)", [](Population& p) { p.kernel = Eigen::MatrixXd::Ones(3, 3); }}};
  for (const auto& [said, spoil] : cases) {
    Population population = population_of(small_parts());
    spoil(population);
    const auto path = written([&](h5::File& file) {
      write_particles(file, "abc_smc", small_parts(), {});
      write_population(file, population);
    });
    EXPECT_TRUE(
        has(problem([&] { read_population(open_artefact(path, kPosteriorSchema)); }), said));
  }
  // A regression's file, or a damaged one, has none.
  const auto path =
      written([&](h5::File& file) { write_particles(file, "abc_smc", small_parts(), {}); });
  EXPECT_THROW(read_population(open_artefact(path, kPosteriorSchema)), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
