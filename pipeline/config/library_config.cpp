#include "pipeline/config/library_config.h"

#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "core/error.h"
#include "pipeline/process/child_process.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAdviceOnLateModels =
    ": raise simulator.time_limit where rows take that long, or narrow the prior";
constexpr const char* kAdviceOnLateLibraries =
    ": raise simulator.time_limit where rows take that long; where one of them comes to no end, "
    "bound the library's loops and give it the status NPDR_DIVERGED";

// Beside the executables, or where an environment variable says.
fs::path mujoco_library() {
  const char* const given = std::getenv("NPDR_MUJOCO_LIBRARY");
  const fs::path file = given != nullptr
                            ? fs::path(given)
                            : executable_folder().parent_path() / "lib" / "npdr_mujoco.so";
  std::error_code unreadable;
  if (!fs::exists(file, unreadable)) {
    throw InputError("simulator.mjcf needs MuJoCo, which npdr was built without: " + file.string() +
                     " isn't there; 'pip install mujoco', then build npdr again with "
                     "'scripts/build' (docs/external-simulators.md)");
  }
  return file;
}

// Requests of the study to the model, in an order that doesn't depend on the prior's; without a
// prior, all that the model has.
nlohmann::ordered_json mujoco_settings(const Study& study) {
  std::set<std::string> parameters;
  for (const inference::Marginal& marginal : study.prior) parameters.insert(marginal.name);
  for (const auto& [name, value] : study.simulator.parameters) parameters.insert(name);
  if (study.target.truth) {
    for (const auto& [name, value] : *study.target.truth) parameters.insert(name);
  }
  for (const ReferenceConfig& reference : study.references) {
    for (const auto& [name, value] : reference.parameters) parameters.insert(name);
  }
  return {{"model", fs::absolute(*study.external.mjcf).string()},
          {"parameters",
           parameters.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(parameters)},
          {"states", study.external.states},
          {"actions", study.external.actions}};
}

}  // namespace

sim::LibraryConfig library_config(const Study& study) {
  const ExternalConfig& external = study.external;
  const std::string advice = external.mjcf ? kAdviceOnLateModels : kAdviceOnLateLibraries;
  const auto end_late = [advice](const std::string& message) {
    report_error("npdr", message + advice);
    _exit(static_cast<int>(ExitStatus::invalid_input));
  };
  if (external.mjcf) {
    return {mujoco_library(), mujoco_settings(study).dump(), external.folder, external.time_limit,
            end_late};
  }
  return {*external.library, external.settings.json, external.folder, external.time_limit,
          end_late};
}

}  // namespace npdr::pipeline
