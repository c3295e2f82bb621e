#include "pipeline/artefacts/posterior_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/transform_file.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {
namespace {

constexpr h5::Storage kPlain{.chunked = true, .deflate = 1, .rows_per_chunk = 0};

Vector to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

std::vector<double> to_list(const Vector& values) { return {values.begin(), values.end()}; }

void write_channels(h5::Dataset& x_o, const std::string& kind,
                    const std::vector<Channel>& channels) {
  std::vector<std::string> labels, units;
  for (const Channel& channel : channels) {
    labels.push_back(channel.label);
    units.push_back(channel.unit);
  }
  x_o.set_attribute(kind + "_labels", labels);
  x_o.set_attribute(kind + "_units", units);
}

std::vector<Channel> read_channels(const h5::Dataset& x_o, const std::string& kind) {
  const auto labels = x_o.attribute<std::vector<std::string>>(kind + "_labels");
  const auto units = x_o.attribute<std::vector<std::string>>(kind + "_units");
  std::vector<Channel> channels;
  for (std::size_t c = 0; c < std::min(labels.size(), units.size()); ++c) {
    channels.push_back({labels[c], units[c]});
  }
  return channels;
}

void write_observation(h5::File& file, const VectorF& x, const Target& target) {
  h5::Dataset x_o = file.write("x_o", x);
  x_o.label_dimensions({"feature"});
  x_o.set_attribute("dt", target.dt);
  x_o.set_attribute("num_rollouts", target.num_rollouts());
  x_o.set_attribute("num_steps", target.num_steps());
  write_channels(x_o, "state", target.state_channels);
  write_channels(x_o, "action", target.action_channels);
}

void write_proposal(h5::File& file, const inference::GaussianMixture& proposal) {
  h5::Group group = file.create_group("proposal");
  group.write("mean", proposal.means.front()).label_dimensions({"parameter"});
  const RowMatrix factor = proposal.precision_factors.front();
  group.write("precision_factor", factor).label_dimensions({"parameter", "parameter"});
}

inference::GaussianMixture read_proposal(const h5::Group& group, const inference::Prior& prior) {
  const Index d = prior.dimension();
  const Vector mean = group.read_vector<double>("mean", d, h5::Values::finite);
  const RowMatrix factor = group.read_matrix<double>("precision_factor", d, d, h5::Values::finite);
  if (!(factor.diagonal().minCoeff() > 0.0)) {
    throw InputError(group.where() +
                     ": precision_factor must have a positive diagonal; rerun stage 'infer'");
  }
  return {Vector::Zero(1), {mean}, {factor.triangularView<Eigen::Upper>()}};
}

template <class Config>
Config read_config(const h5::File& file, const std::string& name) {
  const std::string where = file.where() + ": attribute '" + name + "'";
  return from_json<Config>(parse_json(file.attribute<std::string>(name), where), where);
}

std::uint64_t read_structure_seed(const h5::File& file) {
  const auto text = file.attribute<std::string>("structure_seed");
  std::uint64_t seed = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, seed);
  if (error == std::errc() && stop == end) return seed;
  throw InputError(file.where() + ": " +
                   must_be("attribute 'structure_seed'", quoted(text), "an integer >= 0"));
}

Index read_trained_features(const h5::File& file) {
  const auto width = file.attribute<Index>("trained_features");
  const Constraint<double> allowed = between(0, kMaxWidth);
  if (satisfies(width, allowed)) return width;
  throw InputError(file.where() + ": " +
                   must_be("attribute 'trained_features'", std::to_string(width), allowed.words));
}

// A network is made before its weights can be counted exactly. The large matrices of its estimator
// alone tell a file that asks for much more than it holds.
void require_enough_weights(const std::string& where, const inference::NetworkParts& parts) {
  const inference::EstimatorConfig& c = parts.estimator;
  using enum inference::EstimatorKind;
  const bool is_flow = c.kind == maf || c.kind == nsf;
  const bool is_likelihood = parts.role == inference::NetworkRole::likelihood;
  const Index width = is_likelihood ? parts.transform.num_outputs() : parts.prior.dimension();
  const Index layers = c.kind == resnet ? 2 * c.num_hidden_layers : c.num_hidden_layers - 1;
  const Index least =
      (is_flow ? c.num_transforms : 1) * c.hidden_features * (layers * c.hidden_features + width);
  if (parts.parameters.size() >= least) return;
  throw InputError(
      fmt::format("{}: {} weights, but its density_estimator has more than {}; rerun "
                  "stage 'infer'",
                  where, parts.parameters.size(), least));
}

std::unique_ptr<inference::NetworkPosterior> read_network(const h5::File& file) {
  const std::string prior = file.attribute<std::string>("prior");
  inference::NetworkParts parts{
      .prior = inference::Prior(prior_from_json(parse_json(prior, file.where()), file.where())),
      .role = parse_enum<inference::NetworkRole>("network role",
                                                 file.attribute<std::string>("network_role")),
      .estimator = read_config<inference::EstimatorConfig>(file, "density_estimator"),
      .trained_features = read_trained_features(file),
      .structure_seed = read_structure_seed(file),
      .transform = {},
      .parameters = file.read_vector<float>("weights", -1, h5::Values::finite),
      .x_o = file.read_vector<float>("x_o", -1, h5::Values::finite)};
  parts.transform = read_transform(file, parts.x_o.size());
  parts.sampler = read_config<inference::SamplerConfig>(file, "sampler");
  if (file.has("proposal")) parts.proposal = read_proposal(file.group("proposal"), parts.prior);
  require_enough_weights(file.where(), parts);
  try {
    return inference::make_posterior(std::move(parts));
  } catch (const ShapeError& error) {
    throw InputError(file.where() + ": " + error.what() + "; rerun stage 'infer'");
  }
}

}  // namespace

inference::PosteriorEstimationConfig estimation_config(const MethodConfig& method) {
  const bool is_linear = method.embedding.kind == inference::EmbeddingKind::linear;
  return {.algorithm = method.algorithm,
          .estimator = method.density_estimator,
          .training = method.training,
          .sampler = method.sampler,
          .principal_components = method.embedding.principal_components,
          .trained_features = is_linear ? method.embedding.features : 0};
}

void write_posterior(h5::File& file, const MethodConfig& method,
                     const inference::NetworkPosterior& posterior, const Target& target,
                     const inference::TrainingState& training, const RowCounts& rows) {
  const inference::NetworkParts& parts = posterior.parts();
  file.set_attribute("network_role", name_of(parts.role));
  file.set_attribute("sampler", to_json(parts.sampler).dump());
  if (parts.proposal) write_proposal(file, *parts.proposal);
  file.set_attribute("prior", to_json(parts.prior.marginals()).dump());
  file.set_attribute("density_estimator", to_json(parts.estimator).dump());
  file.set_attribute("embedding", to_json(method.embedding).dump());
  file.set_attribute("trained_features", parts.trained_features);
  file.set_attribute("structure_seed", std::to_string(parts.structure_seed));
  file.set_attribute("num_simulations", rows.used);
  file.set_attribute("num_failed", rows.failed);
  file.write("weights", parts.parameters, kPlain).label_dimensions({"weight"});
  write_observation(file, parts.x_o, target);
  write_transform(file, parts.transform);
  h5::Group curves = file.create_group("training");
  curves.write("training_loss", to_vector(training.training_loss)).label_dimensions({"epoch"});
  curves.write("validation_loss", to_vector(training.validation_loss)).label_dimensions({"epoch"});
}

std::unique_ptr<inference::Posterior> read_posterior(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kPosteriorSchema);
  if (holds_particles(file)) return read_particles(file);
  return read_network(file);
}

std::unique_ptr<inference::NetworkPosterior> read_network_posterior(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kPosteriorSchema);
  if (!holds_particles(file)) return read_network(file);
  throw InputError(fmt::format(
      "{}: a posterior of '{}' has no network and holds for its own observation alone; infer from "
      "another one in a study of its own",
      file.where(), file.attribute<std::string>("algorithm")));
}

Channels observed_channels(const std::filesystem::path& posterior) {
  const h5::Dataset x_o = open_artefact(posterior, kPosteriorSchema).dataset("x_o");
  return {read_channels(x_o, "state"), read_channels(x_o, "action")};
}

void require_like_observation(const std::string& where, const Target& found,
                              const std::filesystem::path& posterior) {
  constexpr double tolerance = 1e-3;
  const h5::Dataset x_o = open_artefact(posterior, kPosteriorSchema).dataset("x_o");
  std::vector<std::string> differences;
  if (const auto dt = x_o.attribute<double>("dt"); !(std::abs(found.dt - dt) <= tolerance * dt)) {
    differences.push_back(fmt::format("dt = {} s, must be {} s", found.dt, dt));
  }
  const auto require = [&](const char* attribute, Index count, const char* what) {
    const auto expected = x_o.attribute<Index>(attribute);
    if (count == expected) return;
    differences.push_back(fmt::format("{} {}, must be {}", count, what, expected));
  };
  require("num_rollouts", found.num_rollouts(), "rollouts");
  require("num_steps", found.num_steps(), "steps");
  if (differences.empty()) return;
  throw InputError(fmt::format("{}: {}; it must be like what '{}' was trained for", where,
                               join(differences, "; "), posterior.string()));
}

PosteriorNotes read_posterior_notes(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kPosteriorSchema);
  PosteriorNotes notes{
      .rows = {file.attribute<Index>("num_simulations"), file.attribute<Index>("num_failed")},
      .regression = read_regression_counts(file),
      .training_loss = {},
      .validation_loss = {}};
  if (holds_particles(file)) return notes;
  const h5::Group curves = file.group("training");
  notes.training_loss = curves.read_vector<double>("training_loss");
  notes.validation_loss = curves.read_vector<double>("validation_loss");
  return notes;
}

void write_checkpoint(const std::filesystem::path& path, const Identity& identity,
                      const Checkpoint& checkpoint) {
  const inference::TrainingState& state = checkpoint.training;
  ArtefactWriter writer(path, kCheckpointSchema, identity);
  writer.add_cost(checkpoint.cost);
  h5::File& file = writer.file();
  file.set_attribute("epoch", state.epoch);
  file.set_attribute("epochs_without_improvement", state.epochs_without_improvement);
  file.set_attribute("best_validation_loss", state.best_validation_loss);
  file.set_attribute("num_steps", static_cast<Index>(state.adam.num_steps));
  file.write("parameters", state.parameters, kPlain);
  file.write("average", state.average, kPlain);
  file.write("best_parameters", state.best_parameters, kPlain);
  file.write("first_moment", state.adam.first_moment, kPlain);
  file.write("second_moment", state.adam.second_moment, kPlain);
  file.write("training_loss", to_vector(state.training_loss));
  file.write("validation_loss", to_vector(state.validation_loss));
  writer.finish();
}

Checkpoint read_checkpoint(const ArtefactFile& artefact) {
  const std::optional<h5::File> opened = open_artefact_if_there(artefact, kCheckpointSchema);
  if (!opened) return {};
  const h5::File& file = *opened;
  Checkpoint checkpoint{.training = {}, .cost = provenance_of(file).cost};
  inference::TrainingState& state = checkpoint.training;
  state.epoch = file.attribute<Index>("epoch");
  state.epochs_without_improvement = file.attribute<Index>("epochs_without_improvement");
  state.best_validation_loss = file.attribute<double>("best_validation_loss");
  state.adam.num_steps = file.attribute<Index>("num_steps");
  if (state.epoch < 0 || state.epochs_without_improvement < 0 || state.adam.num_steps < 0) {
    throw InputError(file.where() + ": counts of epochs and steps must be >= 0; remove this file");
  }
  state.parameters = file.read_vector<float>("parameters");
  const Index size = state.parameters.size();
  state.average = file.read_vector<float>("average", size);
  state.best_parameters = file.read_vector<float>("best_parameters", size);
  state.adam.first_moment = file.read_vector<float>("first_moment", size);
  state.adam.second_moment = file.read_vector<float>("second_moment", size);
  state.training_loss = to_list(file.read_vector<double>("training_loss", state.epoch));
  state.validation_loss = to_list(file.read_vector<double>("validation_loss", state.epoch));
  return checkpoint;
}

}  // namespace npdr::pipeline
