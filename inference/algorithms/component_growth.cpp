#include "inference/algorithms/component_growth.h"

#include "inference/direct_posterior.h"
#include "inference/estimators/mixture_density_network.h"

namespace npdr::inference {

Parameters<float> grow_components(const NetworkParts& single, const EstimatorConfig& grown,
                                  double perturbation, const StreamId& id) {
  const TrainedEmbeddingConfig& embedding = std::get<DirectParts>(single.of_role).embedding;
  const auto network_of = [&](const EstimatorConfig& estimator) {
    return make_network(estimator, single.transform.num_outputs(), embedding,
                        single.prior.dimension(), single.structure_seed);
  };
  const EmbeddedEstimator<float> from = network_of(single.estimator), to = network_of(grown);
  const auto& mixture = dynamic_cast<const MixtureDensityNetwork<float>&>(to.estimator());
  Parameters<float> parameters = Parameters<float>::Zero(to.num_parameters());
  Stream stream(id);
  mixture.grow(dynamic_cast<const MixtureDensityNetwork<float>&>(from.estimator()),
               single.parameters, perturbation, parameters, stream);
  return parameters;
}

}  // namespace npdr::inference
