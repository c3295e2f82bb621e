#include "pipeline/apps/name_words.h"

namespace npdr::pipeline {

// No default in any switch: the compiler tells what lacks its line.

std::string words_of(inference::Algorithm algorithm) {
  using enum inference::Algorithm;
  switch (algorithm) {
    case npe_nle:
      return "networks learn the posterior and the likelihood, pooled by what predicts best; the "
             "usual choice; later rounds simulate the prior where the posterior is";
    case npe_a:
      return "a mixture learns the posterior; later rounds are divided by their proposal";
    case npe_b:
      return "a network learns the posterior; later rounds weight simulations by prior / proposal";
    case npe_c:
      return "a network learns the posterior; later rounds simulate draws of the posterior";
    case nle:
      return "a network learns the likelihood, which a sampler makes a posterior of";
    case nre_a:
      return "a classifier learns likelihood / evidence: pairs that belong together or don't";
    case nre_b:
      return "the same, of one pair among several";
    case abc_rejection:
      return "simulations of the prior whose distance to the observation is small";
    case abc_mcmc:
      return "the same by Markov chains";
    case abc_smc:
      return "the same by populations that come nearer from round to round";
    case linear_regression:
      return "the equations of motion as a Bayesian regression on the recording, no simulation";
    case refine:
      return "the posterior under the noise's likelihood, from another method's, with its evidence";
    case prior:
      return "infers nothing: domain randomization over the prior";
    case nominal:
      return "infers nothing: the nominal parameters";
  }
  return "";
}

std::string words_of(inference::EmbeddingKind embedding) {
  using enum inference::EmbeddingKind;
  switch (embedding) {
    case convolution:
      return "the states of all kept steps through convolutions that are trained with the network";
    case linear:
      return "the states of all kept steps through a layer that is trained with the network";
    case all_steps:
      return "the states of all kept steps";
    case delta_steps:
      return "their differences from step to step";
    case last_step:
      return "the last states alone";
    case bayessim:
      return "sums over each series: short, and blind to much of it";
    case identity:
      return "the features as the simulator gives them";
  }
  return "";
}

std::string words_of(inference::EstimatorKind estimator) {
  using enum inference::EstimatorKind;
  switch (estimator) {
    case maf:
      return "masked autoregressive flow: any shape with one bulge or a few";
    case mdn:
      return "mixture of Gaussians: quick, for a few modes";
    case nsf:
      return "neural spline flow: sharp and bent shapes, slower";
    case resnet:
      return "residual network, for ratios alone (nre_a, nre_b)";
  }
  return "";
}

std::string words_of(inference::Marginal::Kind prior) {
  using enum inference::Marginal::Kind;
  switch (prior) {
    case uniform:
      return "[low, high]: every value between is as likely";
    case log_uniform:
      return "[low, high] with low > 0: every order of magnitude is as likely";
    case normal:
      return "[mean, standard deviation], without bounds";
    case log_normal:
      return "[mean of log, standard deviation of log]: positive, without an upper bound";
  }
  return "";
}

std::string words_of(sim::Integrator integrator) {
  using enum sim::Integrator;
  switch (integrator) {
    case erk4:
      return "Runge-Kutta of order 4 with fixed steps";
    case erk2:
      return "of order 2";
    case erk5:
      return "of order 5";
    case cvode:
      return "steps and orders that adapt to tolerances, for stiff systems";
  }
  return "";
}

std::string words_of(Metric metric) {
  switch (metric) {
    case Metric::dtw:
      return "distance of trajectories that may be shifted in time (dynamic time warping)";
    case Metric::rmse:
      return "root mean square error of the states, over their largest recorded magnitude";
    case Metric::final_error:
      return "distance of the last states, where all have one unit";
    case Metric::goal:
      return "share of the rollouts that end at the simulator's goal";
    case Metric::distance:
      return "of features, in standard deviations over the prior";
  }
  return "";
}

std::string words_of(Check check) { return std::string(traits_of(check).question); }

}  // namespace npdr::pipeline
