#include "pipeline/apps/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ranges>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/printable.h"
#include "core/shell_text.h"
#include "core/text.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/config/study_check.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/import/recording_warnings.h"
#include "pipeline/plan/report_marker.h"
#include "pipeline/process/fitted_text.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

// Commands that only read would find every artefact missing below a file.
void require_folder(const std::string& work) {
  if (work.empty()) throw InputError("--work = '', must be the folder of results, such as runs");
  std::error_code error;
  const auto status = std::filesystem::status(work, error);
  if (!std::filesystem::exists(status) || std::filesystem::is_directory(status)) return;
  throw InputError(fmt::format(
      "--work = {}, which isn't a folder; must be the folder of results, or a new name for one",
      quoted(work)));
}

// A device that was driven is simulated without.
Findings find_unused_actions(const Plan& plan) {
  const sim::SimulatorInfo& info = plan.source->info();
  std::vector<std::string> unused;
  for (const Channel& action : plan.recorded_actions) {
    const auto is_it = [&](const Channel& known) { return known.label == action.label; };
    if (std::ranges::any_of(info.action_channels, is_it)) continue;
    if (!std::ranges::any_of(info.state_channels, is_it)) unused.push_back(action.label);
  }
  if (unused.empty()) return {};
  return {warning(fmt::format(
      "the simulator isn't given the recorded action{} {}: it moves as if there were none; name it "
      "in simulator.actions, where the simulator is yours",
      unused.size() == 1 ? "" : "s", join(unused)))};
}

void add(Findings& all, Findings found, const std::string& where) {
  for (Finding& finding : found) finding.where = where;
  append(all, std::move(found));
}

// A terminal would break the line within a word.
void print_prose(const std::string& text) {
  const auto columns = terminal_columns();
  const std::string line = printable_line(text);
  fmt::print("{}\n", columns ? wrapped(line, *columns) : line);
}

}  // namespace

void set_choices(CLI::Option& option, const std::vector<std::string>& choices) {
  option.type_name("{" + join(choices, ",") + "}");
}

std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string text = option.get_type_name();
  if (!text.starts_with('{') || !text.ends_with('}')) return {};
  return split(text.substr(1, text.size() - 2), ',');
}

void StudyArguments::add_to(CLI::App& app) {
  app.add_option("STUDY", file, "study file (TOML)")->required();
  add_selection_to(app);
}

void StudyArguments::add_settings_to(CLI::App& app) {
  app.add_option("--set", overrides,
                 "key=value that replaces a key of the study, such as simulate.shard_size=500 or "
                 "'method.\"NPDR (MAF)\".num_rounds=2'; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--work", work, "folder of results and cache")->capture_default_str();
}

void StudyArguments::add_selection_to(CLI::App& app) {
  add_settings_to(app);
  app.add_option("--only,--method", methods, "only this method; may be repeated")
      ->allow_extra_args(false);
  app.add_option_function<std::vector<std::string>>(
         "--seeds",
         [this](const std::vector<std::string>& texts) {
           try {
             const std::vector<Index> ranges = parse_ranges(join(texts, ","));
             seeds.assign(ranges.begin(), ranges.end());
           } catch (const InputError& error) {
             throw CLI::ValidationError("--seeds", error.what());
           }
         },
         "only these seeds, such as 1-3,5")
      ->allow_extra_args(false);
}

Plan StudyArguments::plan(const ClusterConfig& site) const {
  require_folder(work);
  Plan plan = make_plan(read_study(file, overrides, site), WorkFolder(work), {methods, seeds});
  plan.words = words();
  return plan;
}

Plan StudyArguments::plan_here(const std::string& program) const {
  Plan plan = this->plan();
  const WorkFolder there((std::filesystem::path(file).parent_path() / work).string());
  std::error_code error;
  if (!std::filesystem::exists(plan.work.study(plan.study.name), error) &&
      std::filesystem::exists(there.study(plan.study.name), error)) {
    report_warning(program,
                   fmt::format("no results of this study in {}, but in {}; to use those: {}", work,
                               there.root().string(), shell_text({"--work", there.root()})));
  }
  return plan;
}

std::vector<std::string> StudyArguments::words() const {
  // A name like an option's is one to whoever reads these words.
  std::vector<std::string> words = {file.starts_with('-') ? "./" + file : file};
  for (const std::string& value : overrides) words.insert(words.end(), {"--set", value});
  if (work != "runs") words.insert(words.end(), {"--work", work});
  for (const std::string& method : methods) words.insert(words.end(), {"--only", method});
  if (!seeds.empty())
    words.insert(words.end(), {"--seeds", fmt::format("{}", fmt::join(seeds, ","))});
  return words;
}

void print_findings(const Findings& findings) {
  for (const Finding& finding : findings) fmt::print(stderr, "{}\n", text_of(finding));
}

void print_warning(std::string what) { print_findings({warning(std::move(what))}); }

void print_warnings(const std::string& program, const Plan& plan) {
  const Study& study = plan.study;
  const sim::SimulatorInfo& info = plan.source->info();
  const std::string recording = study.places.of("target.recording").str();
  const bool replays = study.target.recording && study.source().gives_motion;
  Findings found;
  if (replays) add(found, warnings_of(plan.target), recording);
  if (study.target.observation) {
    add(found, warnings_of_observation(*study.target.observation),
        study.places.of("target.observation").str());
  }
  append(found, warnings_of(study, info));
  add(found, find_unused_actions(plan), recording);
  append(found, find_replaced_report(plan));
  report_findings(program, found);
}

bool print_verdicts(const Plan& plan) {
  constexpr std::size_t most = 3;  // findings of a method
  bool any_failed = false;
  for (const CheckSummary& summary : read_check_summaries(plan.nodes.back())) {
    fmt::print("\n");
    print_prose(words_of(summary));
    if (const std::string trust = trust_of(summary); !trust.empty()) print_prose("  " + trust);
    const std::size_t count = std::min(summary.reasons.size(), most);
    for (const Finding& reason : summary.reasons | std::views::take(count)) {
      std::string before = "  " + reason.where + ": ";
      for (const std::string& line : lines_of(reason)) {
        print_prose(std::exchange(before, "    ") + line);
      }
    }
    const std::size_t left_out = summary.reasons.size() - count;
    if (left_out > 0) fmt::print("  {} more in the report\n", left_out);
    any_failed |= !summary.failed.empty();
  }
  fmt::print("\n");
  print_line("report: {}", report_path(plan).string());
  return any_failed;
}

void print_verdicts_if_made(const Plan& plan) {
  if (!report_is_current(plan, plan.nodes.back())) return;
  fmt::print("\n");
  for (const CheckSummary& summary : read_check_summaries(plan.nodes.back())) {
    print_prose(words_of(summary));
  }
  print_line("report: {}", report_path(plan).string());
}

void warn_of_failed_checks(const Plan& plan, const std::string& method) {
  const std::optional<CheckSummary> checks = reported_checks(plan, method);
  if (!checks && !plan.study.diagnose_of(plan.study.method(method)).checks.empty()) {
    fmt::print(stderr, "note: no report says whether the checks of {} pass; make it: {}\n",
               printable_line(method), printable_line(plan.command()));
  }
  if (!checks || checks->failed.empty()) return;
  print_warning(printable_line(words_of(*checks) +
                               "; what was found and what to do: " + report_path(plan).string()));
}

void add_until_option(CLI::App& app, std::optional<Stage>& until, const std::string& doc) {
  const auto parse = [&until](const std::string& name) {
    until = value_named<Stage>(name);
    if (until) return;
    throw CLI::ValidationError("--until", unknown_name("stage", name, names_of<Stage>()));
  };
  set_choices(*app.add_option_function<std::string>("--until", parse, doc), names_of<Stage>());
}

std::string size_text(std::uintmax_t bytes) {
  if (bytes < 1024) return fmt::format("{} B", bytes);
  auto value = static_cast<double>(bytes);
  for (const char* unit : {"KiB", "MiB", "GiB"}) {
    value /= 1024.0;
    if (value < 1024.0) return fmt::format("{:.1f} {}", value, unit);
  }
  return fmt::format("{:.1f} TiB", value / 1024.0);
}

void print_json(const nlohmann::ordered_json& json) {
  constexpr auto replace = nlohmann::ordered_json::error_handler_t::replace;
  const std::string text = json.dump(2, ' ', false, replace);
  fmt::print("{}\n", printable(text) == text ? text : json.dump(2, ' ', true, replace));
}

void add_seed_option(CLI::App& app, const std::string& name, std::uint64_t& seed,
                     const std::string& doc) {
  const auto parse = [&seed, name](const std::string& text) {
    const auto count = parse_count(text);
    if (!count) {
      throw CLI::ValidationError(must_be(name, quoted(text), "a whole number from 0 to 2^63 - 1"));
    }
    seed = static_cast<std::uint64_t>(*count);
  };
  app.add_option_function<std::string>(name, parse, doc)
      ->default_str(std::to_string(seed))
      ->type_name("UINT");
}

void require_new_file(const std::filesystem::path& output, bool force) {
  if (output.empty()) throw InputError("--output is empty, must be the name of a file");
  std::error_code error;
  if (!std::filesystem::exists(output, error)) return;
  if (!force) {
    throw InputError(output.string() + ": is there already; choose another name or add --force");
  }
  const std::string signature = "\x89HDF\r\n\x1a\n";
  std::string beginning(signature.size(), '\0');
  std::ifstream file(output, std::ios::binary);
  file.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  if (std::filesystem::is_regular_file(output, error) && beginning != signature) {
    throw InputError(output.string() +
                     ": isn't an HDF5 file, which alone --force replaces; choose another name");
  }
}

std::vector<Index> parse_ranges(const std::string& text) {
  const auto fail = [&] {
    throw InputError("'" + text + "' is no list of numbers and ranges such as 0-3,7");
  };
  std::vector<Index> values;
  for (const std::string& part : split(text, ',')) {
    const std::size_t dash = part.find('-');
    const auto first = parse_count(part.substr(0, dash));
    const auto last = dash == std::string::npos ? first : parse_count(part.substr(dash + 1));
    constexpr Index most = 10'000'000;
    if (!first || !last || *last < *first || *last - *first > most) fail();
    for (Index i = 0; i <= *last - *first; ++i) values.push_back(*first + i);
  }
  if (values.empty()) fail();
  return values;
}

}  // namespace npdr::pipeline
