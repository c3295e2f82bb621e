#include "inference/network_posterior.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "inference/direct_posterior.h"
#include "inference/surrogate_posterior.h"

namespace npdr::inference {

std::vector<std::string> network_role_names() { return {"posterior", "likelihood", "ratio"}; }

std::string to_string(NetworkRole role) {
  return network_role_names()[static_cast<std::size_t>(role)];
}

NetworkRole network_role(const std::string& name) {
  const std::vector<std::string> names = network_role_names();
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw InputError(unknown_name("network role", name, names));
  return static_cast<NetworkRole>(found - names.begin());
}

std::vector<std::string> sampler_names() { return {"slice", "importance"}; }

std::unique_ptr<NetworkPosterior> NetworkPosterior::given(const VectorF& x) const {
  NetworkParts parts = parts_;
  parts.x_o = x;
  return make_posterior(std::move(parts));
}

std::unique_ptr<NetworkPosterior> make_posterior(NetworkParts parts) {
  if (parts.role == NetworkRole::posterior) {
    return std::make_unique<DirectPosterior>(std::move(parts));
  }
  return std::make_unique<SurrogatePosterior>(std::move(parts));
}

}  // namespace npdr::inference
