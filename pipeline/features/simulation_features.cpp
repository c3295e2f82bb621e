#include "pipeline/features/simulation_features.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/plan/completeness.h"

namespace npdr::pipeline {
namespace {

constexpr Index kBlockRows = 256;

// All uses of a simulation are in the same round.
std::uint32_t round_of(const Node& simulation) {
  return static_cast<std::uint32_t>(simulation.uses.front().round);
}

// Simulated features as they are in their file.
class StoredFeatures : public inference::FeatureSource {
 public:
  explicit StoredFeatures(const h5::File& file) : values_(simulated_values(file)) {
    const auto status = file.dataset("status").read<std::uint8_t>();
    for (Index i = 0; i < std::ssize(status); ++i) {
      if (status[static_cast<std::size_t>(i)] == 0) rows_.push_back(i);
    }
  }

  Index num_rows() const override { return std::ssize(rows_); }
  Index num_features() const override { return values_.row_size(); }

  // Of ascending rows, as blocks are, what lies between is read with them.
  void gather(std::span<const std::uint32_t> rows, std::uint64_t /*epoch*/,
              RowMatrixF& x) const override {
    const Index first = rows_[rows.front()];
    RowMatrixF between(rows_[rows.back()] - first + 1, num_features());
    values_.read_rows<float>(first, between.rows(),
                             {between.data(), static_cast<std::size_t>(between.size())});
    x.resize(std::ssize(rows), num_features());
    Index next = 0;
    for (const std::uint32_t row : rows) x.row(next++) = between.row(rows_[row] - first);
  }

 private:
  h5::Dataset values_;
  std::vector<Index> rows_;
};

}  // namespace

SimulationFeatures::SimulationFeatures(const Plan& plan,
                                       const std::vector<const Node*>& simulations,
                                       const Observation& observation,
                                       const inference::Embedding& embedding)
    : embedding_(embedding),
      noise_(observation.noise_of(embedding.selection())),
      redraws_(plan.study.observation_noise.redraw && !noise_.is_silent()),
      seed_(simulations.front()->uses.front().seed) {
  std::vector<h5::File> files;
  for (const Node* simulation : simulations) files.push_back(open_simulation(plan, *simulation));
  for (std::size_t s = 0; s < files.size(); ++s) read_theta(files[s], round_of(*simulations[s]));
  if (num_rows() == 0) {
    throw InputError(fmt::format("{}: all of its {} rows failed ({}): nothing can be learned; {}",
                                 files.front().where(), num_failed_, failures(files.front()),
                                 plan.study.source().advice));
  }
  const Index width = redraws_ ? embedding_.selection().num_values() : embedding_.num_features();
  rows_ = std::make_unique<RowStore>(num_rows(), width, simulations.front()->path.parent_path());
  read_series(files);
}

void SimulationFeatures::read_theta(const h5::File& file, std::uint32_t round) {
  const auto status = file.dataset("status").read<std::uint8_t>();
  num_simulated_.push_back(std::ssize(status));
  const RowMatrix theta =
      file.read_matrix<double>("theta", static_cast<Index>(status.size()), -1, h5::Values::finite);
  const Index before = num_rows();
  for (std::size_t i = 0; i < status.size(); ++i) {
    if (status[i] == 0) {
      origin_.push_back({round, static_cast<std::uint32_t>(i)});
    } else {
      ++num_failed_;
    }
  }
  theta_.conservativeResize(num_rows(), theta.cols());
  for (Index i = before; i < num_rows(); ++i) {
    theta_.row(i) = theta.row(origin_[static_cast<std::size_t>(i)].row);
  }
  end_.push_back(num_rows());
}

void SimulationFeatures::read_series(const std::vector<h5::File>& files) {
  std::vector<float> picked(static_cast<std::size_t>(embedding_.selection().num_values()));
  std::vector<float> x(static_cast<std::size_t>(embedding_.num_features())), block;
  Index next = 0;
  for (std::size_t s = 0; s < files.size(); ++s) {
    const h5::Dataset values = simulated_values(files[s]);
    const Index width = values.row_size();
    for (Index begin = 0; begin < values.num_rows(); begin += kBlockRows) {
      const Index count = std::min(kBlockRows, values.num_rows() - begin);
      block.resize(static_cast<std::size_t>(count * width));
      values.read_rows<float>(begin, count, block);
      for (; next < end_[s]; ++next) {
        const Origin& origin = origin_[static_cast<std::size_t>(next)];
        if (origin.row >= begin + count) break;
        const std::span<const float> series(block.data() + (origin.row - begin) * width,
                                            static_cast<std::size_t>(width));
        embedding_.selection().pick(series, picked);
        if (redraws_) {
          rows_->write(next, picked);
          continue;
        }
        add_noise(picked, origin, 0);
        embedding_.embed(picked, x);
        rows_->write(next, x);
      }
    }
  }
}

void SimulationFeatures::add_noise(std::span<float> picked, const Origin& origin,
                                   std::uint64_t epoch) const {
  if (noise_.is_silent()) return;
  Stream stream({seed_, "observation_noise", origin.round, origin.row, epoch});
  noise_.add(picked, embedding_.selection().stride, stream);
}

void SimulationFeatures::gather(std::span<const std::uint32_t> rows, std::uint64_t epoch,
                                RowMatrixF& x) const {
  x.resize(static_cast<Index>(rows.size()), num_features());
  std::vector<float> picked(static_cast<std::size_t>(rows_->width()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::span<float> out(x.row(static_cast<Index>(i)).data(),
                               static_cast<std::size_t>(num_features()));
    if (!redraws_) {
      rows_->read(rows[i], out);
      continue;
    }
    rows_->read(rows[i], picked);
    add_noise(picked, origin_[rows[i]], epoch);
    embedding_.embed(picked, out);
  }
}

std::vector<std::uint32_t> SimulationFeatures::rounds() const {
  std::vector<std::uint32_t> rounds;
  for (const Origin& origin : origin_) rounds.push_back(origin.round);
  return rounds;
}

std::vector<Index> SimulationFeatures::rows() const {
  std::vector<Index> rows;
  for (const Origin& origin : origin_) rows.push_back(origin.row);
  return rows;
}

inference::FeatureTransform scale_of_features(const Node& simulation, inference::Tails tails) {
  const h5::File file = open_artefact(simulation, kSimulationSchema);
  const StoredFeatures features(file);
  if (features.num_rows() > 0) return inference::fit_feature_transform(features, 0, tails);
  inference::FeatureTransform constant;
  constant.mean = constant.inverse_deviation = VectorF::Zero(features.num_features());
  return constant;
}

std::optional<inference::UsualFeatures> usual_features_of(const inference::FeatureSource& features,
                                                          inference::Tails tails, Index most_rows,
                                                          const StreamId& stream) {
  constexpr Index fewest = inference::kFewestSimulations;
  if (features.num_rows() < fewest) return std::nullopt;
  const Index allowed =
      std::clamp(10'000 * most_rows / features.num_features(), 2 * fewest, most_rows);
  auto rows = Stream(stream).permutation(static_cast<std::uint32_t>(features.num_rows()));
  rows.resize(static_cast<std::size_t>(std::min(allowed, features.num_rows())));
  RowMatrixF x;
  features.gather(rows, 0, x);
  std::vector<Index> finite;
  for (Index i = 0; i < x.rows(); ++i) {
    if (x.row(i).allFinite()) finite.push_back(i);
  }
  if (std::ssize(finite) < fewest) return std::nullopt;
  if (std::ssize(finite) < x.rows()) x = x(finite, Eigen::all).eval();
  return inference::usual_features(x, tails);
}

}  // namespace npdr::pipeline
