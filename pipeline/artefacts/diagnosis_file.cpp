#include "pipeline/artefacts/diagnosis_file.h"

#include <functional>

#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/theta_columns.h"

namespace npdr::pipeline {
namespace {

using inference::Distance;
using inference::OutOfDistribution;

template <class Tests, class Value>
Vector each(const Tests& tests, const Value& value) {
  Vector values(static_cast<Index>(tests.size()));
  for (Index i = 0; i < values.size(); ++i) {
    values(i) = std::invoke(value, tests[static_cast<std::size_t>(i)]);
  }
  return values;
}

void write_sbc(h5::Group group, const std::vector<inference::Marginal>& prior,
               const SbcResult& sbc) {
  h5::Dataset ranks = group.write("rank", sbc.ranks);
  describe_theta(ranks, prior);
  h5::Dataset levels = group.write("level", sbc.levels);
  describe_theta(levels, prior);
  group.write("kolmogorov_smirnov",
              each(sbc.test.kolmogorov_smirnov, &inference::KolmogorovSmirnov::statistic));
  group.write("chi_square", each(sbc.test.chi_square, &inference::ChiSquare::statistic));
  group.write("p_value", sbc.test.parameter_p_value).label_dimensions({"parameter"});
  group.set_attribute("p_value", sbc.test.p_value);
}

SbcResult read_sbc(const h5::Group& group) {
  SbcResult sbc;
  sbc.levels = group.read_matrix<double>("level", -1, -1, h5::Values::finite);
  sbc.ranks = group.read_matrix<std::int64_t>("rank", sbc.levels.rows(), sbc.levels.cols());
  sbc.test = inference::test_sbc(sbc.levels);
  return sbc;
}

void write_coverage(h5::Group group, const CoverageResult& result) {
  const inference::Coverage& coverage = result.coverage;
  group.write("rank", result.ranks).label_dimensions({"row"});
  group.write("level", result.levels).label_dimensions({"row"});
  RowMatrix curve(coverage.level.size(), 2);
  curve << coverage.level, coverage.coverage;
  group.write("curve", curve);
  group.set_attribute("area", coverage.area);
  group.set_attribute("kolmogorov_smirnov", coverage.kolmogorov_smirnov.statistic);
  group.set_attribute("p_value", coverage.kolmogorov_smirnov.p_value);
}

CoverageResult read_coverage(const h5::Group& group) {
  CoverageResult result;
  result.levels = group.read_vector<double>("level", -1, h5::Values::finite);
  result.ranks = group.read_vector<std::int64_t>("rank", result.levels.size());
  result.coverage = inference::measure_coverage(result.levels);
  return result;
}

void write_distance(h5::Group group, const Distance& distance) {
  group.set_attribute("observed", distance.observed);
  group.set_attribute("median", distance.median);
  group.set_attribute("p_value", distance.p_value);
}

Distance read_distance(const h5::Group& group) {
  return {group.attribute<double>("observed"), group.attribute<double>("median"),
          group.attribute<double>("p_value")};
}

void write_ood(h5::Group& group, const OutOfDistribution& ood) {
  write_distance(group.create_group("mahalanobis"), ood.mahalanobis);
  write_distance(group.create_group("residual"), ood.residual);
  write_distance(group.create_group("nearest"), ood.nearest);
  group.set_attribute("num_components", ood.num_components);
  group.set_attribute("num_reference", ood.num_reference);
}

OutOfDistribution read_ood(const h5::Group& group, const std::string& p_value) {
  return {group.attribute<Index>("num_components"),  group.attribute<Index>("num_reference"),
          read_distance(group.group("mahalanobis")), read_distance(group.group("residual")),
          read_distance(group.group("nearest")),     group.attribute<double>(p_value)};
}

void write_predictive(h5::Group group, const PredictiveResult& result) {
  group.write_texts("name", result.names);
  group.write("observed", result.observed);
  group.write("median", result.median);
  group.write("p_value", result.check.summary_p_value);
  write_ood(group, result.check.overall);
  group.set_attribute("overall_p_value", result.check.overall.p_value);
  group.set_attribute("num_failed", result.num_failed);
  group.set_attribute("p_value", result.check.p_value);
}

PredictiveResult read_predictive(const h5::Group& group) {
  PredictiveResult result;
  result.names = group.read_texts("name");
  const auto count = static_cast<Index>(result.names.size());
  result.observed = group.read_vector<double>("observed", count);
  result.median = group.read_vector<double>("median", count);
  result.num_failed = group.attribute<Index>("num_failed");
  result.check.summary_p_value = group.read_vector<double>("p_value", count);
  result.check.overall = read_ood(group, "overall_p_value");
  result.check.p_value = group.attribute<double>("p_value");
  return result;
}

void write_training(h5::Group group, const inference::TrainingCheck& check, Index max_epochs) {
  group.set_attribute("num_epochs", check.num_epochs);
  group.set_attribute("best_epoch", check.best_epoch);
  group.set_attribute("max_epochs", max_epochs);
  group.set_attribute("is_converged", Index{check.is_converged});
  group.set_attribute("validation_loss", check.validation_loss);
  group.set_attribute("generalisation_gap", check.generalization_gap);
}

inference::TrainingCheck read_training(const h5::Group& group) {
  return {group.attribute<Index>("num_epochs"), group.attribute<Index>("best_epoch"),
          group.attribute<Index>("is_converged") != 0, group.attribute<double>("validation_loss"),
          group.attribute<double>("generalisation_gap")};
}

void write_local_c2st(h5::Group group, const inference::LocalC2st& test) {
  group.write("null", test.null).label_dimensions({"trial"});
  group.set_attribute("statistic", test.statistic);
  group.set_attribute("p_value", test.p_value);
}

inference::LocalC2st read_local_c2st(const h5::Group& group) {
  return {group.attribute<double>("statistic"), group.read_vector<double>("null"),
          group.attribute<double>("p_value")};
}

}  // namespace

std::map<std::string, double> Diagnosis::p_values() const {
  std::map<std::string, double> values;
  if (sbc) values["sbc"] = sbc->test.p_value;
  if (coverage) values["coverage"] = coverage->coverage.kolmogorov_smirnov.p_value;
  if (tarp) values["tarp"] = tarp->coverage.kolmogorov_smirnov.p_value;
  if (local_c2st) values["local_c2st"] = local_c2st->p_value;
  if (predictive) values["predictive"] = predictive->check.p_value;
  if (ood) values["ood"] = ood->p_value;
  return values;
}

void write_diagnosis(h5::File& file, const std::vector<inference::Marginal>& prior,
                     const Diagnosis& diagnosis) {
  file.set_attribute("num_samples", diagnosis.num_samples);
  file.set_attribute("num_simulations", diagnosis.num_simulations);
  file.set_attribute("num_failed", diagnosis.num_failed);
  if (diagnosis.sbc) write_sbc(file.create_group("sbc"), prior, *diagnosis.sbc);
  if (diagnosis.coverage) write_coverage(file.create_group("coverage"), *diagnosis.coverage);
  if (diagnosis.tarp) write_coverage(file.create_group("tarp"), *diagnosis.tarp);
  if (diagnosis.local_c2st) {
    write_local_c2st(file.create_group("local_c2st"), *diagnosis.local_c2st);
  }
  if (diagnosis.predictive) {
    write_predictive(file.create_group("predictive"), *diagnosis.predictive);
  }
  if (diagnosis.ood) {
    h5::Group group = file.create_group("ood");
    write_ood(group, *diagnosis.ood);
    group.set_attribute("p_value", diagnosis.ood->p_value);
  }
  if (diagnosis.training) {
    write_training(file.create_group("training"), *diagnosis.training, diagnosis.max_epochs);
  }
}

Diagnosis read_diagnosis(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kDiagnosisSchema);
  Diagnosis diagnosis;
  diagnosis.num_samples = file.attribute<Index>("num_samples");
  diagnosis.num_simulations = file.attribute<Index>("num_simulations");
  diagnosis.num_failed = file.attribute<Index>("num_failed");
  if (file.has("sbc")) diagnosis.sbc = read_sbc(file.group("sbc"));
  if (file.has("coverage")) diagnosis.coverage = read_coverage(file.group("coverage"));
  if (file.has("tarp")) diagnosis.tarp = read_coverage(file.group("tarp"));
  if (file.has("local_c2st")) diagnosis.local_c2st = read_local_c2st(file.group("local_c2st"));
  if (file.has("predictive")) diagnosis.predictive = read_predictive(file.group("predictive"));
  if (file.has("ood")) diagnosis.ood = read_ood(file.group("ood"), "p_value");
  if (file.has("training")) diagnosis.training = read_training(file.group("training"));
  return diagnosis;
}

}  // namespace npdr::pipeline
