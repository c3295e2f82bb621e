// Refinement and least squares of recordings whose first states are as noisy as the others.

#include "inference/weighted_population.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/features/observation.h"
#include "pipeline/run/run_stage.h"
#include "sim/observation_noise.h"
#include "tests/pipeline/small_study.h"
#include "tests/pipeline/stages/run_until.h"
#include "tests/sim/library/compiled_library.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

constexpr double kLength = 0.9, kDamping = 0.3;

class FirstStates : public FolderTest {
 protected:
  Plan plan_of(const std::string& text) const {
    return make_plan(parse_study(text, (folder_ / "s.toml").string()),
                     WorkFolder(folder_ / "runs"));
  }

  // The rollouts of a truth with noise on all of their states, of so many amplitudes.
  void record(const std::string& truth, double noise, std::uint64_t seed) const {
    const Plan plan = plan_of(truth);
    run_until(plan, Stage::target);
    Target target = read_target(plan, plan.node(Stage::baseline, {}));
    const RowMatrix amplitude = sim::reference_amplitude(target);
    Stream stream({seed, "first_states_test", 0, 0, 0});
    for (Index h = 0; h < target.num_rollouts(); ++h) {
      for (auto state : target.rollouts[static_cast<std::size_t>(h)].states.rowwise()) {
        for (Index c = 0; c < state.size(); ++c) {
          state(c) += noise * amplitude(h, c) * stream.normal();
        }
      }
    }
    write_recording(target, folder_ / "recording.h5");
  }

  // Two rollouts of the pendulum.
  void record_pendulum() const {
    record(pendulum_study("truth")
               .with("target", {"truth = { pole_length = 0.9, damping = 0.3 }", "num_rollouts = 2"})
               .only("prior", {"pole_length = { uniform = [0.5, 1.5] }"})
               .method("ABC", {"algorithm = \"abc\"", "num_simulations = 500"}),
           0.02, 11);
  }

  Plan study_with(const std::string& noise, const std::vector<std::string>& method) const {
    return plan_of(
        pendulum_study("noisy")
            .only("target", {"recording = \"recording.h5\"", "num_rollouts = 2"})
            .with("simulator", {"store_every = 4", "segment_length = 200"})
            .only("prior",
                  {"pole_length = { uniform = [0.5, 1.5] }", "damping = { uniform = [0.0, 1.0] }"})
            .with("observation_noise", {noise})
            .method("Found", method)
            .with("evaluate", {"num_samples = 20", "metrics = [\"rmse\"]", "floor = false"}));
  }

  struct Found {
    Vector off;  // of the truth, in deviations
    double excess;
  };

  Found refine(const std::string& noise, const std::string& more) const {
    const Plan plan = study_with(
        noise,
        {"algorithm = \"refine\"", "refine = { level_size = 2000, min_ess = 1000" + more + " }"});
    return refine(plan, Vector{{kLength, kDamping}});
  }

  static Found refine(const Plan& plan, const Vector& truth) {
    const h5::File file = found_by(plan);
    EXPECT_EQ(inference::verdict(*read_part<inference::ImportanceCertificate>(file)), "holds");
    return {off(file, truth), read_part<sim::ErrorMemory>(file)->excess()};
  }

  static h5::File found_by(const Plan& plan) {
    run_until(plan, Stage::infer);
    return open_artefact(plan.node(Stage::infer, {"Found", 1, 1}), kPosteriorSchema);
  }

  // Of the mean from the truth, in deviations.
  static Vector off(const h5::File& file, const Vector& truth) {
    const auto posterior = read_particles(file);
    const RowMatrix theta = posterior->sample(2000, {1, "test", 0, 0, 0});
    const Vector mean = theta.colwise().mean();
    const Vector deviation =
        ((theta.rowwise() - mean.transpose()).array().square().colwise().sum() /
         static_cast<double>(theta.rows()))
            .sqrt();
    return (mean - truth).array() / deviation.array();
  }
};

// Both parameters are within four deviations: false alarms have a probability of 1e-4.
TEST_F(FirstStates, ThatAreInferredLeaveWhiteErrorsAndTheTruth) {
  record_pendulum();
  const std::string unknown = "scale_prior = [0.1, 1.0]";
  for (const std::string& noise :
       {std::string("scale = 0.02"), unknown, unknown + "\ncorrelation_prior = [0.5, 1.0]"}) {
    const Found found = refine(noise, ", infer_first_states = true");
    EXPECT_LT(found.off.cwiseAbs().maxCoeff(), 4.0) << noise << ": " << found.off.transpose();
    EXPECT_LT(found.excess, 1.6) << noise;
  }
  for (const std::string& noise : {std::string("scale = 0.02"), unknown}) {
    EXPECT_GT(refine(noise, "").excess, 2.0) << noise << ": errors of first states stay";
  }
  const Found beside_power = refine(unknown, ", infer_first_states = true, cross_validate = true");
  EXPECT_LT(beside_power.off.cwiseAbs().maxCoeff(), 4.0) << beside_power.off.transpose();
}

// False alarms as above.
TEST_F(FirstStates, AreFittedByLeastSquares) {
  record_pendulum();
  for (const std::string noise : {"scale = 0.02", "scale_prior = [0.1, 1.0]"}) {
    const h5::File file = found_by(study_with(noise, {"algorithm = \"least_squares\""}));
    const Vector found = off(file, Vector{{kLength, kDamping}});
    EXPECT_LT(found.cwiseAbs().maxCoeff(), 4.0) << noise << ": " << found.transpose();
    EXPECT_EQ(read_part<FittedStates>(file)->states.rows(), 2 * 2);
  }
}

// A mass that is let go at rest answers to a push otherwise than to a pull, by its dry friction:
// its recorded first velocity, which is one of them by chance, says the wrong of both to first
// order: eight deviations of friction here, were simulations to begin in it.
class AtRest : public FirstStates {
 protected:
  AtRest() {
    sim::compile_library(sim::spring_source(), folder_ / "spring.so");
    record(with_prior(
               StudyText("truth")
                   .with("target",
                         {"truth = { stiffness = 18.0, friction = 0.5 }", "num_rollouts = 4"})
                   .with("simulator", {kLibrary, "dt = 0.02", "num_steps = 100",
                                       "initial_states = [[0.3, 0.0], [-0.25, 0.0], [0.2, 0.0], "
                                       "[-0.35, 0.0]]"})
                   .method("ABC", {"algorithm = \"abc\"", "num_simulations = 500"})),
           0.3, 12);
  }

  static StudyText with_prior(StudyText study) {
    return study.with(
        "prior", {"stiffness = { uniform = [10.0, 30.0] }", "friction = { uniform = [0.0, 1.0] }"});
  }

  Plan study(const std::string& more) const {
    return plan_of(with_prior(
        StudyText("noisy")
            .with("target", {"recording = \"recording.h5\"", "num_rollouts = 4"})
            .with("simulator", {kLibrary})
            .with("observation_noise", {"scale_prior = [0.1, 1.0]"})
            .method("Found", {"algorithm = \"refine\"",
                              "refine = { level_size = 1000, min_ess = 500, infer_first_states = "
                              "true" +
                                  more + " }"})
            .with("evaluate", {"num_samples = 20", "metrics = [\"rmse\"]", "floor = false"})));
  }

  static constexpr const char* kLibrary = "library = \"spring.so\"";
};

TEST_F(AtRest, SimulationsBeginInTheLikeliestFirstStates) {
  const Plan plan = study("");
  const Found found = refine(plan, Vector{{18.0, 0.5}});
  EXPECT_LT(found.off.cwiseAbs().maxCoeff(), 4.0) << found.off.transpose();
  EXPECT_LT(found.excess, 1.6);
  const h5::File file = found_by(plan);
  EXPECT_GE(read_part<FirstStateMoves>(file)->count, 1);
  EXPECT_LE(read_part<inference::ImportanceCertificate>(file)->num_draws, 15'000);
}

TEST_F(AtRest, FirstStatesThatMayNotMoveAreToldWhereFirstOrderIsTooCoarse) {
  const Plan plan = study(", max_simulations = 5000");  // enough for the levels
  testing::internal::CaptureStderr();
  refine(plan, Vector{{18.0, 0.5}});
  EXPECT_TRUE(has(testing::internal::GetCapturedStderr(),
                  "to first order, which is too coarse for this motion: raise "
                  "refine.max_simulations, or cut shorter segments"));
  EXPECT_EQ(read_part<FirstStateMoves>(found_by(plan))->count, 0);
}

}  // namespace
}  // namespace npdr::pipeline
