// Commands that show files, say where a study's results are, and hand them to other programs:
// inspect, open, export.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/finding.h"
#include "core/printable.h"
#include "core/text.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/report/inference_data.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kAnotherType = "(another type)";

// Other programs write attributes that we have no type for: truth values, references to scales.
std::string attribute_text(const h5::Object& object, const std::string& name) try {
  switch (object.attribute_type(name)) {
    case h5::ElementType::text:
      return fmt::format("{}", fmt::join(object.attribute<std::vector<std::string>>(name), ", "));
    case h5::ElementType::f32:
    case h5::ElementType::f64:
      return fmt::format("{}", fmt::join(object.attribute<std::vector<double>>(name), ", "));
    default:
      return fmt::format("{}", fmt::join(object.attribute<std::vector<Index>>(name), ", "));
  }
} catch (const InputError&) {
  return kAnotherType;
}

using Lines = std::vector<std::string>;

void add_attributes(const h5::Object& object, const std::string& indent, Lines& lines) {
  for (const std::string& name : object.attribute_names()) {
    std::string text = attribute_text(object, name);
    constexpr std::size_t most = 100;
    if (text.size() > most) text = text.substr(0, most) + "...";
    lines.push_back(fmt::format("{}@{} = {}", indent, name, text));
  }
}

Lines lines_of_dataset(const h5::Group& group, const std::string& name,
                       const std::string& indent) try {
  const h5::Dataset dataset = group.dataset(name);
  Lines lines = {fmt::format("{}{} {}", indent, name, h5::to_string(dataset.shape()))};
  add_attributes(dataset, indent + "    ", lines);
  return lines;
} catch (const InputError&) {
  return {fmt::format("{}{} {}", indent, name, kAnotherType)};
}

// What a group holds. Groups may hold each other, and links may lead nowhere: shows no group twice,
// and of neighbors with the same layout, such as the networks of an ensemble, the first.
class Tree {
 public:
  Lines lines_of(const h5::Group& group, const std::string& indent) {
    seen_.insert(group.identity());
    Lines lines, last;
    for (const std::string& name : group.names()) {
      if (!group.has(name)) continue;
      if (!group.is_group(name)) {
        append(lines, lines_of_dataset(group, name, indent));
        last.clear();
        continue;
      }
      const h5::Group below = group.group(name);
      const std::string head = fmt::format("{}{}/", indent, name);
      if (seen_.contains(below.identity())) {
        lines.push_back(head + " (shown already)");
        last.clear();
        continue;
      }
      Lines its;
      add_attributes(below, indent + "    ", its);
      append(its, lines_of(below, indent + "    "));
      const bool is_like_last = !its.empty() && its == last;
      lines.push_back(head + (is_like_last ? " (laid out like the one before)" : ""));
      if (!is_like_last) append(lines, its);
      last = std::move(its);
    }
    return lines;
  }

 private:
  std::set<std::pair<std::uint64_t, std::uint64_t>> seen_;
};

void print_lines(const Lines& lines) {
  for (const std::string& line : lines) print_line("{}", line);
}

// A dataset, a recording, or what somebody else has made.
void print_other_file(const h5::File& file, const std::string& path) {
  if (file.has("theta") && file.has("x")) {
    const DatasetFile dataset(path, {});
    print_line("{}: a dataset of {} simulations of {} features", path, dataset.num_rows(),
               dataset.features().size());
  } else if (file.has("states")) {
    const Target target = read_recording(path);
    print_line("{}: a recording of {} of {} steps of {} s", path,
               counted(target.num_rollouts(), "rollout"), target.num_steps(), target.dt);
    Lines attributes;
    add_attributes(file, "  ", attributes);
    print_lines(attributes);
  } else {
    print_line("{}: neither an artefact, a recording (states) nor a dataset (theta, x)", path);
  }
  print_lines(Tree().lines_of(file, "  "));
}

void print_file(const std::string& path, bool study, bool digest) {
  const h5::File file = h5::File::open(path);
  if (!file.has_attribute("schema")) {
    if (!study) return print_other_file(file, path);
    throw InputError(path + ": isn't an artefact, so that it belongs to no study");
  }
  const ArtefactInfo info = read_artefact_info(path);
  if (study) return print_json(info.identity.study);
  print_line("{}: {} (schema {}) made by stage '{}'", path, info.schema.name, info.schema.version,
             info.schema.stage);
  print_line("  key      {}", info.key);
  print_line("  seed     {}", info.identity.seed);
  for (const auto& [name, key] : info.identity.inputs) {
    print_line("  input    {} {}", key.substr(0, 8), name);
  }
  const Provenance& p = info.provenance;
  print_line("  made by  npdr {} ({}), {}, on {} at {} in {:.2f} s", p.creator_version,
             p.git_revision, p.instruction_set, p.host, p.created, p.cost.wall_seconds);
  if (!p.batch_job.empty()) print_line("  job      {}", p.batch_job);
  if (digest) print_line("  content  {}", content_digest(path));
  const std::vector<std::string> own = own_attributes(file);  // beyond those of every artefact
  if (!own.empty()) print_line("  attributes");
  for (const std::string& name : own) print_line("    @{} = {}", name, attribute_text(file, name));
  print_line("  datasets");
  print_lines(Tree().lines_of(file, "    "));
}

// Any HDF5 file may be looked at, and some crash the library: a child goes first.
void inspect(const std::string& path, bool study, bool digest) {
  try_to_read(path, [&] { print_file(path, study, digest); });
  print_file(path, study, digest);
}

void print_place(const std::string& what, const std::filesystem::path& path, bool is_there) {
  fmt::print("{:<12} {}{}\n", what, printable_line(path.string()),
             is_there ? "" : "  (isn't there yet, or is of other settings: npdr run)");
}

void open_study(const StudyArguments& arguments, bool in_browser) {
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
}

struct ExportArguments {
  StudyArguments study;
  std::string output;
  bool force = false;
  Index num_predictions = 100;
};

void export_study(const ExportArguments& arguments) {
  const Plan plan = arguments.study.plan_here("npdr export");
  const std::string method = last_nodes_of_method(plan, Stage::evaluate).front().use.method;
  if (arguments.output.ends_with(".csv")) {
    throw InputError(arguments.output + ": would hold NetCDF; call it .nc");
  }
  require_new_file(arguments.output, arguments.force);
  write_inference_data(plan, arguments.output, arguments.num_predictions);
  print_line("wrote {}", arguments.output);
  warn_of_failed_checks(plan, method);
}

}  // namespace

Action inspect_command(CLI::App& command) {
  auto path = std::make_shared<std::string>();
  auto study = std::make_shared<bool>(false);
  auto digest = std::make_shared<bool>(false);
  command.add_option("FILE", *path, "artefact, recording or dataset (HDF5)")->required();
  command.add_flag("--study", *study, "print the resolved study that it belongs to");
  command.add_flag("--digest", *digest, "hash of the content: equal digests, equal bits");
  command.footer("Example:\n  npdr inspect runs/study/target.h5");
  return done_after([path, study, digest] { inspect(*path, *study, *digest); });
}

Action open_command(CLI::App& command) {
  auto arguments = std::make_shared<StudyArguments>();
  auto in_browser = std::make_shared<bool>(false);
  arguments->add_to(command);
  command.add_flag("--browser", *in_browser, "open the report with xdg-open instead");
  command.footer("Example:\n  npdr open study.toml --browser");
  return done_after([arguments, in_browser] { open_study(*arguments, *in_browser); });
}

Action export_command(CLI::App& command) {
  auto arguments = std::make_shared<ExportArguments>();
  arguments->study.add_to(command);
  command.add_option("-o,--output", arguments->output, "file to write, such as out.nc")->required();
  command.add_flag("--force", arguments->force, "replace an HDF5 file that is there already");
  command
      .add_option("--predictions", arguments->num_predictions,
                  "draws of each seed whose rollouts are simulated; 0: none")
      ->capture_default_str()
      ->check(CLI::Range(Index{0}, Index{1'000'000}));
  command.footer(
      "Example:\n"
      "  npdr export study.toml --only NPE -o out.nc   arviz.from_netcdf(\"out.nc\")\n"
      "Seeds are chains. What stands in the file: docs/python.md.");
  return done_after([arguments] { export_study(*arguments); });
}

}  // namespace npdr::pipeline
