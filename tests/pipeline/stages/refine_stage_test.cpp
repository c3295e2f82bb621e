// Refinement through the stages, against a grid.
#include <gtest/gtest.h>

#include <cmath>

#include "inference/weighted_moments.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/features/noise.h"
#include "pipeline/features/simulation_features.h"
#include "pipeline/features/targets.h"
#include "pipeline/report/data.h"
#include "pipeline/report/registry.h"
#include "pipeline/run/run_stage.h"
#include "sim/noise_likelihood.h"
#include "tests/pipeline/small_study.h"
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

class RefineStage : public ::testing::Test {
 protected:
  Plan plan_of(const std::string& text, const std::string& work = "runs") const {
    return make_plan(parse_study(text, "s.toml"), WorkFolder(folder_.path() / work));
  }
  static void run_until(const Plan& plan, Stage last) {
    for (const Node& node : plan.nodes) {
      if (node.stage <= last) run_stage(plan, node);
    }
  }

  TempFolder folder_;
};

// The posterior's means over u and its log Z by the trapezoidal rule: beyond 5 deviations of the
// prior there is nothing.
struct GridResult {
  Vector mean;
  double log_evidence;
};

GridResult on_grid(const Plan& plan, const Node& node) {
  constexpr Index side = 400;
  constexpr double most = 5.0, step = 2.0 * most / (side - 1);
  const Target target = read_target(plan, node);
  const sim::NoiseLikelihood likelihood(noise_model(plan.study, target),
                                        stored_observation(plan, target));
  RowMatrix u(side * side, 2);
  for (Index i = 0; i < u.rows(); ++i) {
    const double first = static_cast<double>(i / side), second = static_cast<double>(i % side);
    u.row(i) << step * first - most, step * second - most;
  }
  const inference::Prior prior(plan.study.prior);
  const auto simulator = plan.source->open({.simulator = plan.study.simulator, .target = target});
  const sim::Trajectories rows =
      simulator->simulate(plan.source->parameters().complete(prior.to_theta(u)), {});
  Vector logs(u.rows());
  for (Index i = 0; i < u.rows(); ++i) {
    logs(i) = likelihood.log_likelihood(rows.row(i)) - 0.5 * u.row(i).squaredNorm() -
              std::log(2.0 * M_PI);
  }
  const Vector weights = (logs.array() - logs.maxCoeff()).exp();
  return {inference::weighted_mean(u, weights),
          logs.maxCoeff() + std::log(weights.sum() * step * step)};
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
      const auto certificate = read_certificate(file);
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

TEST_F(RefineStage, IsShownWithItsCertificate) {
  const Plan plan = plan_of(study_with("scale = 0.2"));
  for (const Node& node : plan.nodes) {
    if (node.stage != Stage::report) run_stage(plan, node);
  }
  const ReportData data = read_report_data(plan, plan.nodes.back());
  const TableEntry entry = refinement_table();
  ASSERT_TRUE(entry.exists(data));
  const analysis::Table table = entry.make(data);
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(std::get<std::string>(table.rows.front().cells.back().value), "holds");
}

TEST_F(RefineStage, KeysDependOnWhatThePosteriorDoes) {
  const std::string text = study_with("scale = 0.2");
  const auto key = [&](const std::vector<std::string>& overrides) {
    return make_plan(parse_study(text, "s.toml", overrides), WorkFolder(folder_.path()))
        .node(Stage::infer, {"Refined", 1, 1})
        .key;
  };
  const std::string before = key({});
  EXPECT_NE(key({"observation_noise.scale=0.3"}), before);
  EXPECT_NE(key({"observation_noise.degrees_of_freedom=4"}), before);
  EXPECT_NE(key({"method.refine.likelihood_power=0.5"}), before);
  EXPECT_NE(key({"method.num_simulations=600"}), before) << "of the method that it starts from";
  EXPECT_EQ(key({"observation_noise.redraw=false"}), before) << "there are no epochs";
}

}  // namespace
}  // namespace npdr::pipeline
