/// Every command of the documents, and of the heads of studies, does what a reader expects: it
/// works. Each is run by a shell as it is written, in the order of its document, after what the
/// document takes for granted has been made. Runs of studies only say what they would do, or get a
/// small budget.
#include <cctype>
#include <fstream>
#include <regex>

#include "core/text.h"
#include "pipeline/artefacts/recording.h"
#include "tests/cli/program.h"
#include "tests/device_recordings.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = NPDR_SOURCE_DIR;
const std::string kHeads = "experiments/*.toml";  // of all studies: one document

// How commands begin that can't be run here, and why.
const std::map<std::string, std::string> kNotRun = {
    {"scripts/", "installs packages, builds the project and runs its tests"},
    {"cmake ", "builds the project; tests/libraries builds the example of docs/libraries.md"},
    {"build/", "programs that such a command builds, and benchmarks, which take minutes"},
    {"bench/against_sbi", "installs sbi, from a network"},
    {"bench/bench_traps.py", "takes most of an hour"},
    {"prepare=$(sbatch", "wants a cluster; tests/cluster has one"},
    {"simulate=$(sbatch", "wants a cluster"},
    {"infer=$(sbatch", "wants a cluster"},
    {"evaluate=$(sbatch", "wants a cluster"},
    {"diagnose=$(sbatch", "wants a cluster"},
    {"sbatch", "wants a cluster"},
    {"jobs/one-machine-cluster", "starts a cluster, as root; tests/cluster does"},
    {"eval \"$(jobs/one-machine-cluster", "wants that cluster"},
    {"seq ", "GNU parallel is a package of its own"},
    {"h5ls", "a program of HDF5, which nothing else here needs"},
    {"h5dump", "a program of HDF5, which nothing else here needs"},
    {"npdr new mine --recording recording.h5",
     "wants a recording; new_studies_test writes such studies"},
    {"npdr validate mine.toml --try", "wants what that writes; external_test tries another"},
    {"npdr evidence ", "wants studies with refined posteriors; evidence_test makes some"},
    {"cd experiments/external/spring", "writes there; own_simulators_test compiles a copy"},
    {"cd ../../..", "goes back"},
    {"cc ", "the same"},
    {"npdr run experiments/external/spring/library.toml", "wants that library"},
    {"npdr import rollout-", "wants MuJoCo; own_simulators_test does it where it is installed"},
    {"npdr run experiments/external/cartpole", "the same"},
    {"npdr run experiments/external/furuta", "the same"},
};

// Words added to runs of studies that really run, besides the --dry-run that all get.
const std::map<std::string, std::string> kSmallRuns = {
    {"npdr run study.toml", "--set method.training.max_epochs=5"},
    {"npdr run experiments/pendulum.toml --set 'study.seeds=[1]'", ""},
    {"npdr run experiments/pendulum.toml --only 'NPDR (MAF)'", ""},
    {"npdr run experiments/furuta.toml --set target.recording=recording.h5",
     "--only 'NPDR (MAF)' --seeds 1 --set method.num_rounds=1 --set method.num_simulations=80 "
     "--set method.training.max_epochs=1 --set evaluate.num_samples=10 --set evaluate.floor=false"},
    {"npdr run experiments/minigolf.toml --set target.recording=minigolf_8s.h5 --seeds 1",
     "--only 'NPDR (MAF)' --set method.num_simulations=130 --set method.training.max_epochs=1 "
     "--set evaluate.num_samples=10"},
};

struct Command {
  std::string where;  // "README.md:52"
  std::string text;
};

// Value of the first key that `text` begins with; null: none.
const std::string* found_by_beginning(const std::map<std::string, std::string>& map,
                                      const std::string& text) {
  const auto found =
      std::ranges::find_if(map, [&](const auto& entry) { return text.starts_with(entry.first); });
  return found == map.end() ? nullptr : &found->second;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The command that begins in line i, at `text`; a line that ends in \ goes on in the next one, of
// which `mark` matches what isn't part of the command.
Command command_at(const std::string& name, const std::vector<std::string>& lines, std::size_t& i,
                   std::string text, const std::regex& mark) {
  const std::string where = name + ":" + std::to_string(i + 1);
  while (text.ends_with("\\")) {
    text.pop_back();
    text += std::regex_replace(lines.at(++i), mark, "", std::regex_constants::format_first_only);
  }
  return {where, text};
}

// Commands in blocks of sh, in lines that are indented, and in the text, where they name a study.
std::vector<Command> commands_in_text(const std::string& name) {
  const std::vector<std::string> lines = lines_of(kRoot / name);
  const std::regex fence("\\s*```(\\w*)"), indented(" {4,}(npdr .*)"), indent("^ +");
  const std::regex in_text("`(npdr [a-z-]+ experiments/[^`]*|[A-Z]+='[^`]*)`");
  std::vector<Command> commands;
  std::string block;  // the kind of the fenced one that the line is in
  std::smatch match;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string line = lines[i];
    if (std::regex_match(line, match, fence)) {
      block = !block.empty() ? "" : match[1].length() > 0 ? match[1].str() : "text";
    } else if (block == "sh" && !line.empty() && line[0] != '#') {
      if (line[0] != ' ') commands.push_back(command_at(name, lines, i, line, indent));
    } else if (block != "sh" && std::regex_match(line, match, indented)) {
      commands.push_back(command_at(name, lines, i, match[1], indent));
    } else if (block.empty()) {
      for (std::sregex_iterator at(line.begin(), line.end(), in_text), end; at != end; ++at) {
        commands.push_back({name + ":" + std::to_string(i + 1), (*at)[1]});
      }
    }
  }
  return commands;
}

std::vector<Command> commands_in_heads() {
  const std::regex pattern("# {3,}((npdr|sh) .*)"), mark("^# +");
  std::vector<Command> commands;
  for (const std::string& name : files_ending(kRoot / "experiments", ".toml")) {
    const std::vector<std::string> lines = lines_of(kRoot / "experiments" / name);
    std::smatch match;
    for (std::size_t i = 0; i < lines.size() && lines[i].starts_with("#"); ++i) {
      if (!std::regex_match(lines[i], match, pattern)) continue;
      commands.push_back(command_at("experiments/" + name, lines, i, match[1], mark));
    }
  }
  return commands;
}

std::vector<Command> commands_of(const std::string& document) {
  return document == kHeads ? commands_in_heads() : commands_in_text(document);
}

std::vector<std::string> documents() {
  std::vector<std::string> names = {kHeads, "README.md", "CONTRIBUTING.md"};
  for (const std::string folder : {"docs", "experiments", "bench"}) {
    for (const std::string& name : files_ending(kRoot / folder, ".md")) {
      names.push_back(folder + "/" + name);
    }
  }
  std::erase_if(names, [](const std::string& name) { return commands_of(name).empty(); });
  return names;
}

/// A folder with what documents take for granted.
class Documents : public ::testing::TestWithParam<std::string> {
 protected:
  Documents() {
    fs::create_directory_symlink(kRoot / "experiments", folder_ / "experiments");
    fs::create_directory(folder_ / "recordings");
    fs::create_directory(folder_ / "python");
    if (python_.starts_with("/")) fs::create_symlink(python_, folder_ / "python/python3");
    write_files_of_the_document();
    if (!fs::exists(folder_ / "study.toml")) shell("npdr new study");
    for (const std::string folder : {"", "recordings/"}) {
      write_recording(furuta_recording(5), folder_ / (folder + "furuta_swingup_5s.h5"));
      write_recording(minigolf_recording(7), folder_ / (folder + "minigolf_8s.h5"));
    }
    if (GetParam() == "docs/file-formats.md") prepare_file_formats();
    folder_.file("rollout1.csv", furuta_csv(0.1));
    folder_.file("rollout2.csv", furuta_csv(0.2));
  }

  // With the project's programs on the path, and a python3 with numpy.
  Outcome shell(const std::string& command) const {
    const std::string path = "export PATH=" NPDR_BINARY_DIR "/bin:$PWD/python:$PATH\n";
    return run(folder_.path(), {"/bin/bash", "-c", path + command});
  }

  const std::string python_ = python_with("numpy");

 private:
  // A recording that a Python program makes there, a second file like the first, a policy.
  void prepare_file_formats() const {
    const auto device = sim::make_simulator({.name = "pendulum"});
    write_recording(device->behave(sim::complete_theta(*device, {}), 1, 1),
                    folder_ / "recording.h5");
    std::string run_b = text_of(folder_ / "run_a.csv");
    folder_.file("run_b.csv", run_b.replace(run_b.find("0.03"), 4, "0.04"));
    const Outcome outcome = shell(
        "npdr run experiments/furuta_policy.toml --only NPDR --seeds 1 --set method.num_rounds=1 "
        "--set method.num_simulations=64 --set method.training.max_epochs=1 "
        "--set method.policy_iterations=1 --set evaluate.num_samples=10 "
        "--set policy.num_test_states=20 --set policy.num_domain_parameters=2");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  }

  // Blocks that aren't commands, after a text that ends in the name of a file.
  void write_files_of_the_document() const {
    if (GetParam() == kHeads) return;
    const std::vector<std::string> lines = lines_of(kRoot / GetParam());
    const std::regex named(".*`(\\w+\\.(?:py|csv|toml))`[^`]*:");
    std::smatch match;
    for (std::size_t i = 0; i + 2 < lines.size(); ++i) {
      if (!std::regex_match(lines[i], match, named) || !lines[i + 2].starts_with("```")) continue;
      std::string text;
      for (std::size_t k = i + 3; lines.at(k) != "```"; ++k) text += lines[k] + "\n";
      folder_.file(match[1], text);
    }
  }

  // A second of a pole that swings a little.
  static std::string furuta_csv(double amplitude) {
    std::string text =
        "t [s],theta [rad],alpha [rad],theta_dot [rad/s],alpha_dot [rad/s],voltage [V]\n";
    for (int i = 0; i <= 500; ++i) {
      const double t = 0.002 * i;
      for (const double value : {t, amplitude * std::sin(t), 0.2 * std::sin(8.0 * t),
                                 amplitude * std::cos(t), 1.6 * std::cos(8.0 * t)}) {
        text += std::to_string(value) + ",";
      }
      text += i < 500 ? "0.5\n" : "\n";
    }
    return text;
  }

  TempFolder folder_;
};

// Commands that are run in place of one: a study says what it would do, one with a budget does it,
// too, and no cluster is asked to end jobs.
std::vector<std::string> affordable(const std::string& text) {
  const std::string command = text.substr(0, text.find("  #"));
  if (command.starts_with("npdr cancel ")) return {"npdr validate" + command.substr(11)};
  if (!command.starts_with("npdr run ") && !command.starts_with("npdr submit ")) return {command};
  std::vector<std::string> commands = {command + " --dry-run"};
  const std::string* budget = found_by_beginning(kSmallRuns, command);
  if (budget != nullptr) commands.push_back(command + " " + *budget);
  return commands;
}

TEST_P(Documents, EveryCommandWorks) {
  if (python_.empty() && GetParam() == "docs/external-simulators.md") {
    GTEST_SKIP() << "no Python with numpy";
  }
  std::set<std::string> done;
  std::string variables;
  for (const Command& command : commands_of(GetParam())) {
    if (found_by_beginning(kNotRun, command.text) || !done.insert(command.text).second) continue;
    if (std::isupper(static_cast<unsigned char>(command.text[0])) != 0) {
      variables += command.text + "\n";
      continue;
    }
    for (const std::string& cheap : affordable(command.text)) {
      const Outcome outcome = shell(variables + cheap);
      EXPECT_EQ(outcome.status, 0) << command.where << ": " << cheap << "\n" << outcome.err;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, Documents, ::testing::ValuesIn(documents()), [](const auto& document) {
  std::string name = document.param;
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

TEST(DocumentedLibraries, TheExampleIsTheOneThatIsBuilt) {
  const std::string page = text_of(kRoot / "docs/libraries.md");
  for (const char* name : {"pendulum.cpp", "CMakeLists.txt"}) {
    EXPECT_TRUE(has(page, "\n" + text_of(kRoot / "tests/libraries/standalone" / name) + "```"))
        << name;
  }
}

TEST(DocumentedCommands, AreFoundAndListsNameNoOthers) {
  std::vector<std::string> texts;
  for (const std::string& document : documents()) {
    for (const Command& command : commands_of(document)) texts.push_back(command.text);
  }
  EXPECT_GT(texts.size(), 80);
  for (const auto* list : {&kNotRun, &kSmallRuns}) {
    for (const auto& [beginning, rest] : *list) {
      EXPECT_TRUE(std::ranges::any_of(texts, [&](const std::string& text) {
        return text.starts_with(beginning);
      })) << beginning;
    }
  }
}

}  // namespace
}  // namespace npdr::pipeline
