#include "inference/network_posterior.h"

#include "inference/direct_posterior.h"
#include "inference/pooled_posterior.h"
#include "inference/surrogate_posterior.h"

namespace npdr::inference {

std::unique_ptr<NetworkPosterior> NetworkPosterior::given(const VectorF& x) const {
  NetworkParts parts = parts_;
  parts.x_o = x;
  return make_posterior(std::move(parts));
}

ParameterLayout network_layout(const NetworkParts& parts) {
  if (parts.role != NetworkRole::ratio) return make_network(parts).layout();
  return RatioEstimator<float>(parts.estimator, parts.prior.dimension(),
                               parts.transform.num_outputs())
      .layout();
}

std::unique_ptr<NetworkPosterior> make_posterior(NetworkParts parts) {
  if (parts.likelihood) return std::make_unique<PooledPosterior>(std::move(parts));
  if (parts.role == NetworkRole::posterior) {
    return std::make_unique<DirectPosterior>(std::move(parts));
  }
  return std::make_unique<SurrogatePosterior>(std::move(parts));
}

}  // namespace npdr::inference
