#include "pipeline/artefacts/evaluation_file.h"

#include "core/feature_names.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/theta_columns.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

void write_band(h5::Group& group, const std::string& name, const std::vector<RowMatrix>& band) {
  const RowMatrix& first = band.front();
  const auto num_rollouts = static_cast<Index>(band.size());
  h5::Dataset dataset =
      group.create_dataset(name, h5::ElementType::f32, {num_rollouts, first.rows(), first.cols()});
  dataset.label_dimensions({"rollout", "time", "channel"});
  for (Index h = 0; h < num_rollouts; ++h) {
    const RowMatrixF values = band[static_cast<std::size_t>(h)].cast<float>();
    dataset.write_rows<float>(h, 1, {values.data(), static_cast<std::size_t>(values.size())});
  }
}

std::vector<RowMatrix> read_band(const h5::Group& group, const std::string& name) {
  const h5::Dataset dataset = group.dataset(name);
  dataset.require_shape({-1, -1, -1});
  std::vector<RowMatrix> band;
  RowMatrixF values(dataset.shape()[1], dataset.shape()[2]);
  for (Index h = 0; h < dataset.num_rows(); ++h) {
    dataset.read_rows<float>(h, 1, {values.data(), static_cast<std::size_t>(values.size())});
    band.push_back(values.cast<double>());
  }
  return band;
}

void write_bands(h5::File& file, const analysis::Bands& bands) {
  h5::Group group = file.create_group("bands");
  group.set_attribute("coverage", bands.coverage);
  group.set_attribute("num_samples", bands.num_samples);
  write_band(group, "lower", bands.lower);
  write_band(group, "median", bands.median);
  write_band(group, "upper", bands.upper);
}

analysis::Bands read_bands(const h5::Group& group) {
  analysis::Bands bands;
  bands.coverage = group.attribute<double>("coverage");
  bands.num_samples = group.attribute<Index>("num_samples");
  bands.lower = read_band(group, "lower");
  bands.median = read_band(group, "median");
  bands.upper = read_band(group, "upper");
  return bands;
}

void write_x(h5::File& file, const Study& study, const RowMatrixF& x) {
  h5::Dataset dataset = file.write("x", x);
  describe_columns(dataset, parse_features(study.external.features));
  dataset.label_dimensions({"row", "feature"});
}

void write_references(h5::File& file, const Evaluation& evaluation) {
  std::vector<std::string> names;
  Vector log_prob(static_cast<Index>(evaluation.reference_log_prob.size()));
  for (const auto& [name, value] : evaluation.reference_log_prob) {
    log_prob(static_cast<Index>(names.size())) = value;
    names.push_back(name);
  }
  h5::Group group = file.create_group("reference");
  group.write_texts("name", names);
  group.write("log_prob", log_prob);
}

void read_references(const h5::Group& group, Evaluation& evaluation) {
  const std::vector<std::string> names = group.read_texts("name");
  const Vector log_prob = group.read_vector<double>("log_prob", static_cast<Index>(names.size()));
  Index i = 0;
  for (const std::string& name : names) evaluation.reference_log_prob[name] = log_prob(i++);
}

void write_sampler(h5::File& file, const inference::SamplerReport& report) {
  h5::Group group = file.create_group("sampler");
  if (report.r_hat.size() > 0) group.write("r_hat", report.r_hat).label_dimensions({"parameter"});
  group.write("ess", report.ess);
  group.set_attribute("num_evaluations", report.num_evaluations);
}

inference::SamplerReport read_sampler(const h5::Group& group) {
  inference::SamplerReport report;
  if (group.has("r_hat")) report.r_hat = group.read_vector<double>("r_hat");
  report.ess = group.read_vector<double>("ess");
  report.num_evaluations = group.attribute<Index>("num_evaluations");
  return report;
}

}  // namespace

void write_evaluation(h5::File& file, const Study& study, const Evaluation& evaluation) {
  write_theta(file, study.prior, evaluation.theta);
  file.write("log_prob", evaluation.log_prob).label_dimensions({"row"});
  for (const auto& [metric, values] : evaluation.metrics) {
    file.write(metric, values).label_dimensions({"row"});
  }
  if (evaluation.nominal_log_prob) {
    file.write_scalar("nominal_log_prob", *evaluation.nominal_log_prob);
  }
  if (evaluation.truth_log_prob) file.write_scalar("truth_log_prob", *evaluation.truth_log_prob);
  if (!evaluation.reference_log_prob.empty()) write_references(file, evaluation);
  if (evaluation.sampler) write_sampler(file, *evaluation.sampler);
  h5::Group map = file.create_group("map");
  map.write("theta", evaluation.map_theta).label_dimensions({"parameter"});
  map.write_scalar("log_prob", evaluation.map_log_prob);
  for (const auto& [metric, value] : evaluation.map_metrics) map.write_scalar(metric, value);
  if (evaluation.bands) write_bands(file, *evaluation.bands);
  if (evaluation.x) write_x(file, study, *evaluation.x);
}

Evaluation read_evaluation(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kEvaluationSchema);
  Evaluation evaluation;
  evaluation.theta = file.read_matrix<double>("theta");
  const Index n = evaluation.theta.rows();
  evaluation.log_prob = file.read_vector<double>("log_prob", n);
  if (file.has("nominal_log_prob")) {
    evaluation.nominal_log_prob = file.read_scalar<double>("nominal_log_prob");
  }
  if (file.has("truth_log_prob")) {
    evaluation.truth_log_prob = file.read_scalar<double>("truth_log_prob");
  }
  const h5::Group map = file.group("map");
  evaluation.map_theta = map.read_vector<double>("theta", evaluation.theta.cols());
  evaluation.map_log_prob = map.read_scalar<double>("log_prob");
  if (file.has("sampler")) evaluation.sampler = read_sampler(file.group("sampler"));
  if (file.has("reference")) read_references(file.group("reference"), evaluation);
  for (const std::string& metric : all_measured_names()) {
    if (!file.has(metric)) continue;
    evaluation.metrics[metric] = file.read_vector<double>(metric, n);
    evaluation.map_metrics[metric] = map.read_scalar<double>(metric);
  }
  if (file.has("bands")) evaluation.bands = read_bands(file.group("bands"));
  if (file.has("x")) evaluation.x = file.read_matrix<float>("x", n);
  return evaluation;
}

}  // namespace npdr::pipeline
