/// Parts that all command lines share: the words that name a study, the outermost error handler.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/printable.h"
#include "pipeline/plan/plan.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace npdr::pipeline {

/// Runs `body`; prints what it throws as "program: message". Output that can't be written is an
/// error, too. Returns the exit status.
int guarded_main(const std::string& program, const std::function<ExitStatus()>& body);

/// What a command does, after its words are read.
using Action = std::function<ExitStatus()>;
/// One that is done when `body` returns.
Action done_after(std::function<void()> body);

/// Adds its options to a command.
using OptionAdder = Action(CLI::App& command);

/// A command of `npdr`.
struct Command {
  const char* name;
  const char* doc;
  OptionAdder* add_to;
};

/// Adds `command` to `app`; when it is called, it stores its exit status in `result`.
void add_command(CLI::App& app, const Command& command, int& result);

/// Sets up `app` (version, one help for all), parses, and returns false when help was asked for or
/// the words are wrong; `status` is then what to leave with.
bool parse_command_line(CLI::App& app, int argc, char** argv, int& status);

/// Says what an option's value is one of, for its help and for completion. Who reads the value
/// checks it: with the nearest of the names in its message.
void set_choices(CLI::Option& option, const std::vector<std::string>& choices);
/// Those; none without set_choices().
std::vector<std::string> choices_of(const CLI::Option& option);

/// A study, as named on a command line.
struct StudyArguments {
  std::string file;
  std::vector<std::string> overrides;  ///< --set
  std::string work = "runs";
  std::vector<std::string> methods;  ///< --only, or --method
  std::vector<std::uint64_t> seeds;

  void add_to(CLI::App& app);
  /// Options for the study's keys and its work folder.
  void add_settings_to(CLI::App& app);
  /// All options without the file.
  void add_selection_to(CLI::App& app);
  /// `site`: see read_study().
  Plan plan(const ClusterConfig& site = {}) const;
  /// The same; prints a warning where the study's results are beside its file and not here.
  Plan plan_here(const std::string& program) const;
  /// The words that name the same study to another executable.
  std::vector<std::string> words() const;
};

/// Prints findings on stderr, as text_of(), or one warning.
void print_findings(const Findings& findings);
void print_warning(std::string what);

/// Prints what in the plan's study is probably not what was meant, as "program: place: warning".
void print_warnings(const std::string& program, const Plan& plan);

/// Prints the verdicts of a study whose report is current, with why checks failed and what to do,
/// and where the report lies. Returns whether any check failed. Throws as read_check_summaries().
bool print_verdicts(const Plan& plan);

/// Prints a verdict of one line for each method and the report's place if the report is current.
/// Throws as read_check_summaries().
void print_verdicts_if_made(const Plan& plan);

/// Warns on stderr where the report (reported_checks()) says that `method` fails checks, and notes
/// where there are some, but no report of them.
void warn_of_failed_checks(const Plan& plan, const std::string& method);

/// --until STAGE. `doc`: what the stage is to the command.
void add_until_option(CLI::App& app, std::optional<Stage>& until, const std::string& doc);

/// Prints a line, of which much is text from files.
template <class... T>
void print_line(fmt::format_string<T...> format, T&&... values) {
  fmt::print("{}\n", printable_line(fmt::format(format, std::forward<T>(values)...)));
}

/// "512 B", "3.4 KiB", "1.2 GiB".
std::string size_text(std::uintmax_t bytes);

/// Prints `json` for programs: bytes of file names that aren't UTF-8 are replaced, all but ASCII is
/// escaped where any of it isn't printable.
void print_json(const nlohmann::ordered_json& json);

/// An option for a seed: digits only, below 2^63, so that no other number means the same. `doc`:
/// what it does, where its name doesn't say it.
void add_seed_option(CLI::App& app, const std::string& name, std::uint64_t& seed,
                     const std::string& doc = "");

/// Throws InputError for an empty name, and where the file is there already; with --force (`force`)
/// where it is no HDF5 file: a study or a program is never replaced.
void require_new_file(const std::filesystem::path& output, bool force);

/// "0-3,7" as {0, 1, 2, 3, 7}. Throws InputError.
std::vector<Index> parse_ranges(const std::string& text);

}  // namespace npdr::pipeline
