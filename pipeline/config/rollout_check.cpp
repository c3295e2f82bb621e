#include "pipeline/config/study_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "core/error.h"
#include "pipeline/config/checker.h"
#include "pipeline/config/simulator_info.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

class RolloutChecker : Checker {
 public:
  RolloutChecker(const Study& study, const RolloutShape& shape, Reading& reading)
      : Checker(study, nullptr, reading), shape_(shape), num_recorded_(shape.num_rollouts) {
    if (study.target.recording && !study.target.rollouts.empty())
      shape_.num_rollouts = std::ssize(study.target.rollouts);
  }

  void check() {
    if (!study_.source().gives_motion) {
      for (std::size_t i = 0; i < study_.methods.size(); ++i) {
        for (const std::string& channel : study_.methods[i].embedding.channels) {
          require_known(method_path(i) + ".embedding.channels", "method.embedding.channels",
                        "feature", channel, labels_of(shape_.state_channels));
        }
        check_shape(method_path(i) + ".embedding.shape", study_.methods[i].embedding);
      }
      return;
    }
    if (study_.target.recording && shape_.num_steps == 1 && reading_.good("target.recording")) {
      return reading_.reject("target.recording", "one of a single step",
                             "a recording of 2 steps or more");
    }
    for (const std::uint64_t rollout : study_.target.rollouts) {
      if (study_.target.truth) break;
      check_at_most("target.rollouts", static_cast<Index>(rollout), num_recorded_,
                    "what the recording holds");
    }
    if (check_at_most("target.num_rollouts", study_.target.num_rollouts, shape_.num_rollouts,
                      "what the recording holds")) {
      check_at_most("target.held_out", study_.target.held_out,
                    shape_.num_rollouts - study_.target.num_rollouts,
                    "what the recording holds after target.num_rollouts");
    }
    const bool any_infers = std::ranges::any_of(study_.methods, sees_stored_states);
    check_at_most("simulator.store_every", study_.simulator.store_every,
                  any_infers ? shape_.num_steps / 2 : shape_.num_steps,
                  any_infers ? two_states_left() : "the steps of a rollout");
    check_at_most("evaluate.leave_out", study_.evaluate.leave_out, used_rollouts(),
                  "the rollouts that inference sees");
    for (std::size_t i = 0; i < study_.methods.size(); ++i) {
      check_method(method_path(i), study_.methods[i]);
    }
  }

 private:
  void check_shape(const std::string& path, const inference::EmbeddingConfig& embedding) {
    if (embedding.shape.empty()) return;
    const auto num_features =
        static_cast<std::uint64_t>(embedding.channels.empty() ? std::ssize(shape_.state_channels)
                                                              : std::ssize(embedding.channels));
    const std::uint64_t product = std::accumulate(embedding.shape.begin(), embedding.shape.end(),
                                                  std::uint64_t{1}, std::multiplies());
    if (product == num_features) return;
    reading_.reject(path, fmt::format("[{}]", fmt::join(embedding.shape, ", ")),
                    fmt::format("of a product of {}, the number of features", num_features));
  }

  // False when it is more, or was wrong already.
  bool check_at_most(const std::string& path, Index found, Index most, const std::string& why) {
    if (!reading_.good(path) || shape_.num_steps == 0) return false;  // it is missing itself
    return require(path, found, found <= most, fmt::format("<= {}, {}", most, why));
  }

  void check_method(const std::string& path, const MethodConfig& method) {
    if (!infers(method)) return;
    check_at_most(path + ".num_rollouts", method.num_rollouts, fewest_rollouts(),
                  study_.evaluate.leave_out > 0
                      ? "the rollouts of the target but those that a fold leaves out"
                      : "the rollouts of the target");
    if (family_of(method) == inference::AlgorithmFamily::regression) {
      check_at_most(path + ".linear_regression.window", method.linear_regression.window,
                    shape_.num_steps + 1, "the states of a rollout");
      return;
    }
    const bool cross_validates = method.refine.sampling.cross_validate;
    require(path + ".refine.cross_validate", cross_validates,
            !cross_validates || fewest_rollouts() > 1,
            used_rollouts() > 1 ? "false: evaluate.leave_out leaves it a single rollout"
                                : "false with a single rollout: none can be left out");
    if (!learns(method)) return;
    check_at_most(path + ".embedding.downsample", method.embedding.downsample, shape_.num_steps / 2,
                  two_states_left());
  }

  static bool sees_stored_states(const MethodConfig& method) {
    return infers(method) && family_of(method) != inference::AlgorithmFamily::regression;
  }

  // Of a single one neither a likelihood nor a distance of trajectories says much.
  std::string two_states_left() const {
    return fmt::format("so that two of the {} states of a rollout are left", shape_.num_steps);
  }

  Index used_rollouts() const {
    return study_.target.num_rollouts > 0 ? study_.target.num_rollouts : shape_.num_rollouts;
  }

  // Of those that inference sees when the largest fold is left out.
  Index fewest_rollouts() const {
    const Index folds = study_.evaluate.leave_out;
    return folds > 0 ? used_rollouts() - (used_rollouts() + folds - 1) / folds : used_rollouts();
  }

  RolloutShape shape_;  // of those that are used
  Index num_recorded_;
};

// What a policy does is simulated at the simulator's own dt, in which delays are counted, too, and
// collected rollouts stand beside recorded ones.
void require_dt_of_policy(const Study& study, const Target& recording) {
  constexpr double clock_error = 0.01;
  if (!study.policy.is_used()) return;
  const double dt = simulator_info(study).dt;
  if (std::abs(recording.dt - dt) <= clock_error * dt) return;
  const char* const key = study.target.recording ? "target.recording" : "target.inputs";
  throw InputError(
      fmt::format("{}: {}: dt = {:.6g} s, must be {:.6g} s with [policy]: that of the "
                  "closed loop; import it with --resample {:.6g}, or leave out [policy]",
                  study.places.of(key).str(), key, recording.dt, dt, dt));
}

}  // namespace

void check_rollouts(const Study& study, const RolloutShape& shape, Reading& reading) {
  RolloutChecker(study, shape, reading).check();
}

void check_recording(const Study& study, const Target& recording) {
  Reading reading(study.places);
  check_rollouts(study, {recording.num_rollouts(), recording.num_steps(), recording.state_channels},
                 reading);
  reading.throw_if_bad();
  require_dt_of_policy(study, recording);
}

std::string motion_problem(const Study& study, const Target& rollouts) {
  const std::string path = study.target.recording ? "target.recording" : "target.truth";
  const char* remedy = study.target.recording ? "leave out the rollout (target.rollouts)"
                                              : "let it move, by its actions or where it begins";
  for (const Rollout& rollout : rollouts.rollouts) {
    for (std::size_t c = 0; c < rollouts.state_channels.size(); ++c) {
      // Distances leave the last state out, noise the first.
      const Vector size = rollout.states.col(static_cast<Index>(c)).cwiseAbs();
      if (size.head(rollout.num_steps()).maxCoeff() > 0.0 &&
          size.tail(rollout.num_steps()).maxCoeff() > 0.0) {
        continue;
      }
      return fmt::format(
          "{}: {}: channel '{}' of rollout '{}' is 0 throughout, but perhaps for its first or last "
          "state, and errors are in units of its maximum; {}{}",
          study.places.of(path).str(), path, rollouts.state_channels[c].label, rollout.name, remedy,
          study.source().is_built_in ? "" : ", or leave out the channel (simulator.states)");
    }
  }
  return "";
}

void require_motion(const Study& study, const Target& rollouts) {
  const std::string problem = motion_problem(study, rollouts);
  if (!problem.empty()) throw InputError(problem);
}

}  // namespace npdr::pipeline
