// Infers mass and length of a simulated pendulum from one noisy rollout of it.
#include <cstdio>

#include "analysis/summary.h"
#include "inference/in_memory.h"
#include "sim/observation_noise.h"
#include "sim/simulator.h"

int main() {
  using namespace npdr;
  const auto pendulum = sim::make_simulator({.name = "pendulum", .store_every = 20});
  const auto theta_of = [&](double mass, double length) {
    return sim::complete_theta(*pendulum, {{"pole_mass", mass}, {"pole_length", length}});
  };
  const Target target = pendulum->behave(theta_of(1.2, 0.8), 1, /*seed=*/1);
  const RowMatrix amplitude = sim::reference_amplitude(target);

  // x ~ p(x | theta): every 20th state, with noise of 2 % of each channel's largest value.
  const auto simulate = [&](const Vector& theta, Stream& noise) -> VectorF {
    auto rows = pendulum->replay(target, theta_of(theta(0), theta(1)).transpose());
    sim::add_observation_noise(rows.row(0), 0.02 * amplitude, noise);
    return Eigen::Map<const VectorF>(rows.values.data(), rows.row_size());
  };
  Stream noise({.seed = 1, .name = "observation"});
  const VectorF x_o = simulate(Eigen::Vector2d(1.2, 0.8), noise);

  const auto uniform = inference::Marginal::Kind::uniform;
  const inference::Prior prior(
      {{"pole_mass", "kg", uniform, 0.3, 1.7}, {"pole_length", "m", uniform, 0.3, 1.7}});
  inference::PosteriorEstimationConfig config;  // NPE-C with a neural spline flow
  config.algorithm.num_simulations = 2000;
  config.principal_components = 20;
  const auto posterior = inference::infer(config, prior, simulate, x_o, /*seed=*/1);
  const RowMatrix theta = posterior->sample(1000, {.seed = 1, .name = "posterior"});
  for (Index d = 0; d < prior.dimension(); ++d) {
    const analysis::Summary summary = analysis::summarize(theta.col(d));
    std::printf("%s: %.3f +- %.3f\n", prior.marginals()[d].name.c_str(), summary.mean, summary.std);
  }
}
