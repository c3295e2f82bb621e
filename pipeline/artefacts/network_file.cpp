#include "pipeline/artefacts/network_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/text.h"
#include "inference/ensemble.h"
#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {
namespace {

std::uint64_t parse_structure_seed(const std::string& where, const std::string& text) {
  std::uint64_t seed = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, seed);
  if (error == std::errc() && stop == end) return seed;
  throw InputError(where + ": " +
                   must_be("attribute 'structure_seed'", quoted(text), "an integer >= 0"));
}

void require_its_series(const std::string& where, const inference::NetworkParts& parts) {
  const auto* const direct = std::get_if<inference::DirectParts>(&parts.of_role);
  const Index values = direct == nullptr ? 0 : direct->embedding.series.num_values();
  if (values == 0 || values == parts.transform.num_outputs()) return;
  throw InputError(fmt::format(
      "{}: attribute 'trained_embedding' has series of {} values, but there are {} features; rerun "
      "stage 'infer'",
      where, values, parts.transform.num_outputs()));
}

// The large matrices of the estimator alone: a network is made before its weights can be counted
// exactly.
Index fewest_weights(const inference::NetworkParts& parts) {
  const inference::EstimatorConfig& c = parts.estimator;
  const bool is_likelihood = parts.role() == inference::NetworkRole::likelihood;
  const Index width = is_likelihood ? parts.transform.num_outputs() : parts.prior.dimension();
  const Index layers = c.kind == inference::EstimatorKind::resnet ? 2 * c.num_hidden_layers
                                                                  : c.num_hidden_layers - 1;
  return (traits_of(c.kind).stacks_transforms ? c.num_transforms : 1) * c.hidden_features *
         (layers * c.hidden_features + width);
}

Index num_weights(const inference::ParameterLayout& layout) {
  Index count = 0;
  for (const inference::Layer& layer : layout.layers())
    count += layer.rows.value * layer.cols.value;
  return count;
}

// Before there is memory for them: a file may ask for much more than it holds.
void require_weights(const Layout& network, Index least) {
  const Index found = network.num_values();
  if (found >= least) return;
  throw InputError(
      fmt::format("{}: {} weights, but the file's density_estimator and trained_embedding have at "
                  "least {}; rerun stage 'infer'",
                  network.where(), found, least));
}

void describe(Layout network, const inference::FixedNumbers& fixed) {
  std::vector<Index> values = fixed.values;
  network(fixed.name, values, {{fixed.size.name, "variable"}}, fixed.meaning);
  if (values == fixed.values) return;
  throw InputError(fmt::format(
      "{}: {} isn't what the file's structure_seed and density_estimator give; rerun stage 'infer'",
      network.where(), fixed.name));
}

void describe(Layout network, const inference::Layer& layer,
              inference::Parameters<float>& parameters) {
  const DatasetOptions options{.allowed = h5::Values::finite, .storage = kFastest};
  auto place = inference::view(parameters, layer.block);
  RowMatrixF matrix = place;
  VectorF vector = place.row(0).transpose();
  if (*layer.rows.name == '\0') {
    network(layer.name, vector, {{layer.cols.name, "output"}}, layer.meaning, options);
    place.row(0) = vector.transpose();
  } else {
    network(layer.name, matrix, {{layer.rows.name, "input"}, {layer.cols.name, "output"}},
            layer.meaning, options);
    place = matrix;
  }
}

void describe_network(Layout network, inference::NetworkParts& parts) {
  if (network.reads()) {
    require_its_series(network.where(), parts);
    require_weights(network, fewest_weights(parts));
  }
  const inference::ParameterLayout layout = inference::network_layout(parts);
  if (network.reads()) require_weights(network, num_weights(layout));
  if (network.reads()) parts.parameters.setZero(layout.size());
  const auto bind = [&](const inference::Size& size) { network.bind(size.name, size.value); };
  for (const inference::FixedNumbers& fixed : layout.fixed_numbers()) {
    bind(fixed.size);
    describe(network, fixed);
  }
  for (const inference::Layer& layer : layout.layers()) {
    bind(layer.rows);
    bind(layer.cols);
    describe(network, layer, parts.parameters);
  }
}

// Those of an untrained network of one parameter, and one feature where nothing else is said.
void list_layers(Layout f, const inference::RoleParts& of_role,
                 const inference::EstimatorConfig& config, Index num_features = 1) {
  inference::NetworkParts parts{
      .prior = inference::Prior({{"", "", inference::Marginal::Kind::uniform, 0, 1}}),
      .of_role = of_role,
      .estimator = config,
      .transform = {VectorF::Zero(num_features), VectorF::Ones(num_features), {}},
      .parameters = {},
      .x_o = {}};
  parts.parameters.setZero(inference::network_layout(parts).size());
  describe_layers(f, parts);
}

void describe(Layout f, inference::TrainingState& state) {
  f.attribute("epoch", state.epoch, "epochs that are done");
  f.attribute("epochs_without_improvement", state.epochs_without_improvement, "the last of them");
  f.attribute("best_validation_loss", state.best_validation_loss, "[nats]");
  f.attribute("num_steps", state.adam.num_steps, "of Adam");
  if (f.reads()) {
    if (state.epoch < 0 || state.epochs_without_improvement < 0 || state.adam.num_steps < 0) {
      throw InputError(f.where() + ": counts of epochs and steps must be >= 0; remove this file");
    }
    f.bind("epochs", state.epoch);
  }
  const DatasetOptions fastest{.storage = kFastest};
  f.forget("P");  // networks of a likelihood aren't as large as those of a posterior
  const Dims weights = {{"P"}}, epochs = {{"epochs"}};
  f("parameters", state.parameters, weights, "current weights", fastest);
  f("average", state.average, weights, "their moving average", fastest);
  f("best_parameters", state.best_parameters, weights,
    "the average with the smallest validation loss", fastest);
  f("first_moment", state.adam.first_moment, weights, "of Adam", fastest);
  f("second_moment", state.adam.second_moment, weights, "of Adam", fastest);
  f("training_loss", state.training_loss, epochs, "as in the posterior");
  f("validation_loss", state.validation_loss, epochs, "as in the posterior");
}

// Throws InputError for parts of a transform that don't go together.
void require_transform(const std::string& where, const inference::FeatureTransform& transform) {
  if (transform.center.size() != transform.inverse_scale.size()) {
    throw InputError(where + ": a center without an inverse_scale, or the other way round");
  }
  if ((transform.inverse_scale.array() < 0.0f).any()) {
    throw InputError(where + ": an inverse_scale below 0; must be 0 or more");
  }
  const Index compressed = (transform.inverse_scale.array() > 0.0f).count();
  if (transform.num_copies() != 0 && transform.num_copies() != compressed) {
    throw InputError(fmt::format("{}: {} copies of features, must be 0 or {}", where,
                                 transform.num_copies(), compressed));
  }
}

}  // namespace

std::string group_of_network(Index m) { return fmt::format("network_{}", m + 1); }

std::vector<Index> networks_there(const Layout& f) {
  std::vector<Index> networks;
  // "npe_nle" trains as many again.
  for (Index m = 0; m < static_cast<Index>(2 * inference::EstimatorConfig::kNumNetworks.high);
       ++m) {
    if (!f.those_there({group_of_network(m)}).empty()) networks.push_back(m);
  }
  return networks;
}

void describe_architecture(Layout f, inference::NetworkParts& parts) {
  std::string role = name_of(parts.role()), seed = std::to_string(parts.structure_seed);
  f.attribute("network_role", role,
              "what the network says: `posterior` q(u \\| z), `likelihood` q(z \\| u) or `ratio` "
              "p(z \\| u) / p(z)");
  describe_json(f, "density_estimator", parts.estimator, "JSON: the method's settings");
  auto* direct = std::get_if<inference::DirectParts>(&parts.of_role);
  inference::TrainedEmbeddingConfig embedding;
  if (direct != nullptr) embedding = direct->embedding;
  describe_json(f, "trained_embedding", embedding,
                "JSON: the layers in front of the density estimator, see "
                "[Embeddings](methods.md#embeddings)");
  f.attribute("structure_seed", seed, "an integer: seeds the order of the variables in flows");
  if (!f.reads()) return;
  parts.of_role = inference::role_parts(parse_enum<inference::NetworkRole>("network role", role));
  direct = std::get_if<inference::DirectParts>(&parts.of_role);
  if (direct != nullptr) direct->embedding = embedding;
  parts.structure_seed = parse_structure_seed(f.where(), seed);
}

void describe_layers(Layout f, inference::NetworkParts& parts) {
  std::vector<inference::Parameters<float>> weights;
  for (Index m = 0; m < parts.estimator.num_networks; ++m) {
    inference::NetworkParts one = inference::network_of(parts, m);
    describe_network(f.group(group_of_network(m)), one);
    weights.push_back(std::move(one.parameters));
  }
  parts.parameters = inference::joined(weights);
}

void describe(Layout f, inference::FeatureTransform& transform) {
  // That of a likelihood has components of its own number, and no copies.
  f.forget("k");
  f.forget("G");
  Layout group = f.group("transform");
  group("center", transform.center, {kFeature},
        "of features that span orders of magnitude; missing when none does",
        {.allowed = h5::Values::finite, .unless_empty = true});
  group("inverse_scale", transform.inverse_scale, {kFeature},
        "such an x becomes asinh((x - center) inverse_scale) before all that follows; 0: x stays",
        {.allowed = h5::Values::finite, .unless_empty = true});
  const bool has_none = f.reads() && transform.center.size() == 0;
  const Dim column = has_none ? kFeature : Dim{"G", "feature, then copies"};
  group("mean", transform.mean, {column},
        "that is subtracted from features, and from copies of those with an inverse_scale above 0 "
        "as they were, if there are G - F of them",
        kFinite);
  group("inverse_deviation", transform.inverse_deviation, {column},
        "that they are multiplied by; 0: the feature doesn't vary and is left out", kFinite);
  group("basis", transform.basis, {column, {"k", "component"}},
        "principal components; missing when there are none",
        {.allowed = h5::Values::finite, .unless_empty = true, .storage = kFastest});
  if (f.reads()) return require_transform(group.where(), transform);
  group.attribute(
      "farthest", double{inference::FeatureTransform::kFarthest},
      "beyond +-f of it a standardized feature s becomes +-(f + log(+-s / f)), before the basis");
}

void describe(Layout f, std::optional<inference::UsualFeatures>& usual) {
  auto group = f.group("usual", usual);
  if (!group) return;
  inference::UsualFeatures& u = *usual;
  describe(*group, u.transform);
  (*group)("known", u.known, {{"m", "simulation"}, {"k", "component"}},
           "z of simulations that an x is compared with", kFinite);
  (*group)("distances", u.distances, {{"n", "simulation"}, {"3", "distance"}},
           "of others: length of z, residual beyond the components, to the nearest of `known`",
           kFinite);
  (*group)("lowest", u.lowest, {kFeature}, "value of each feature in all of these simulations",
           kFinite);
  (*group)("highest", u.highest, {kFeature}, "the same", kFinite);
  if (!f.reads()) return;
  const bool fits = u.transform.basis.cols() == u.known.cols();
  if (fits && u.known.size() > 0 && u.distances.rows() > 0) return;
  throw InputError(group->where() + ": nothing to compare an x with; rerun stage 'infer'");
}

std::optional<inference::UsualFeatures> read_usual_features(const ArtefactFile& posterior) {
  const h5::File file = open_artefact(posterior, kPosteriorSchema);
  Layout f = Layout::reader(file);
  VectorF x_o;
  f("x_o", x_o, {kFeature}, "", kFinite);
  std::optional<inference::UsualFeatures> usual;
  describe(f, usual);
  return usual;
}

void list_flow(Layout f) {
  const inference::TrainedEmbeddingConfig embedding{.features = 1, .series = {1, 8, 1}};
  list_layers(f, inference::DirectParts{embedding},
              {.kind = inference::EstimatorKind::maf, .num_transforms = 1},
              embedding.series.num_values());
}

void list_mixture(Layout f) {
  list_layers(f, inference::DirectParts{},
              {.kind = inference::EstimatorKind::mdn, .num_hidden_layers = 1});
}

void list_ratio_network(Layout f) {
  list_layers(f, inference::SurrogateParts{.is_ratio = true},
              {.kind = inference::EstimatorKind::resnet, .num_hidden_layers = 1});
}

void describe(Layout f, TrainingCheckpoint& checkpoint) {
  std::vector<inference::TrainingState>& states = checkpoint.trainings;
  Index epochs = 0;
  for (const inference::TrainingState& state : states) epochs += state.epoch;
  f.attribute("epochs", epochs, "that the networks have done, in all");
  if (f.lists()) states.resize(1);
  if (f.reads()) {
    for (const Index m : networks_there(f)) states.resize(static_cast<std::size_t>(m + 1));
  }
  for (Index m = 0; m < std::ssize(states); ++m) {
    inference::TrainingState& state = states[static_cast<std::size_t>(m)];
    const std::string group = group_of_network(m);
    const bool is_there = f.writes() ? state.epoch > 0 : !f.those_there({group}).empty();
    if (is_there) describe(f.group(group), state);
  }
}

}  // namespace npdr::pipeline
