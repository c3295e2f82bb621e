#include "pipeline/sources/source.h"

#include "core/feature_names.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/config/rollout_check.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/config/source_check.h"
#include "pipeline/sources/built_in_source.h"
#include "pipeline/sources/command_source.h"
#include "pipeline/sources/dataset_source.h"

namespace npdr::pipeline {

Source::Source(Study study)
    : study_(std::move(study)), info_(simulator_info(study_)), parameters_(study_, info_) {}

std::unique_ptr<Source> make_source(const Study& study) {
  switch (study.source().kind) {
    case SourceKind::command:
      return std::make_unique<CommandSource>(study);
    case SourceKind::dataset:
      return std::make_unique<DatasetSource>(study);
    case SourceKind::built_in:
      break;
  }
  return std::make_unique<BuiltInSource>(study);
}

std::optional<Target> resolve_source(Study& study) {
  if (study.source().gives_motion) return std::nullopt;
  std::vector<Channel> features = parse_features(study.external.features);
  if (study.external.dataset) {
    const DatasetFile dataset = open_dataset(study);
    features = dataset.features();
    check_dataset_rows(study, dataset.num_rows());
  }
  std::optional<Target> x_o;
  if (study.target.observation) {
    x_o = read_observation(*study.target.observation, features);
    features = x_o->state_channels;
    check_recording(study, *x_o);
  }
  study.external.features = feature_names(features);
  return x_o;
}

}  // namespace npdr::pipeline
