/// The study that faults are injected into, and what an undisturbed run of it gives.
#pragma once

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <source_location>
#include <sstream>

#include "tests/cli/program.h"

namespace npdr::pipeline {

/// All stages, an estimator of each kind, two rounds and several shards, in about three seconds.
inline std::string fault_study() {
  const std::string embedding =
      "embedding = { kind = \"all_steps\", downsample = 40, principal_components = 8 }";
  return pendulum_study("faults")
      .only("target", {"recording = \"recording.h5\"", "num_rollouts = 1", "held_out = 1"})
      .with("simulator", {"store_every = 20"})
      .with("observation_noise", {"scale = 0.1"})
      .with("simulate", {"shard_size = 64"})
      .method("MAF", {"algorithm = \"npe_c\"", "num_rounds = 2", "num_simulations = 150", embedding,
                      kSmallFlow, "training = { max_epochs = 100, stop_after_epochs = 100 }"})
      .method("MoG", {"algorithm = \"npe_c\"", "num_rounds = 2", "num_simulations = 150", embedding,
                      kSmallMixture, "training = { max_epochs = 40 }"})
      .method("ABC", {"algorithm = \"abc_smc\"", "num_rounds = 2", "num_simulations = 150",
                      "abc = { quantile = 0.2, smooth = true, distance = \"rmse\" }"})
      .method("Refined", {"algorithm = \"refine\"",
                          "refine = { start = \"MoG\", level_size = 1000, min_ess = 100, "
                          "max_simulations = 3000 }"})
      .with("evaluate", {"num_samples = 40", "metrics = [\"rmse\"]", "floor = false"})
      .with("diagnose",
            {"checks = [\"sbc\", \"predictive\"]", "num_simulations = 40", "num_samples = 40"});
}

/// Two swings of a pendulum that is pushed, by semi-implicit Euler steps.
inline void write_recording(const std::filesystem::path& path) {
  constexpr Index steps = 400;
  constexpr double dt = 0.02;
  std::vector<double> states, actions;
  for (const double push : {4.5, 3.5}) {
    double angle = 0.0, rate = 0.0;
    for (Index t = 0; t <= steps; ++t) {
      states.insert(states.end(), {angle, rate});
      if (t == steps) break;
      actions.push_back(push * std::sin(0.5 * dt * static_cast<double>(t)));
      rate += dt * (actions.back() - 9.81 * std::sin(angle));
      angle += dt * rate;
    }
  }
  h5::File file = h5::File::create(path);
  h5::Dataset all = file.create_dataset("states", h5::ElementType::f64, {2, steps + 1, 2});
  all.write_rows<double>(0, 2, states);
  all.set_attribute("labels", std::vector<std::string>{"theta", "theta_dot"});
  all.set_attribute("units", std::vector<std::string>{"rad", "rad/s"});
  h5::Dataset pushes = file.create_dataset("actions", h5::ElementType::f64, {2, steps, 1});
  pushes.write_rows<double>(0, 2, actions);
  pushes.set_attribute("labels", std::vector<std::string>{"torque"});
  pushes.set_attribute("units", std::vector<std::string>{"N m"});
  file.set_attribute("dt", dt);
  file.close();
}

/// An artefact of the study, as `npdr status --json` shows it.
struct Artefact {
  std::string stage;
  std::string label;
  std::string key;
  std::filesystem::path path;  ///< absolute
  std::string state;
  std::string detail;

  /// Its file without ".h5": what belongs to it begins like that.
  std::filesystem::path stem() const { return std::filesystem::path(path).replace_extension(); }
  /// The executable that makes it.
  std::string program() const {
    if (stage == "target" || stage == "held_out") return "npdr-propose";
    return "npdr-" + (stage == "baseline" ? "evaluate" : stage);
  }
};

/// A folder with the study and a work folder.
class FaultFolder {
 public:
  FaultFolder() {
    std::ofstream(path() / "faults.toml") << fault_study();
    write_recording(path() / "recording.h5");
  }

  const std::filesystem::path& path() const { return folder_.path(); }
  std::filesystem::path work() const { return path() / "runs"; }
  std::filesystem::path cache() const { return work() / ".cache"; }
  std::filesystem::path readable() const { return work() / "faults"; }

  /// "npdr run faults.toml ..." and the like.
  static std::vector<std::string> npdr_words(std::vector<std::string> words) {
    words.insert(words.begin(), "npdr");
    words.insert(words.begin() + 2, "faults.toml");
    return words;
  }
  Outcome npdr(const std::vector<std::string>& words) const {
    return run(path(), npdr_words(words));
  }
  Outcome npdr(int status, const std::vector<std::string>& words,
               const std::source_location& where = std::source_location::current()) const {
    return with_status(status, npdr(words), where);
  }
  /// Makes one artefact with its stage's executable.
  static std::vector<std::string> making(const Artefact& artefact) {
    return {artefact.program(), "faults.toml", "--artefact", artefact.key};
  }

  std::vector<Artefact> artefacts() const {
    std::vector<Artefact> found;
    for (const auto& row : nlohmann::json::parse(npdr({"status", "--json"}).out, nullptr, false)) {
      found.push_back({row["stage"], row["label"], row["key"],
                       path() / row["path"].get<std::string>(), row["state"], row["detail"]});
    }
    return found;
  }
  std::vector<Artefact> artefacts_of(const std::string& stage) const {
    std::vector<Artefact> found = artefacts();
    std::erase_if(found, [&](const Artefact& artefact) { return artefact.stage != stage; });
    return found;
  }

 private:
  TempFolder folder_;
};

/// Without the lines of the report that say when its results were made and what they cost.
inline std::string timeless(const std::string& text) {
  std::istringstream lines(text);
  std::string line, kept;
  while (std::getline(lines, line)) {
    if (!line.starts_with("<dt>last result<") && !line.starts_with("<dt>cost<"))
      kept += line + "\n";
  }
  return kept;
}

/// Everything that a run leaves in a study's readable folder, by place: digests of artefacts, and
/// the texts of tables, figures and report.
inline std::map<std::string, std::string> results(const FaultFolder& folder) {
  std::map<std::string, std::string> found = digests(folder.readable());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.readable())) {
    const std::string name = entry.path().lexically_relative(folder.readable());
    const bool is_made = entry.is_regular_file() && !found.contains(name);
    if (is_made && !name.starts_with("logs")) found[name] = timeless(text_of(entry.path()));
  }
  return found;
}

/// Names of what differs, for messages: the texts would be long.
inline std::vector<std::string> differences(const std::map<std::string, std::string>& found,
                                            const std::map<std::string, std::string>& expected) {
  std::vector<std::string> names;
  for (const auto& [name, value] : expected) {
    const auto same = found.find(name);
    if (same == found.end()) names.push_back("missing: " + name);
    if (same != found.end() && same->second != value) names.push_back("different: " + name);
  }
  for (const auto& [name, value] : found) {
    if (!expected.contains(name)) names.push_back("new: " + name);
  }
  return names;
}

inline const std::vector<std::string> kNone = {};

/// A study that has been run without disturbance, shared by the tests of a program.
class Faults : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new FaultFolder;
    folder_->npdr(0, {"run"});
    expected_ = new std::map<std::string, std::string>(results(*folder_));
    ASSERT_GT(expected_->size(), 50u);
  }
  static void TearDownTestSuite() {
    delete expected_;
    delete folder_;
  }

  /// Expects everything to be as if nothing had happened.
  static void expect_same_results() {
    EXPECT_EQ(differences(results(*folder_), *expected_), kNone);
    EXPECT_EQ(temporaries(folder_->work()), std::set<std::string>());
  }
  /// Expects that a run goes on to that.
  static void expect_to_go_on() {
    folder_->npdr(0, {"run"});
    expect_same_results();
  }
  /// Makes one artefact with its stage's executable.
  static Outcome make(const Artefact& artefact) {
    return run(folder_->path(), FaultFolder::making(artefact));
  }

  /// One of several programs at once, each with an output of its own.
  static std::unique_ptr<Program> start(const std::vector<std::string>& words, int number) {
    const std::string name = std::to_string(number) + ".txt";
    return std::make_unique<Program>(folder_->path(), words, Streams{"out" + name, "err" + name});
  }

  inline static FaultFolder* folder_ = nullptr;
  inline static std::map<std::string, std::string>* expected_ = nullptr;
};

}  // namespace npdr::pipeline
