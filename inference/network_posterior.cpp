#include "inference/network_posterior.h"

#include "inference/direct_posterior.h"
#include "inference/pooled_posterior.h"
#include "inference/surrogate_posterior.h"

namespace npdr::inference {

RoleParts role_parts(NetworkRole role) {
  if (role == NetworkRole::posterior) return DirectParts{};
  return SurrogateParts{.is_ratio = role == NetworkRole::ratio};
}

NetworkRole NetworkParts::role() const {
  const auto* const surrogate = std::get_if<SurrogateParts>(&of_role);
  if (surrogate == nullptr) return NetworkRole::posterior;
  return surrogate->is_ratio ? NetworkRole::ratio : NetworkRole::likelihood;
}

const PooledLikelihood* NetworkParts::pooled_likelihood() const {
  const auto* const direct = std::get_if<DirectParts>(&of_role);
  return direct != nullptr && direct->likelihood ? &*direct->likelihood : nullptr;
}

std::unique_ptr<NetworkPosterior> NetworkPosterior::given(const VectorF& x) const {
  NetworkParts parts = parts_;
  parts.x_o = x;
  return make_posterior(std::move(parts));
}

ParameterLayout network_layout(const NetworkParts& parts) {
  if (parts.role() != NetworkRole::ratio) return make_network(parts).layout();
  return RatioEstimator<float>(parts.estimator, parts.prior.dimension(),
                               parts.transform.num_outputs())
      .layout();
}

std::unique_ptr<NetworkPosterior> make_posterior(NetworkParts parts) {
  if (parts.pooled_likelihood() != nullptr) {
    return std::make_unique<PooledPosterior>(std::move(parts));
  }
  if (parts.role() == NetworkRole::posterior) {
    return std::make_unique<DirectPosterior>(std::move(parts));
  }
  return std::make_unique<SurrogatePosterior>(std::move(parts));
}

}  // namespace npdr::inference
