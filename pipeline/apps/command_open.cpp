// The command that says where a study's results are.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/printable.h"
#include "pipeline/apps/commands.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/report_marker.h"

namespace npdr::pipeline {
namespace {

void print_place(const std::string& what, const std::filesystem::path& path, bool is_there) {
  fmt::print("{:<12} {}{}\n", what, printable_line(path.string()),
             is_there ? "" : "  (isn't there yet, or is of other settings: npdr run)");
}

ExitStatus open_study(const StudyArguments& arguments, bool in_browser) {
  const Plan plan = arguments.plan_here("npdr open");
  const bool is_there = is_complete(plan, plan.nodes.back());
  const std::filesystem::path folder = plan.work.study(plan.study.name);
  if (in_browser && is_there) {
    execlp("xdg-open", "xdg-open", report_path(plan).c_str(), nullptr);
    throw Error("xdg-open can't be started; open " + report_path(plan).string() + " yourself");
  }
  print_place("report", report_path(plan), is_there);
  print_place("tables", folder / "tables", is_there);
  print_place("figures", folder / "figures", is_there);
  for (const auto& [node, use] : last_nodes(plan, Stage::infer)) {
    print_place("posterior", link_of(plan, *node, use), is_complete(plan, *node));
  }
  return ExitStatus::done;
}

}  // namespace

Action open_command(CLI::App& command) {
  auto arguments = std::make_shared<StudyArguments>();
  auto in_browser = std::make_shared<bool>(false);
  arguments->add_to(command);
  command.add_flag("--browser", *in_browser, "open the report with xdg-open instead");
  command.footer("Example:\n  npdr open study.toml --browser");
  return [arguments, in_browser] { return open_study(*arguments, *in_browser); };
}

}  // namespace npdr::pipeline
