#include "pipeline/artefacts/target_file.h"

#include <fmt/format.h>

#include "core/error.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {

namespace {

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
    Target rollouts = read_rollouts(file).target;
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
