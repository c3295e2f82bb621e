// Which settings of a study are part of which keys.

#include <set>

#include "core/text.h"
#include "pipeline/artefacts/dataset_file.h"
#include "tests/pipeline/plan/field_changes.h"
#include "tests/pipeline/plan/plan_parts.h"
#include "tests/pipeline/standing_recording.h"
#include "tests/sim/library/compiled_library.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

const std::string kAllSteps = "embedding = { kind = \"all_steps\", downsample = 2 }";

StudyText of_pendulum() {
  return pendulum_study("keys")
      .only("diagnose", {})
      .with("observation_noise", {"scale = 0.1", "correlation = 0.5", "degrees_of_freedom = 4.0"})
      .add("reference", {"name = \"measured\"", "parameters = { pole_mass = 1.1 }"});
}

// A network of each role, and a posterior of each family.
std::string of_methods() {
  return of_pendulum()
      .with("target", {"truth = { pole_mass = 1.1 }", "num_rollouts = 3", "held_out = 1"})
      .with("evaluate", {"leave_out = 2"})
      .method("pooled", {kAllSteps})
      .method("atomic", {"algorithm = \"npe_c\"", "num_rounds = 2", kAllSteps})
      .method("gaussian", {"algorithm = \"npe_a\"", kAllSteps})
      .method("likelihood", {"algorithm = \"nle\"", kAllSteps})
      .method("nearest", {"algorithm = \"abc_smc\"", "num_rounds = 2", kAllSteps})
      .method("convolved", {"embedding = { kind = \"convolution\" }"});
}

std::string of_recording() {
  return of_pendulum()
      .only("target", {"recording = \"standing.h5\"", "rollouts = [3, 1, 2]", "num_rollouts = 2",
                       "held_out = 1"})
      .only("observation_noise", {"scale_prior = [0.1, 1.0]", "correlation_prior = [0.5, 1.5]",
                                  "degrees_of_freedom_prior = [3.7, 1.0]"})
      .method("first", {kAllSteps})
      .method("second", {kAllSteps, "num_simulations = 500"})
      .method("refined", {"algorithm = \"refine\"", "refine = { start = \"first\" }"});
}

std::string of_deviations() {
  return pendulum_study("deviations")
      .with("target", {"inputs = \"standing.h5\""})
      .with("observation_noise", {"std = { theta = 0.01, theta_dot = 0.1 }"})
      .method("NPE", {kAllSteps});
}

// Values of one axis are listed, the others lie in a range.
std::string of_policy(const std::string& optimizer, const std::string& listed,
                      const std::string& other) {
  return furuta_study("policy")
      .method("NPE", {"num_iterations = 2", kAllSteps})
      .with("policy", {"optimizer = \"" + optimizer + "\""})
      .with("policy.grid." + other, {"parameter = \"pole_mass\"", "range = [0.018, 0.03]"})
      .with("policy.grid." + listed, {"parameter = \"pole_length\"", "values = [0.1, 0.12]"});
}

std::string program_text(const std::string& key) {
  return command_study("program")
      .only("target", {"truth = { a = 0.4, b = 0.5 }"})
      .only("simulator", {key + " = \"sh simulate.sh {theta} {x} {segments}\"",
                          "states = [\"q [m]\"]", "actions = [\"force [N]\"]", "dt = 0.1",
                          "num_steps = 40", "files = [\"x_o.csv\"]", "initial_states = [[0.1]]",
                          "goal = { place = { q = 0.1 }, radius = 0.1, speed = 1.0 }",
                          "parameter = [{ name = \"a\", nominal = 0.4, lower = 0.0, upper = 1.0 }, "
                          "{ name = \"b\", nominal = 0.4 }, { name = \"c\", nominal = 1.0 }]"})
      .method("NPE", {kAllSteps});
}

std::string of_library() {
  return StudyText("library")
      .with("target", {"truth = {}"})
      .with("simulator", {"library = \"spring.so\"", "dt = 0.1", "num_steps = 40",
                          "initial_states = [[0.1, 0.0]]"})
      .with("prior", {"mass = { uniform = [0.5, 1.5] }"})
      .method("NPE", {kAllSteps});
}

class Keys : public FolderTest {
 protected:
  struct AllKeys {
    std::set<std::string> results;
    std::string report;
  };
  // Which keys change with a field.
  struct Effects {
    bool on_results = false, on_report = false;
  };

  Keys() {
    write_standing(folder_ / "standing.h5", 3);
    write_standing(folder_ / "other.h5", 3, 40, 0.5);
    folder_.file("x_o.csv", "peak,mean\n1,2\n");
    folder_.file("other.csv", "peak,mean\n1,3\n");
    folder_.file("simulate.sh", "exit 0");
    std::filesystem::create_directory(folder_ / "copy");
    folder_.file("copy/simulate.sh", "exit 0");
    folder_.file("copy/x_o.csv", "peak,mean\n1,2\n");
    std::string theta = "a,b\n", x = "peak,mean\n";
    for (int row = 0; row < 50; ++row) {
      theta += std::to_string(0.02 * row) + ",0.5\n";
      x += std::to_string(row) + ",1\n";
    }
    const auto values = folder_.file("theta.csv", theta);
    import_dataset(values, folder_.file("x.csv", x), folder_ / "data.h5");
    import_dataset(values, folder_.file("x.csv", edited(x, "0,1", "0,2")),
                   folder_ / "other_data.h5");
    sim::compile_library(sim::spring_source(), folder_ / "spring.so");
    sim::compile_library(sim::spring_source(), folder_ / "other.so", "-g");
  }

  AllKeys keys_of(const Study& study) const {
    AllKeys all;
    for (const Node& node : make_plan(study, WorkFolder(folder_ / "work")).nodes) {
      if (node.stage == Stage::report) {
        all.report = node.key;
      } else {
        all.results.insert(node.key);
      }
    }
    return all;
  }

  static std::vector<std::string> studies() {
    return {of_methods(),
            of_recording(),
            of_deviations(),
            of_policy("power", "x", "y"),
            of_policy("cross_entropy", "y", "x"),
            furuta_study("regression").method("BLR", {"algorithm = \"linear_regression\""}),
            minigolf_study("golf").method("NPE", {kAllSteps}),
            program_text("command"),
            program_text("worker"),
            command_study("features").method("NPE"),
            dataset_study("dataset").method("NPE", {"num_simulations = 30"}),
            of_library()};
  }

  void change_each_field(const std::string& text) {
    const Study study = parse_study(text, folder_ / "study.toml");
    const AllKeys before = keys_of(study);
    for (std::size_t leaf = 0; change_field(study, before, leaf);) ++leaf;
  }

  // To one value after the other, until a result changes; false where there is no such field.
  bool change_field(const Study& study, const AllKeys& before, std::size_t leaf) {
    for (std::size_t candidate = 0;; ++candidate) {
      Study changed = study;
      FieldChanger::Found found{leaf, candidate};
      FieldChanger changer(found, texts_);
      describe(changer, changed);
      if (found.next <= leaf) return false;
      if (!found.use.unused.empty()) return true;
      Effects& effects = effects_[{found.path, found.use.affects}];
      if (!found.is_changed || effects.on_results) return true;
      try {
        const AllKeys after = keys_of(changed);
        effects.on_results = after.results != before.results;
        effects.on_report = effects.on_report || after.report != before.report;
        const bool says_no =
            found.use.affects == Affects::report || found.use.affects == Affects::nothing;
        if (says_no) return true;
      } catch (const std::exception&) {  // another value may fit
      }
    }
  }

  static std::string fault_of(Affects affects, const Effects& effects) {
    if (affects == Affects::nothing) {
      return effects.on_report ? "changes a key, but says that it affects nothing" : "";
    }
    if (!effects.on_report) return "changes no key, but doesn't say so";
    if (affects != Affects::report) {
      return effects.on_results ? "" : "changes no result's key, but doesn't say so";
    }
    return effects.on_results ? "changes results, but says that it affects the report alone" : "";
  }

  TextsByPath known_texts() const {
    const auto path = [&](const char* name) { return (folder_ / name).string(); };
    return {{"target.recording", {path("other.h5")}},
            {"target.observation", {path("other.csv")}},
            {"target.inputs", {path("other.h5")}},
            {"simulator.command", {"sh simulate.sh {theta} {x} {segments} 2"}},
            {"simulator.worker", {"sh simulate.sh 2"}},
            {"simulator.library", {path("other.so")}},
            {"simulator.dataset", {path("other_data.h5")}},
            {"simulator.states", {"r [m]"}},
            {"simulator.actions", {"f"}},
            {"simulator.features", {"mean", "peak"}},
            {"simulator.files", {"simulate.sh"}},
            {"simulator.folder", {path("copy")}},
            {"method.embedding.channels", {"theta"}},
            {"method.refine.start", {"", "second"}},
            {"diagnose.checks", {"ood"}},
            {"report.parameters", {"pole_mass", "pole_length"}},
            {"cluster.setup", {"true"}},
            {"cluster.sbatch", {"--qos=long"}}};
  }

  TextsByPath texts_ = known_texts();
  std::map<std::pair<std::string, Affects>, Effects> effects_;
};

// Not of a model of MuJoCo, which may not be installed, of units, which reach the prior when the
// study is read, nor of the folder of a program, which counts by what its files hold.
TEST_F(Keys, EveryFieldAffectsAnArtefactOrSaysThatItDoesNot) {
  for (const std::string& text : studies()) change_each_field(text);
  for (const auto& [field, effects] : effects_) {
    const auto& [path, affects] = field;
    const std::set<std::string> others = {"simulator.mjcf", "simulator.parameter.unit",
                                          "simulator.folder"};
    if (others.contains(path)) continue;
    EXPECT_EQ(fault_of(affects, effects), "") << path;
  }
}

}  // namespace
}  // namespace npdr::pipeline
