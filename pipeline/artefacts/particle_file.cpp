#include "pipeline/artefacts/particle_file.h"

#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/artefacts/layout.h"

namespace npdr::pipeline {
namespace {

inference::ParticleSpace parse_space(const std::string& where, const std::string& name) {
  if (name == "normal_prior") return inference::ParticleSpace::normal_prior;
  if (name == "theta") return inference::ParticleSpace::theta;
  throw InputError(where + ": " +
                   must_be("attribute 'space'", quoted(name), "normal_prior or theta"));
}

void describe_algorithm(Layout f, std::string name) {
  f.attribute("algorithm", name, "`abc_smc`, ...");
}

void describe(Layout f, inference::ParticleParts& parts) {
  Layout group = f.group("particles");
  std::string space = parts.space == inference::ParticleSpace::theta ? "theta" : "normal_prior";
  group.attribute("space", space, "where densities are estimated: `normal_prior` (u) or `theta`");
  if (f.reads()) parts.space = parse_space(group.where(), space);
  group.attribute("smooth", parts.smooth, "1: samples are moved by a draw of the kernel");
  group.attribute("num_chains", parts.num_chains, "C > 0: row s C + c is draw s of Markov chain c");
  // Where no device is, a regression may divide by 0.
  const bool may_be_infinite = parts.space == inference::ParticleSpace::theta;
  group("theta", parts.theta, {kRow, kParameter},
        "the particles; not finite only where a regression divides by 0",
        may_be_infinite ? DatasetOptions{} : kFinite);
  group("weight", parts.weights, {kRow}, "their weights, >= 0", kFinite);
  group("mode", parts.mode, {kParameter}, "`least_squares`: the best fit",
        {.allowed = h5::Values::finite, .unless_empty = true});
}

void describe(Layout f, inference::AbcPopulation& population) {
  Layout group = f.group("abc");
  group.attribute("epsilon", population.epsilon, "threshold that all distances keep");
  group("distance", population.distances, {kRow}, "of each particle's simulation", kFinite);
  group("kernel", population.kernel, {kParameter, kParameter},
        "`abc_mcmc`, `abc_smc`: covariance of the steps of the next round's proposals, over u",
        {.allowed = h5::Values::finite, .unless_empty = true});
}

inference::ParticleParts particle_parts(const std::vector<inference::Marginal>& prior) {
  return {.prior = inference::Prior(prior), .theta = {}, .weights = {}};
}

[[noreturn]] void reject(const h5::File& file, const std::string& what) {
  throw InputError(file.where() + ": " + what + "; rerun stage 'infer'");
}

std::unique_ptr<inference::ParticlePosterior> read_posterior(const h5::File& file, Layout f) {
  std::vector<inference::Marginal> prior;
  describe(f, prior);
  inference::ParticleParts parts = particle_parts(prior);
  describe(f, parts);
  try {
    return std::make_unique<inference::ParticlePosterior>(std::move(parts));
  } catch (const Error& error) {
    reject(file, error.what());
  }
}

}  // namespace

bool holds_particles(const h5::File& file) { return file.has("particles"); }

void write_particles(h5::File& file, const std::string& algorithm, inference::ParticleParts parts,
                     RowCounts rows) {
  std::vector<inference::Marginal> prior = parts.prior.marginals();
  const Layout f = Layout::writer(file);
  describe_algorithm(f, algorithm);
  describe(f, prior);
  describe(f, rows);
  describe(f, parts);
}

std::unique_ptr<inference::ParticlePosterior> read_particles(const h5::File& file) {
  return read_posterior(file, Layout::reader(file));
}

void write_population(h5::File& file, inference::AbcPopulation population) {
  describe(Layout::writer(file), population);
}

inference::AbcPopulation read_population(const h5::File& file) {
  const Layout f = Layout::reader(file);
  const auto posterior = read_posterior(file, f);
  const inference::ParticleParts& parts = posterior->parts();
  inference::AbcPopulation population{.theta = parts.theta,
                                      .weights = parts.weights / parts.weights.sum(),
                                      .distances = {},
                                      .kernel = {},
                                      .num_chains = parts.num_chains};
  describe(f, population);
  if (!std::isfinite(population.epsilon) || !(population.distances.minCoeff() >= 0.0)) {
    reject(file, "distances and epsilon must be finite and >= 0");
  }
  return population;
}

void describe(Layout f, std::optional<FittedStates>& fitted) {
  if (auto group = f.group("fit", fitted)) {
    (*group)("first_states", fitted->states, {{"S"}, {"C"}},
             "`least_squares` of a recording: states that its segments begin in", kFinite);
  }
}

void describe(Layout f, std::optional<RegressionCounts>& counts) {
  auto group = f.group("regression", counts);
  if (!group) return;
  group->attribute("num_samples", counts->samples, "samples of the weights");
  group->attribute("num_non_physical", counts->non_physical, "that give impossible parameters");
  group->attribute("num_outside_prior", counts->outside_prior,
                   "that give some outside of the prior");
  if (f.reads()) return;
  inference::WeightPosterior& weights = counts->weights;
  group->attribute("noise_deviation", 1.0 / std::sqrt(weights.precisions.noise),
                   "of the residuals [N m]");
  (*group)("mean", weights.mean, {{"W", "weight"}},
           "of the Gaussian posterior of the regression's weights, SI");
  (*group)("covariance", weights.covariance, {{"W", "weight"}, {"W", "weight"}}, "of the same");
}

void list_particles(Layout f) {
  inference::ParticleParts parts =
      particle_parts({{"", "", inference::Marginal::Kind::uniform, 0, 1}});
  inference::AbcPopulation population;
  std::optional<FittedStates> fitted;
  std::optional<RegressionCounts> counts;
  describe_algorithm(f, "");
  describe(f, parts);
  describe(f, population);
  describe(f, fitted);
  describe(f, counts);
}

}  // namespace npdr::pipeline
