#include "pipeline/apps/remake.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/temporary_folder.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/process/build_info.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/run/run_stage.h"

namespace npdr::pipeline {

Remake::Remake(const std::filesystem::path& file, Plan plan) : file_(file), plan_(std::move(plan)) {
  try_to_read(file, [&] { content_digest(file); });
  const ArtefactInfo info = read_artefact_info(file);
  // A checkpoint has the key of what it becomes.
  if (info.schema.name.ends_with("_checkpoint")) {
    throw InputError(file.string() + ": a " + info.schema.name +
                     ", must be what a stage made; run its study to the end");
  }
  node_ = plan_.node_by_key(info.key);
  require_inputs(plan_, node_);
  provenance_ = info.provenance;
}

std::string Remake::title() const {
  return fmt::format("{}, which took {:.1f} s, {:.1f} core-seconds, when it was made",
                     node_.label(), provenance_.cost.wall_seconds, provenance_.cost.core_seconds);
}

std::string Remake::difference_of_builds() const {
  const auto build = [](const auto& version, const auto& revision, const auto& instructions) {
    return fmt::format("npdr {} ({}) for {}", version, revision, instructions);
  };
  const std::string maker =
      build(provenance_.creator_version, provenance_.git_revision, provenance_.instruction_set);
  const std::string own = build(creator_version(), git_revision(), instruction_set());
  return maker == own ? "" : "it was made by " + maker + ", this is " + own;
}

bool Remake::gives_same_bits() {
  const TemporaryFolder folder("npdr-remake", "what is made again is left there");
  // Its inputs stay where the plan has them.
  plan_.work = WorkFolder(folder.path());
  node_.path = plan_.work.artefact(name_of(node_.stage), node_.key);
  try {
    run_stage(plan_, node_);
  } catch (const Checkpointed&) {
    throw Error(file_.string() + ": stopped on request before it was made again");
  }
  return content_digest(file_) == content_digest(node_.path);
}

}  // namespace npdr::pipeline
