/// Settings of an inference algorithm, as a study gives them.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"

namespace npdr::inference {

struct AlgorithmConfig {
  std::string name = "npe_c";  ///< a name of algorithm_names(), or an older spelling (snpe_c, apt)
  Index num_rounds = 1;
  Index num_simulations = 1000;  ///< per round
  Index num_atoms = 10;          ///< "npe_c": theta compared per x, the true one included
  std::string loss = "auto";     ///< "npe_c": "auto", "atomic" or "analytic" (mdn only)
  bool combined_loss = false;    ///< "npe_c": add -log q on the rows of the prior, when atomic
};

std::vector<std::string> algorithm_names();

/// The name of algorithm_names() that `spelling` stands for ("snpe_c" and "apt" are "npe_c");
/// throws InputError with the nearest known name.
std::string canonical_algorithm(const std::string& spelling);

}  // namespace npdr::inference
