// The command verify: recomputes some rows of an artefact, or all of it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/error.h"
#include "core/temporary_folder.h"
#include "pipeline/apps/commands.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/build_info.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/process/progress.h"
#include "pipeline/run/run_stage.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kProgram = "npdr verify";
constexpr Index kMostRows = 100'000'000;

struct VerifyArguments {
  std::string path;
  bool all = false;
  VerifyOptions rows;
  StudyArguments remake;  ///< no file: rows are looked at
};

ExitStatus verify_rows(const std::string& path, const VerifyOptions& options) {
  const Verification found = verify(path, options);
  print_line("{}: {} of {} rows recomputed, {} differ", path, found.num_checked, found.num_rows,
             found.different.size());
  if (found.num_checked < found.num_rows) {
    const double share =
        static_cast<double>(found.num_checked) / static_cast<double>(found.num_rows);
    print_line("    a single bad row is found so with a probability of {:.3g} %; --all finds any",
               100.0 * share);
  }
  for (const Index row : found.different) fmt::print("    row {}\n", row);
  return found.different.empty() ? ExitStatus::done : ExitStatus::failed;
}

std::string build_text(const auto& version, const auto& revision, const auto& instructions) {
  return fmt::format("npdr {} ({}) for {}", version, revision, instructions);
}

// The artefact's node in the plan, with its inputs there.
Node node_of(const std::filesystem::path& file, const ArtefactInfo& info, const Plan& plan) {
  // A checkpoint has the key of what it becomes.
  if (info.schema.name.ends_with("_checkpoint")) {
    throw InputError(file.string() + ": a " + info.schema.name +
                     ", must be what a stage made; run its study to the end");
  }
  const Node& node = plan.node_by_key(info.key);
  require_inputs(plan, node);
  return node;
}

// Makes the artefact again in a folder of its own; its inputs stay where the plan has them. Nothing
// of it stays.
bool gives_same_bits(const std::filesystem::path& file, Plan plan, Node node) {
  const TemporaryFolder folder("npdr-remake", "what is made again is left there");
  plan.work = WorkFolder(folder.path());
  node.path = plan.work.artefact(name_of(node.stage), node.key);
  try {
    run_stage(plan, node);
  } catch (const Checkpointed&) {
    throw Error(file.string() + ": stopped on request before it was made again");
  }
  return content_digest(file) == content_digest(node.path);
}

ExitStatus verify_by_remake(const std::string& path, const StudyArguments& study) {
  const Plan plan = study.plan();
  try_to_read(path, [&] { content_digest(path); });
  const ArtefactInfo info = read_artefact_info(path);
  const Node node = node_of(path, info, plan);
  const Provenance& made = info.provenance;
  report_error(kProgram, fmt::format("makes again {}, which took {:.1f} s, {:.1f} core-seconds, "
                                     "when it was made",
                                     node.label(), made.cost.wall_seconds, made.cost.core_seconds));
  const std::string maker =
      build_text(made.creator_version, made.git_revision, made.instruction_set);
  const std::string own = build_text(creator_version(), git_revision(), instruction_set());
  if (maker != own) {
    report_warning(kProgram, fmt::format("it was made by {}, this is {}; bits may differ for that "
                                         "reason alone",
                                         maker, own));
  }
  const bool is_same = gives_same_bits(path, plan, node);
  print_line("{}: made again, with {} bits", path, is_same ? "the same" : "OTHER");
  return is_same ? ExitStatus::done : ExitStatus::failed;
}

}  // namespace

Action verify_command(CLI::App& command) {
  auto arguments = std::make_shared<VerifyArguments>();
  command.add_option("FILE", arguments->path, "artefact, such as simulate.h5")->required();
  auto* rows = command.add_option("--rows", arguments->rows.count, "how many")
                   ->capture_default_str()
                   ->check(CLI::Range(Index{1}, kMostRows));
  auto* all = command.add_flag("--all", arguments->all, "all rows");
  add_seed_option(command, "--pick", arguments->rows.pick, "picks the rows");
  command.add_flag("--run-command", arguments->rows.runs_command,
                   "run the program or library that the file names, which can do all that you can");
  auto* remake =
      command
          .add_option("--remake", arguments->remake.file,
                      "the study that FILE was made from: make all of it again, such as by "
                      "training, from the inputs in the folder of --work; FILE stays as it is")
          ->type_name("STUDY")
          ->excludes(rows)
          ->excludes(all);
  arguments->remake.add_settings_to(command);
  for (const char* setting : {"--set", "--work"}) command.get_option(setting)->needs(remake);
  command.footer(
      "Examples:\n"
      "  npdr verify runs/study/npe/seed-1/round-1/simulate.h5\n"
      "  npdr verify runs/study/npe/seed-1/round-1/infer.h5 --remake study.toml");
  return [arguments] {
    if (!arguments->remake.file.empty()) {
      return verify_by_remake(arguments->path, arguments->remake);
    }
    if (arguments->all) arguments->rows.count = kMostRows;
    return verify_rows(arguments->path, arguments->rows);
  };
}

}  // namespace npdr::pipeline
