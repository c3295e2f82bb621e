// Refinement through the stages, against a grid.

#include <algorithm>
#include <cmath>

#include "inference/weighted_population.h"
#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/features/observation.h"
#include "pipeline/findings/data.h"
#include "pipeline/predictions/left_out.h"
#include "pipeline/predictions/scores.h"
#include "pipeline/report/registry.h"
#include "pipeline/run/run_stage.h"
#include "sim/noise_likelihood.h"
#include "sim/observation_noise.h"
#include "tests/pipeline/small_study.h"
#include "tests/pipeline/stages/run_until.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kSampling = "level_size = 2000, min_ess = 1500";

std::string study_with(const std::string& noise) {
  return pendulum_study("refine")
      .with("target", {"truth = { pole_length = 0.9 }", "num_rollouts = 2"})
      .with("simulator", {"store_every = 40", "segment_length = 200"})
      .only("prior",
            {"pole_length = { uniform = [0.5, 1.5] }", "damping = { uniform = [0.0, 1.0] }"})
      .with("observation_noise", {noise})
      .method("ABC", {"algorithm = \"abc\"", "num_simulations = 500"})
      .method("Refined", {"algorithm = \"refine\"",
                          std::string("refine = { start = \"ABC\", ") + kSampling + " }"})
      .method("Prior", {"algorithm = \"refine\"", std::string("refine = { ") + kSampling + " }"})
      .with("evaluate", {"num_samples = 20", "metrics = [\"rmse\"]"});
}

TEST(WeightsAtPower, AreThoseOfTheLikelihoodsPower) {
  const Vector weights{{0.5, 0.25, 0.25}}, logs{{0.0, std::log(2.0), -HUGE_VAL}};
  const Vector found = weights_at_power(weights, 2.0 * logs, 0.5);
  EXPECT_NEAR(found(1) / found(0), 1.0, 1e-12);
  EXPECT_EQ(found(2), 0.0);
  const Vector even = Vector::Ones(100);
  Vector peaked = Vector::Zero(100);
  peaked(7) = 50.0;
  const Vector cut = weights_at_power(even, peaked, 1.0);
  EXPECT_NEAR(cut(7), std::exp(0.0) / 10.0, 1e-9) << "a tenth of the sum, which is its own";
}

class RefineStage : public FolderTest {
 protected:
  Plan plan_of(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    return make_plan(parse_study(text, "s.toml", overrides), WorkFolder(folder_ / "runs"));
  }
};

// The posterior's means over u and its log Z by the trapezoidal rule.
struct GridResult {
  Vector mean;
  double log_evidence;
};

constexpr Index kSide = 150;  // of a grid, in points

struct Box {
  Eigen::Array2d low, high;
};

// Log of prior and likelihood on a grid.
struct Grid {
  RowMatrix u;
  Vector log_density;
  double cell;
};

// Where a coarse grid isn't e^30 below its highest value, and its next points.
Box narrowed(const Box& box, const Grid& coarse) {
  const Eigen::Array2d step = (box.high - box.low) / static_cast<double>(kSide - 1);
  const double least = coarse.log_density.maxCoeff() - 30.0;
  Box result{box.high, box.low};
  for (Index i = 0; i < coarse.u.rows(); ++i) {
    if (coarse.log_density(i) < least) continue;
    const Eigen::Array2d u = coarse.u.row(i).transpose().array();
    result = {result.low.min(u - step), result.high.max(u + step)};
  }
  return result;
}

GridResult on_grid(const Plan& plan, const Node& node) {
  const Observation observation(plan.study, read_target(plan, node));
  const sim::NoiseLikelihood likelihood(observation.noise(), observation.states());
  const auto simulator =
      plan.source->open({.simulator = plan.study.simulator, .target = observation.target()});
  const inference::Prior prior(plan.study.prior);
  const auto likelihood_on = [&](const Box& box) {
    const Eigen::Array2d step = (box.high - box.low) / static_cast<double>(kSide - 1);
    Grid grid{RowMatrix(kSide * kSide, 2), Vector(kSide * kSide), step.prod()};
    for (Index i = 0; i < grid.u.rows(); ++i) {
      const Eigen::Array2d at(static_cast<double>(i / kSide), static_cast<double>(i % kSide));
      grid.u.row(i) = (box.low + step * at).matrix().transpose();
    }
    const sim::Trajectories rows =
        simulator->simulate(plan.source->parameters().complete(prior.to_theta(grid.u)), StreamId{});
    for (Index i = 0; i < grid.u.rows(); ++i) {
      grid.log_density(i) = likelihood.log_likelihood(rows.row(i)) -
                            0.5 * grid.u.row(i).squaredNorm() - std::log(2.0 * M_PI);
    }
    return grid;
  };
  Box box{{-6.0, -6.0}, {6.0, 6.0}};
  Grid grid = likelihood_on(box);
  for (int i = 0; i < 2; ++i) {
    box = narrowed(box, grid);
    grid = likelihood_on(box);
  }
  const double highest = grid.log_density.maxCoeff();
  const Vector weights = (grid.log_density.array() - highest).exp();
  return {inference::weighted_mean(grid.u, weights), highest + std::log(weights.sum() * grid.cell)};
}

TEST_F(RefineStage, AgreesWithAGridFromAnyStart) {
  for (const char* noise :
       {"scale = 0.2", "scale_prior = [0.2, 1.0]\ncorrelation_prior = [0.5, 1.0]"}) {
    const Plan plan = plan_of(study_with(noise));
    run_until(plan, Stage::infer);
    const GridResult expected = on_grid(plan, plan.node(Stage::infer, {"Prior", 1, 1}));
    for (const char* method : {"Refined", "Prior"}) {
      const Node& node = plan.node(Stage::infer, {method, 1, 1});
      const h5::File file = open_artefact(node, kPosteriorSchema);
      const auto certificate = read_part<inference::ImportanceCertificate>(file);
      ASSERT_TRUE(certificate.has_value());
      // Four standard errors, and what the grid leaves.
      EXPECT_NEAR(certificate->log_evidence, expected.log_evidence,
                  4.0 * certificate->log_evidence_error + 0.005)
          << noise << method;
      EXPECT_LT(certificate->log_evidence_error, 0.05);
      EXPECT_GE(certificate->ess, 1500.0);
      const auto posterior = read_particles(file);
      const RowMatrix u = posterior->prior().to_normal(posterior->parts().theta);
      const Vector& weights = posterior->parts().weights;
      const Vector mean = inference::weighted_mean(u, weights);
      const Eigen::MatrixXd covariance = inference::weighted_covariance(u, weights);
      for (Index d = 0; d < 2; ++d) {
        EXPECT_NEAR(mean(d), expected.mean(d),
                    4.0 * std::sqrt(covariance(d, d) / inference::effective_size(weights)))
            << noise << method;
      }
    }
  }
}

// The posterior is narrow, so predictions with noise are draws of N(x, 0.2^2) at the truth x: the
// CRPS is 0.2 / sqrt(pi) = 0.113 and the log score -log(0.2 sqrt(2 pi e)) = 0.190. There are 40
// errors: standard errors of 0.009 and 0.11, tolerances of four.
TEST_F(RefineStage, PredictionsAreScoredWithNoise) {
  const Plan plan = plan_of(study_with("scale = 0.2"), {"evaluate.num_samples=200"});
  run_until(plan, Stage::evaluate);
  const Node& node = plan.node(Stage::evaluate, {"Prior", 1, 1});
  const Evaluation evaluation = kEvaluationSchema.read({node.path, node.key});
  ASSERT_TRUE(evaluation.scores.seen.has_value());
  EXPECT_NEAR(evaluation.scores.seen->noisy_crps.mean(), 0.113, 0.04);
  EXPECT_NEAR(evaluation.scores.seen->log_score.mean(), 0.190, 0.45);
  EXPECT_LT(evaluation.scores.seen->crps.mean(), 0.04) << "of states that aren't noisy";
  EXPECT_EQ(evaluation.scores.seen->num_compared, evaluation.theta.rows());
  // A number of its own, uniform over runs: beyond these either way by chance in one of 100.
  EXPECT_GT(evaluation.scores.seen->share_as_seldom_within, 0.005);
  EXPECT_LT(evaluation.scores.seen->share_as_seldom_within, 0.995);
  EXPECT_FALSE(evaluation.noise.has_value()) << "it is given";
}

// Root mean square of a channel's errors at the truth, over its largest recorded magnitude.
double error_at_truth(const Plan& plan, Index channel) {
  const Judge judge(plan, plan.node(Stage::evaluate, {"Prior", 1, 1}));
  const Target& target = judge.seen().target();
  const Vector truth = plan.source->parameters().nominal(*plan.study.target.truth);
  const sim::Trajectories exact = judge.seen().simulate(truth.transpose(), {});
  const std::vector<float> recorded = judge.seen().observation().states();
  const RowMatrix amplitude = sim::reference_amplitude(target);
  const Index every = plan.study.simulator.store_every, steps = target.num_steps() / every;
  double sum = 0.0;
  for (Index h = 0; h < target.num_rollouts(); ++h) {
    for (Index k = 0; k < steps; ++k) {
      const auto at = static_cast<std::size_t>((h * steps + k) * target.num_states() + channel);
      const double error = recorded[at] - exact.rollout(0, h)((k + 1) * every - 1, channel);
      sum += std::pow(error / amplitude(h, channel), 2);
    }
  }
  return std::sqrt(sum / static_cast<double>(target.num_rollouts() * steps));
}

// The posterior of a scale from 20 errors is 16 % wide, and its median a few percent off their root
// mean square; the median of 20 samples has a standard error of 16 % * 1.25 / sqrt(20) = 4.5 %.
// Four of these and 7 %.
TEST_F(RefineStage, NoiseThatIsInferredIsInTheReport) {
  const Plan plan = plan_of(study_with("scale_prior = [0.2, 1.0]"));
  run_until(plan, Stage::evaluate);
  const ReportData data = read_report_data(plan, plan.nodes.back());
  const analysis::Table table = noise_table(data).value();
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].label, "scale of theta");
  EXPECT_EQ(table.rows[1].label, "scale of theta_dot");
  for (Index c = 0; c < 2; ++c) {
    const std::vector<analysis::Cell>& cells = table.rows[static_cast<std::size_t>(c)].cells;
    EXPECT_EQ(std::get<std::string>(cells[0].value), "0.2 (0.0736 to 0.544)");
    const double expected = error_at_truth(plan, c);
    for (const std::size_t method : {2u, 3u}) {
      const double median = std::stod(std::get<std::string>(cells[method].value));
      EXPECT_NEAR(median, expected, 0.25 * expected);
    }
  }
}

double mean_scale(const NoiseOfSamples& noise) {
  double sum = 0.0;
  for (const auto& channels : noise) sum += channels.front().scale;
  return sum / static_cast<double>(noise.size());
}

// Samples of the prior are at power 0 and off by far more than the noise, whose scale the best of
// them show: 20 errors of a channel tell it to 16 % (standard deviation), for both in the same way.
TEST_F(RefineStage, WhatSamplesOfALowPowerAreOffByIsntNoise) {
  const Plan plan = plan_of(study_with("scale_prior = [0.1, 0.3]"));
  run_until(plan, Stage::held_out);
  const Judge judge(plan, plan.node(Stage::evaluate, {"Prior", 1, 1}));
  const auto scale_of = [&](const RowMatrix& complete, double power) {
    const sim::Trajectories seen = judge.seen().simulate(complete, {});
    return mean_scale(
        draw_noise(judge.seen().observation(), seen, {.power = power}, {1, "test", 0, 0, 0}));
  };
  const ParameterMap& parameters = plan.source->parameters();
  sim::Trajectories failed = judge.seen().simulate(parameters.complete(RowMatrix::Ones(2, 2)), {});
  failed.status[1] = sim::RolloutStatus::diverged;
  for (const auto& channels :
       draw_noise(judge.seen().observation(), failed, {}, {1, "test", 0, 0, 0})) {
    EXPECT_EQ(channels.size(), 2u) << "also of a sample that failed: other rollouts may not have";
  }
  const Vector truth = parameters.nominal(*plan.study.target.truth);
  const RowMatrix draws = parameters.complete(
      inference::sample_prior(inference::Prior(plan.study.prior), 2000, std::uint64_t{1}));
  const double scale = scale_of(truth.transpose().replicate(200, 1), 1.0);
  EXPECT_NEAR(scale_of(draws, 0.0), scale, 0.2 * scale);
  EXPECT_GT(scale_of(draws, 1.0), 2.0 * scale);
}

TEST_F(RefineStage, TakesThePowerThatPredictsLeftOutRolloutsBest) {
  const std::string text =
      pendulum_study("refine")
          .with("target", {"truth = { pole_length = 0.9 }", "num_rollouts = 3"})
          .with("simulator", {"store_every = 40", "segment_length = 200"})
          .only("prior", {"pole_length = { uniform = [0.5, 1.5] }"})
          .with("observation_noise", {"scale = 0.2"})
          .method("CV", {"algorithm = \"refine\"",
                         "refine = { level_size = 1000, min_ess = 300, "
                         "cross_validate = true }"})
          .with("evaluate", {"num_samples = 20", "metrics = [\"rmse\"]", "floor = false"});
  const Plan plan = plan_of(text);
  run_until(plan, Stage::evaluate);
  const h5::File file = open_artefact(plan.node(Stage::infer, {"CV", 1, 1}), kPosteriorSchema);
  const auto power = file.dataset("power_scores/power").read<double>();
  const RowMatrix crps = file.read_matrix<double>("power_scores/crps");
  ASSERT_GE(power.size(), 2u);
  EXPECT_TRUE(std::ranges::is_sorted(power));
  const auto chosen =
      std::ranges::find(power, read_part<inference::ImportanceCertificate>(file)->power) -
      power.begin();
  ASSERT_LT(chosen, std::ssize(power));
  // Noise of 0.2 that nothing predicts has the CRPS 0.2 / sqrt(pi) = 0.113; 3 x 2 x 10 errors leave
  // it to 9 % (standard error), and parameters that are unsure add some.
  EXPECT_NEAR(crps.row(chosen).mean(), 0.113, 0.04);
  const ReportData data = read_report_data(plan, plan.nodes.back());
  const std::string caption = power_figure(data)->caption;
  EXPECT_TRUE(has(caption, fmt::format("as good as any: {:.3g} (CV{}).", power[chosen],
                                       chosen == 0 ? ", none smaller was tried" : "")));
}

// A rod of some grams and centimeters: the integration diverges in some rows, which says that the
// parameters are impossible, however many they are.
TEST_F(RefineStage, SimulationsThatFailAreCounted) {
  const Plan plan = plan_of(pendulum_study("refine")
                                .with("target", {"truth = { pole_length = 0.09 }"})
                                .with("simulator", {"store_every = 40", "segment_length = 200",
                                                    "parameters = { pole_mass = 0.02 }"})
                                .only("prior", {"pole_length = { uniform = [0.01, 0.1] }"})
                                .with("observation_noise", {"scale = 0.2"})
                                .with("limits", {"max_failed_fraction = 0"})
                                .method("Prior", {"algorithm = \"refine\"",
                                                  "refine = { level_size = 1000, min_ess = 300 }"})
                                .with("evaluate", {"num_samples = 20", "metrics = [\"rmse\"]"}));
  run_until(plan, Stage::report);
  const std::string report = text_of(folder_ / "runs/refine/report.html");
  EXPECT_TRUE(has(report, "count as impossible parameters"));
}

}  // namespace
}  // namespace npdr::pipeline
