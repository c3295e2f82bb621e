#include "pipeline/artefacts/particle_file.h"

#include <cmath>

#include "core/error.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kNormalPrior = "normal_prior";
constexpr const char* kTheta = "theta";

inference::ParticleSpace read_space(const h5::Group& group) {
  const auto name = group.attribute<std::string>("space");
  const Constraint<std::string> allowed = one_of({kNormalPrior, kTheta});
  if (!satisfies(name, allowed)) {
    throw InputError(group.where() + ": " +
                     must_be("attribute 'space'", quoted(name), allowed.words, allowed.names));
  }
  return name == kTheta ? inference::ParticleSpace::theta : inference::ParticleSpace::normal_prior;
}

inference::ParticleParts read_parts(const h5::File& file) {
  const h5::Group group = file.group("particles");
  const inference::Prior prior(prior_from_json(
      parse_json(file.attribute<std::string>("prior"), file.where()), file.where()));
  inference::ParticleParts parts{.prior = prior, .theta = {}, .weights = {}};
  parts.space = read_space(group);
  parts.smooth = group.attribute<Index>("smooth") != 0;
  parts.num_chains = group.attribute<Index>("num_chains");
  // Where no device is, a regression may divide by 0.
  const bool may_be_infinite = parts.space == inference::ParticleSpace::theta;
  parts.theta = group.read_matrix<double>("theta", -1, prior.dimension(),
                                          may_be_infinite ? h5::Values::any : h5::Values::finite);
  parts.weights = group.read_vector<double>("weight", parts.theta.rows(), h5::Values::finite);
  return parts;
}

[[noreturn]] void reject(const h5::File& file, const std::string& what) {
  throw InputError(file.where() + ": " + what + "; rerun stage 'infer'");
}

}  // namespace

bool holds_particles(const h5::File& file) { return file.has("particles"); }

void write_particles(h5::File& file, const std::string& algorithm,
                     const inference::ParticleParts& parts, const RowCounts& rows) {
  file.set_attribute("algorithm", algorithm);
  file.set_attribute("prior", to_json(parts.prior.marginals()).dump());
  file.set_attribute("num_simulations", rows.used);
  file.set_attribute("num_failed", rows.failed);
  h5::Group group = file.create_group("particles");
  const bool is_theta = parts.space == inference::ParticleSpace::theta;
  group.set_attribute("space", std::string(is_theta ? kTheta : kNormalPrior));
  group.set_attribute("smooth", Index{parts.smooth ? 1 : 0});
  group.set_attribute("num_chains", parts.num_chains);
  group.write("theta", parts.theta).label_dimensions({"row", "parameter"});
  group.write("weight", parts.weights).label_dimensions({"row"});
}

std::unique_ptr<inference::ParticlePosterior> read_particles(const h5::File& file) {
  inference::ParticleParts parts = read_parts(file);
  try {
    return std::make_unique<inference::ParticlePosterior>(std::move(parts));
  } catch (const Error& error) {
    reject(file, error.what());
  }
}

void write_population(h5::File& file, const inference::AbcPopulation& population) {
  h5::Group group = file.create_group("abc");
  group.set_attribute("epsilon", population.epsilon);
  group.write("distance", population.distances).label_dimensions({"row"});
  if (population.kernel.size() == 0) return;
  const RowMatrix kernel = population.kernel;
  group.write("kernel", kernel).label_dimensions({"parameter", "parameter"});
}

inference::AbcPopulation read_population(const h5::File& file) {
  const auto posterior = read_particles(file);
  const inference::ParticleParts& parts = posterior->parts();
  const h5::Group group = file.group("abc");
  inference::AbcPopulation population{.theta = parts.theta,
                                      .weights = parts.weights / parts.weights.sum(),
                                      .distances = {},
                                      .epsilon = group.attribute<double>("epsilon"),
                                      .kernel = {},
                                      .num_chains = parts.num_chains};
  population.distances =
      group.read_vector<double>("distance", parts.theta.rows(), h5::Values::finite);
  if (!std::isfinite(population.epsilon) || !(population.distances.minCoeff() >= 0.0)) {
    reject(file, "distances and epsilon must be finite and >= 0");
  }
  if (group.has("kernel")) {
    const Index d = parts.prior.dimension();
    population.kernel = group.read_matrix<double>("kernel", d, d, h5::Values::finite);
  }
  return population;
}

void write_regression(h5::File& file, const inference::WeightPosterior& weights,
                      const RegressionCounts& counts) {
  h5::Group group = file.create_group("regression");
  group.set_attribute("noise_deviation", 1.0 / std::sqrt(weights.precisions.noise));
  group.set_attribute("num_samples", counts.samples);
  group.set_attribute("num_non_physical", counts.non_physical);
  group.set_attribute("num_outside_prior", counts.outside_prior);
  group.write("mean", weights.mean).label_dimensions({"weight"});
  const RowMatrix covariance = weights.covariance;
  group.write("covariance", covariance).label_dimensions({"weight", "weight"});
}

std::optional<RegressionCounts> read_regression_counts(const h5::File& file) {
  if (!file.has("regression")) return std::nullopt;
  const h5::Group group = file.group("regression");
  return RegressionCounts{group.attribute<Index>("num_samples"),
                          group.attribute<Index>("num_non_physical"),
                          group.attribute<Index>("num_outside_prior")};
}

}  // namespace npdr::pipeline
