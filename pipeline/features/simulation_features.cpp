#include "pipeline/features/simulation_features.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "analysis/metrics.h"
#include "core/atomic_file.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/stop_request.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

constexpr Index kBlockRows = 256;
constexpr off_t kLargestInMemory = off_t{512} << 20;  // [bytes]

[[noreturn]] void fail_to_store(const std::string& what) {
  throw Error("temporary rows of features: can't " + what + ": " + std::strerror(errno) +
              "; free some space or choose another --work folder");
}

off_t bytes_of(Index num_floats) {
  return static_cast<off_t>(num_floats) * static_cast<off_t>(sizeof(float));
}

// All uses of a simulation are in the same round.
std::uint32_t round_of(const Node& simulation) {
  return static_cast<std::uint32_t>(simulation.uses.front().round);
}

// The target at the times that a simulation stores: every `stride`-th state, whole strides only.
Target thinned(const Target& target, Index stride) {
  Target result = target;
  const Index steps = target.num_steps() / stride;
  for (Rollout& rollout : result.rollouts) {
    const RowMatrix states = rollout.states, actions = rollout.actions;
    rollout.states = states(Eigen::seqN(0, steps + 1, stride), Eigen::all);
    rollout.actions = actions(Eigen::seqN(0, steps, stride), Eigen::all);
  }
  result.dt *= static_cast<double>(stride);
  return result;
}

std::vector<Index> good_rows(const std::vector<std::uint8_t>& status) {
  std::vector<Index> good;
  for (std::size_t i = 0; i < status.size(); ++i) {
    if (status[i] == 0) good.push_back(static_cast<Index>(i));
  }
  return good;
}

// Simulated features as they are in their file.
class StoredFeatures : public inference::FeatureSource {
 public:
  explicit StoredFeatures(const h5::File& file)
      : values_(simulated_values(file)),
        rows_(good_rows(file.dataset("status").read<std::uint8_t>())) {}

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

RowStore::RowStore(Index num_rows, Index width, const std::filesystem::path& folder)
    : width_(width) {
  const off_t size = bytes_of(num_rows * width);
  if (size <= kLargestInMemory) {
    memory_.resize(static_cast<std::size_t>(num_rows * width));
    return;
  }
  make_folder(folder);
  // Named like all temporaries, in case that the process is killed before the name is gone.
  const std::filesystem::path name = temporary_name(folder / "rows");
  file_ = open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file_ < 0) fail_to_store("make '" + name.string() + "'");
  unlink(name.c_str());
  // Claims the space now, rather than failing half way.
  do {
    errno = posix_fallocate(file_, 0, size);
  } while (errno == EINTR);
  if (errno != 0) fail_to_store("reserve " + std::to_string(size >> 20) + " MiB");
}

RowStore::~RowStore() {
  if (file_ >= 0) close(file_);
}

void RowStore::write(Index row, std::span<const float> values) {
  if (file_ < 0) {
    std::copy(values.begin(), values.end(), memory_.begin() + row * width_);
  } else if (pwrite(file_, values.data(), values.size_bytes(), bytes_of(row * width_)) !=
             std::ssize(std::as_bytes(values))) {
    fail_to_store("write");
  }
}

void RowStore::read(Index row, std::span<float> values) const {
  if (file_ < 0) {
    std::copy_n(memory_.begin() + row * width_, width_, values.begin());
  } else if (pread(file_, values.data(), values.size_bytes(), bytes_of(row * width_)) !=
             std::ssize(std::as_bytes(values))) {
    fail_to_store("read");
  }
}

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
  const std::vector<Index> good = good_rows(status);
  num_simulated_.push_back(std::ssize(status));
  num_failed_ += std::ssize(status) - std::ssize(good);
  round_.insert(round_.end(), good.size(), round);
  row_.insert(row_.end(), good.begin(), good.end());
  end_.push_back(num_rows());
  const RowMatrix theta =
      file.read_matrix<double>("theta", std::ssize(status), -1, h5::Values::finite);
  theta_.conservativeResize(num_rows(), theta.cols());
  theta_.bottomRows(std::ssize(good)) = theta(good, Eigen::all);
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
        const Index row = row_[static_cast<std::size_t>(next)];
        if (row >= begin + count) break;
        const std::span<const float> series(block.data() + (row - begin) * width,
                                            static_cast<std::size_t>(width));
        embedding_.selection().pick(series, picked);
        if (redraws_) {
          rows_->write(next, picked);
          continue;
        }
        add_noise(picked, static_cast<std::size_t>(next), 0);
        embedding_.embed(picked, x);
        rows_->write(next, x);
      }
    }
  }
}

void SimulationFeatures::add_noise(std::span<float> picked, std::size_t i,
                                   std::uint64_t epoch) const {
  if (noise_.is_silent()) return;
  Stream stream(
      {seed_, "observation_noise", round_[i], static_cast<std::uint64_t>(row_[i]), epoch});
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
    add_noise(picked, rows[i], epoch);
    embedding_.embed(picked, out);
  }
}

Vector metric_distances(const Plan& plan, const Node& node, const Target& target,
                        inference::AbcDistance metric) {
  const Index stride = plan.study.simulator.store_every;
  // Where a segment begins the last state of the one before counts, which is simulated: with few
  // stored states in a segment few others would be left, or none.
  const analysis::Metrics metrics(thinned(target, stride));
  const h5::File file = open_artefact(node, kSimulationSchema);
  const h5::Dataset trajectories = file.dataset("trajectories");
  const Index n = trajectories.num_rows(), steps = target.num_steps() / stride;
  trajectories.require_shape({n, target.num_rollouts(), steps, target.num_states()});
  Vector distances(n);
  std::vector<float> block;
  Progress progress(node.label() + ", distances", n);
  for (Index begin = 0; begin < n; begin += kBlockRows) {
    stop_here_if_requested();
    const Index count = std::min(kBlockRows, n - begin);
    block.resize(static_cast<std::size_t>(count * trajectories.row_size()));
    trajectories.read_rows<float>(begin, count, block);
    const analysis::TrajectoryView view{block, count, target.num_rollouts(), steps,
                                        target.num_states()};
    const bool is_dtw = metric == inference::AbcDistance::dtw;
    distances.segment(begin, count) = is_dtw ? metrics.dtw(view) : metrics.rmse(view);
    progress.update(begin + count);
  }
  const auto failed = [](double d) { return std::isfinite(d) ? d : kInfinity; };
  return distances.unaryExpr(failed);
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
