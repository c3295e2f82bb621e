/// The chains of a method, as other programs read them.
#pragma once

#include <string>
#include <vector>

#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// The last evaluations of a method, a chain a seed.
struct Chains {
  std::string method;
  std::vector<Index> seeds;
  std::vector<const Node*> nodes;
  std::vector<Evaluation> evaluations;

  Index num_draws() const { return evaluations.front().theta.rows(); }
};

/// Throws InputError for several methods and for what isn't made yet.
Chains find_chains(const Plan& plan);

}  // namespace npdr::pipeline
