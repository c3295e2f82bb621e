#include "pipeline/sources/dataset_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "core/constants.h"
#include "core/error.h"
#include "pipeline/sources/lost_numbers.h"
#include "pipeline/sources/precision.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {

sim::Trajectories as_simulated(const inference::Prior& prior, const RowMatrix& theta,
                               const RowMatrix& x) {
  sim::Trajectories result;
  result.resize(x.rows(), 1, 1, x.cols());
  for (Index i = 0; i < x.rows(); ++i) {
    const std::span<float> row = result.row(i);
    std::ranges::transform(x.row(i), row.begin(), [](double v) { return static_cast<float>(v); });
    sim::RolloutStatus& status = result.status[static_cast<std::size_t>(i)];
    if (!prior.contains(theta.row(i).transpose())) {
      status = sim::RolloutStatus::out_of_limits;
    } else if (!std::ranges::all_of(row, [](float v) { return std::isfinite(v); })) {
      status = sim::RolloutStatus::diverged;
    }
    if (status == sim::RolloutStatus::ok) continue;
    std::ranges::fill(row, kFloatNaN);
  }
  return result;
}

namespace {

class DatasetRows final : public RowSimulator {
 public:
  DatasetRows(const Study& study, const ParameterMap& parameters, const RowsConfig& config)
      : prior_(study.prior),
        parameters_(parameters),
        dataset_(open_dataset(study)),
        rows_(dataset_rows(config.seed, dataset_.num_rows(), config.num_rows)) {}

  sim::Trajectories simulate(const RowMatrix& complete, const StreamId& first) override {
    const auto begin = static_cast<Index>(first.row);
    const RowMatrix theta = parameters_.pick(complete);
    const RowMatrix x = rows_from(begin, complete.rows());
    warnings_ = find_lost_precision(x, dataset_.features());
    sim::Trajectories result = as_simulated(prior_, theta, x);
    const auto last = std::find_if(result.status.rbegin(), result.status.rend(),
                                   [](auto status) { return status != sim::RolloutStatus::ok; });
    if (last != result.status.rend()) {
      const Index i = result.status.rend() - last - 1;
      failure_ =
          fmt::format("row {} of the dataset, {}", rows_[static_cast<std::size_t>(begin + i)] + 1,
                      *last == sim::RolloutStatus::diverged ? words_of_lost_number(x.row(i))
                                                            : words_of_outside(theta.row(i)));
    }
    return result;
  }

  // They cost next to nothing.
  Index block_size(Index) const override { return 4096; }

  Findings last_warnings() const override { return warnings_; }
  std::string last_failure() const override { return failure_; }

 private:
  // "nan in 'omega'", of a row that has diverged.
  std::string words_of_lost_number(const Eigen::RowVectorXd& x) const {
    sim::Trajectories row;
    row.resize(1, 1, 1, x.size());
    row.status.front() = sim::RolloutStatus::diverged;
    const std::span<const double> given(x.data(), static_cast<std::size_t>(x.size()));
    return first_lost_number(given, row, dataset_.features(), 0).value().words;
  }

  // "'mass' = 7, outside of the prior, [0, 1]".
  std::string words_of_outside(const Eigen::RowVectorXd& theta) const {
    const auto outside = [&](Index d) {
      const inference::Marginal& marginal = prior_.marginals()[static_cast<std::size_t>(d)];
      return !inference::Prior({marginal}).contains(Vector::Constant(1, theta(d)));
    };
    Index d = 0;
    while (d + 1 < prior_.dimension() && !outside(d)) ++d;
    const inference::Marginal& marginal = prior_.marginals()[static_cast<std::size_t>(d)];
    return fmt::format("'{}' = {}, outside of the prior, [{}, {}]", marginal.name, theta(d),
                       marginal.lower(), marginal.upper());
  }

  // Rows are all over the file, whose chunks may be compressed: as many are read at once as memory
  // is easily had for.
  RowMatrix rows_from(Index begin, Index count) {
    if (begin < read_begin_ || begin + count > read_begin_ + read_.rows()) {
      const Index most = kNumbersRead / std::max<Index>(1, std::ssize(dataset_.features()));
      const Index blocks = std::max<Index>(1, most / count);  // whole ones: each is read once
      const Index reads = std::min(blocks * count, std::ssize(rows_) - begin);
      read_ = dataset_.x(std::span(rows_).subspan(static_cast<std::size_t>(begin),
                                                  static_cast<std::size_t>(reads)));
      read_begin_ = begin;
    }
    return read_.middleRows(begin - read_begin_, count);
  }

  static constexpr Index kNumbersRead = Index{1} << 18;

  inference::Prior prior_;
  ParameterMap parameters_;
  DatasetFile dataset_;
  std::vector<Index> rows_;
  RowMatrix read_;
  Index read_begin_ = 0;  // the first of them
  Findings warnings_;
  std::string failure_;
};

}  // namespace

SourceKeys DatasetSource::keys() const {
  const std::string hash = file_hash(*study().external.dataset);
  nlohmann::ordered_json json, theta;
  theta["dataset"] = hash;
  theta["order"] = "random";  // of the rows, in theta as in x
  json["files"] = theta;
  json["features"] = study().external.features;
  json.update(own_settings());
  return {json, json, json, theta};
}

std::optional<RowMatrix> DatasetSource::theta(std::uint64_t seed, Index count) const {
  const DatasetFile dataset = open_dataset(study());
  return dataset.theta(dataset_rows(seed, dataset.num_rows(), count));
}

std::unique_ptr<RowSimulator> DatasetSource::open(const RowsConfig& config) const {
  return std::make_unique<DatasetRows>(study(), parameters(), config);
}

}  // namespace npdr::pipeline
