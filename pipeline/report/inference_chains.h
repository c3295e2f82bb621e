/// Parts of inference_data.h: the chains of a method, and the groups of a file.
#pragma once

#include <string>
#include <vector>

#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/plan/plan.h"
#include "pipeline/store/netcdf.h"

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

/// Dimensions of all that a draw has one of.
inline const std::vector<std::string> kOfDraws = {"chain", "draw"};

/// A group that says who made it.
NetcdfGroup make_group(h5::File& file, const std::string& name);
/// The same with dimensions for so many draws of each seed.
NetcdfGroup make_group(h5::File& file, const std::string& name, const std::vector<Index>& seeds,
                       Index num_draws);

/// The groups posterior_predictive, observed_data and constant_data.
void write_rollouts(const Plan& plan, const Chains& chains, h5::File& file, Index num_predictions);

}  // namespace npdr::pipeline
