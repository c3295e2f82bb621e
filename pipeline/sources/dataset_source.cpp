#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "core/feature_names.h"
#include "core/random.h"
#include "pipeline/sources/first_rows.h"
#include "pipeline/sources/source.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {

sim::Trajectories as_simulated(const inference::Prior& prior, const RowMatrix& theta,
                               const RowMatrix& x) {
  const sim::Segments segments = feature_segments(x.cols());
  sim::Trajectories result = sim::empty_trajectories(segments, x.rows(), 1);
  for (Index i = 0; i < x.rows(); ++i) {
    if (prior.contains(theta.row(i).transpose())) {
      sim::store_states(segments, x.row(i).data(), 1, i, result);
    } else {
      sim::lose_row(i, sim::RolloutStatus::out_of_limits, result);
    }
  }
  return result;
}

std::vector<Index> dataset_rows(std::uint64_t seed, Index num_rows, Index count) {
  Stream stream({seed, "dataset_rows", 0, 0, 0});
  const auto order = stream.permutation(static_cast<std::uint32_t>(num_rows));
  return {order.begin(), order.begin() + count};
}

DatasetFile open_dataset(const Study& study) {
  std::vector<std::string> parameters;
  for (const inference::Marginal& marginal : study.prior) parameters.push_back(marginal.name);
  return {*study.external.dataset, parameters, parse_features(study.external.features)};
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
      const std::span row(x.row(i).data(), static_cast<std::size_t>(x.cols()));
      failure_ = fmt::format(
          "row {} of the dataset, {}", rows_[static_cast<std::size_t>(begin + i)] + 1,
          *last == sim::RolloutStatus::diverged ? find_lost_number(row, dataset_.features(), 1)
                                                : words_of_outside(theta.row(i)));
    }
    return result;
  }

  // They cost next to nothing.
  Index block_size(Index) const override { return 4096; }

  Findings last_warnings() const override { return warnings_; }
  std::string last_failure() const override { return failure_; }

 private:
  // "'mass' = 7, outside of the prior, [0, 1]".
  std::string words_of_outside(const Eigen::RowVectorXd& theta) const {
    const std::vector<inference::Marginal>& marginals = prior_.marginals();
    const auto is_inside = [&](std::size_t d) {
      const Vector value = Vector::Constant(1, theta(static_cast<Index>(d)));
      return inference::Prior({marginals[d]}).contains(value);
    };
    std::size_t d = 0;
    while (d + 1 < marginals.size() && is_inside(d)) ++d;
    return fmt::format("'{}' = {}, outside of the prior, [{}, {}]", marginals[d].name,
                       theta(static_cast<Index>(d)), marginals[d].lower(), marginals[d].upper());
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

class DatasetSource final : public Source {
 public:
  using Source::Source;

  SourceKeys keys() const override {
    const std::string hash = file_hash(*study().external.dataset);
    nlohmann::ordered_json json, theta;
    theta["dataset"] = hash;
    theta["order"] = "random";  // of the rows, in theta as in x
    json["files"] = theta;
    json["features"] = study().external.features;
    json.update(own_settings());
    return {json, json, json, theta};
  }

  std::optional<RowMatrix> theta(std::uint64_t seed, Index count) const override {
    const DatasetFile dataset = open_dataset(study());
    return dataset.theta(dataset_rows(seed, dataset.num_rows(), count));
  }

  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override {
    return std::make_unique<DatasetRows>(study(), parameters(), config);
  }
};

}  // namespace

std::unique_ptr<Source> make_dataset_source(const Study& study) {
  return std::make_unique<DatasetSource>(study);
}

}  // namespace npdr::pipeline
