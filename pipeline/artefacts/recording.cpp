#include "pipeline/artefacts/recording.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/text.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/layout.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/store/artefact.h"
#include "pipeline/store/column_labels.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

// Far more than anybody simulates many times over: 1 GB.
constexpr Index kMostNumbers = 125'000'000;
constexpr std::size_t kLongestText = 255;

// Before any of them is read: a small file may claim very many zeros.
void require_moderate_size(const h5::Dataset& dataset) {
  const Index most_rows = kMostNumbers / std::max<Index>(dataset.row_size(), 1);
  if (dataset.num_rows() <= most_rows) return;
  throw InputError(fmt::format(
      "{} has shape {}, must hold at most {} numbers; cut it, or record fewer steps or rollouts",
      dataset.where(), h5::to_string(dataset.shape()), kMostNumbers));
}

void require_short(const std::string& where, const char* what, const std::string& text) {
  if (text.size() <= kLongestText) return;
  throw InputError(fmt::format("{}: a {} of {} bytes, '{}', must be of at most {}", where, what,
                               text.size(), shortened(text), kLongestText));
}

void require_short(const std::string& where, const std::vector<Channel>& channels) {
  for (const Channel& channel : channels) {
    require_short(where, "label", channel.label);
    require_short(where, "unit", channel.unit);
  }
}

void require_short_texts(const std::string& where, const Target& target) {
  require_short(where, target.state_channels);
  require_short(where, target.action_channels);
  for (const Rollout& rollout : target.rollouts) {
    require_short(where, "name of a rollout", rollout.name);
  }
}

std::vector<Channel> read_channels(const h5::Dataset& dataset) {
  for (const char* name : {"labels", "units"}) {
    (void)dataset.attribute<std::vector<std::string>>(name);  // must be there
  }
  const std::vector<Channel> channels = column_channels(dataset, dataset.shape()[2]);
  require_short(dataset.where(), channels);
  return channels;
}

std::vector<std::string> read_names(const h5::File& file, Index num_rollouts) {
  if (!file.has("rollout")) {
    std::vector<std::string> names;
    for (Index h = 0; h < num_rollouts; ++h) names.push_back(std::to_string(h));
    return names;
  }
  const h5::Dataset dataset = file.dataset("rollout");
  dataset.require_shape({num_rollouts});
  return dataset.read<std::string>();
}

// The columns of the `expected` channels among those that were found; all, when nothing is
// expected.
std::vector<Index> columns_of(const std::string& where, const std::vector<Channel>& found,
                              const std::vector<Channel>* expected) {
  std::vector<Index> columns;
  for (const Channel& channel : expected != nullptr ? *expected : found) {
    const auto column = std::ranges::find(found, channel);
    if (column == found.end()) check_channels(where + ": channels", found, *expected);
    columns.push_back(column - found.begin());
  }
  return columns;
}

// Some columns of row h of an (H, rows, cols) dataset.
RowMatrix read_rollout(const h5::Dataset& dataset, Index h, const std::vector<Index>& columns) {
  RowMatrix values(dataset.shape()[1], dataset.shape()[2]);
  dataset.read_rows<double>(h, 1, {values.data(), static_cast<std::size_t>(values.size())});
  return values(Eigen::all, columns);
}

void write_values(h5::File& file, const Target& target, const std::string& name,
                  RowMatrix Rollout::*values, const std::vector<Channel>& channels) {
  const RowMatrix& first = target.rollouts.front().*values;
  h5::Dataset dataset = file.create_dataset(name, h5::ElementType::f64,
                                            {target.num_rollouts(), first.rows(), first.cols()});
  describe_columns(dataset, channels);
  dataset.label_dimensions({"rollout", "time", "channel"});
  for (Index h = 0; h < target.num_rollouts(); ++h) {
    const RowMatrix& rollout = target.rollouts[static_cast<std::size_t>(h)].*values;
    dataset.write_rows<double>(h, 1, {rollout.data(), static_cast<std::size_t>(rollout.size())});
  }
}

void add_channels(Hasher& hasher, const std::vector<Channel>& channels) {
  hasher.add(static_cast<std::int64_t>(channels.size()));
  for (const Channel& channel : channels) {
    hasher.add(channel.label);
    hasher.add(channel.unit);
  }
}

void add_matrix(Hasher& hasher, const RowMatrix& values) {
  hasher.add(static_cast<std::int64_t>(values.rows()));
  hasher.add(static_cast<std::int64_t>(values.cols()));
  hasher.add_bytes(values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
}

void describe(Layout f, RowMatrix x, Target target) {
  f("x", x, {{"1", "row"}, kFeature}, "x_o").columns(target.state_channels);
  f.attribute("source", target.source, "where it comes from");
}

// Far more than anybody simulates: the noise of all up to the largest is drawn.
constexpr std::int64_t kMostRollouts = 1'000'000;

void describe_numbers(Layout f, std::vector<std::int64_t>& numbers) {
  f("number", numbers, {{"H", "rollout"}},
    "of a simulated truth's rollout, held-out ones and those that policies collect counted, too; 0 "
    "of a recording's");
}

void read_numbers(const h5::File& file, Target& target) {
  std::vector<std::int64_t> numbers;
  describe_numbers(Layout::reader(file), numbers);
  if (std::ssize(numbers) != target.num_rollouts()) {
    throw InputError(fmt::format("{}: 'number' has {} values, but there are {} rollouts",
                                 file.where(), numbers.size(), target.num_rollouts()));
  }
  for (std::size_t h = 0; h < numbers.size(); ++h) {
    if (numbers[h] < 0 || numbers[h] >= kMostRollouts) {
      throw InputError(fmt::format("{}: 'number' holds {}, must be >= 0 and < {}", file.where(),
                                   numbers[h], kMostRollouts));
    }
    target.rollouts[h].number = numbers[h];
  }
}

}  // namespace

Channels channels_of(const sim::SimulatorInfo& info) {
  return {info.state_channels, info.action_channels};
}

void check_channels(const std::string& where, const std::vector<Channel>& found,
                    const std::vector<Channel>& expected) {
  if (found == expected) return;
  throw InputError(where + " are " + to_string(found) + ", must be " + to_string(expected) +
                   "; rename, reorder or convert its columns");
}

std::string to_string(const std::vector<Channel>& channels) {
  std::vector<std::string> parts;
  for (const Channel& channel : channels) {
    parts.push_back(channel.label + " [" + channel.unit + "]");
  }
  return parts.empty() ? "none" : join(parts);
}

Recording read_rollouts(const h5::File& file, const std::optional<Channels>& expected) {
  const h5::Dataset states = own_dataset(file, "states");
  const h5::Dataset actions = own_dataset(file, "actions");
  states.require_shape({-1, -1, -1});
  if (states.num_rows() < 1 || states.row_size() < 1) {
    throw InputError(states.where() + " is empty; record a rollout");
  }
  actions.require_shape({states.shape()[0], states.shape()[1] - 1, -1});
  require_moderate_size(states);
  require_moderate_size(actions);
  states.require_readable(h5::ElementType::f64);
  actions.require_readable(h5::ElementType::f64);

  Target target;
  target.dt = file.attribute<double>("dt");
  if (file.has_attribute("source")) {
    const auto source = file.attribute<std::string>("source");
    target.source = source.size() <= kLongestText ? source : shortened(source);
  }
  const std::vector<Channel> found_states = read_channels(states);
  const std::vector<Channel> found_actions = read_channels(actions);
  const std::vector<Index> state_columns =
      columns_of(states.where(), found_states, expected ? &expected->states : nullptr);
  const std::vector<Index> action_columns =
      columns_of(actions.where(), found_actions, expected ? &expected->actions : nullptr);
  target.state_channels = expected ? expected->states : found_states;
  target.action_channels = expected ? expected->actions : found_actions;
  Index h = 0;
  for (const std::string& name : read_names(file, states.num_rows())) {
    target.rollouts.push_back(
        {name, read_rollout(states, h, state_columns), read_rollout(actions, h, action_columns)});
    ++h;
  }
  require_short_texts(file.where(), target);
  target.check(file.where());
  return {std::move(target), {found_states, found_actions}};
}

Recording read_recording(const std::filesystem::path& path,
                         const std::optional<Channels>& expected) {
  return read_from_outside(path,
                           [&](const h5::File& file) { return read_rollouts(file, expected); });
}

void write_recording(const Target& target, const std::filesystem::path& path) {
  require_short_texts(path.string(), target);
  target.check(path.string());
  AtomicFile atomic(path);
  h5::File file = h5::File::create(atomic.temporary(), path.string());
  write_target(file, target);
  file.close();
  atomic.commit();
}

void write_target(h5::File& file, const Target& target) {
  file.set_attribute("dt", target.dt);
  file.set_attribute("source", target.source);
  write_values(file, target, "states", &Rollout::states, target.state_channels);
  write_values(file, target, "actions", &Rollout::actions, target.action_channels);
  std::vector<std::string> names;
  for (const Rollout& rollout : target.rollouts) names.push_back(rollout.name);
  file.write("rollout", names);
}

std::string content_hash(const Target& target) {
  Hasher hasher;
  hasher.add(target.dt);
  add_channels(hasher, target.state_channels);
  add_channels(hasher, target.action_channels);
  hasher.add(static_cast<std::int64_t>(target.num_rollouts()));
  for (const Rollout& rollout : target.rollouts) {
    add_matrix(hasher, rollout.states);
    add_matrix(hasher, rollout.actions);
  }
  return hasher.hex();
}

void write_rollouts(h5::File& file, const Target& target) {
  write_target(file, target);
  std::vector<std::int64_t> numbers;
  for (const Rollout& rollout : target.rollouts) numbers.push_back(rollout.number);
  describe_numbers(Layout::writer(file), numbers);
}

void list_target(Layout f) {
  std::vector<std::int64_t> none;
  describe_numbers(f, none);
}

void write_observation(h5::File& file, const Target& target) {
  describe(Layout::writer(file), target.rollouts.front().states.bottomRows(1), target);
}

void list_observation(Layout f) { describe(f, RowMatrix(), Target()); }

Target read_target_artefact(const ArtefactFile& target) {
  const h5::File file = open_artefact(target, kTargetSchema);
  if (!file.has("x")) {
    Target rollouts = read_rollouts(file);
    read_numbers(file, rollouts);
    return rollouts;
  }
  const RowMatrix x = file.read_matrix<double>("x", 1, -1, h5::Values::finite);
  const std::vector<Channel> features = column_channels(file.dataset("x"), x.cols());
  if (std::ssize(features) != x.cols()) {
    throw InputError(file.where() + ": dataset 'x' has no labels; rerun stage 'target'");
  }
  return observation_target(features, x.row(0).transpose(), target.path.filename().string());
}

}  // namespace npdr::pipeline
