/// A line for people about each name that studies choose from.
#pragma once

#include <string>

#include "inference/algorithms/algorithm_config.h"
#include "inference/embeddings/embedding_config.h"
#include "inference/estimators/estimator_config.h"
#include "inference/prior.h"
#include "pipeline/config/check.h"
#include "pipeline/config/metric.h"
#include "sim/integrator.h"

namespace npdr::pipeline {

std::string words_of(inference::Algorithm algorithm);
std::string words_of(inference::EmbeddingKind embedding);
std::string words_of(inference::EstimatorKind estimator);
std::string words_of(inference::Marginal::Kind prior);
std::string words_of(sim::Integrator integrator);
std::string words_of(Metric metric);
std::string words_of(Check check);

}  // namespace npdr::pipeline
