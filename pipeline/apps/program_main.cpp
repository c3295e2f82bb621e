// What all programs begin and end with: standard streams, help, words of failure.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>
#include <sstream>
#include <system_error>

#include "core/error.h"
#include "core/file_error.h"
#include "core/text.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/process/build_info.h"
#include "pipeline/process/fitted_text.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

// Flushes explicitly: a write that fails only at exit would be lost without a word.
void flush_output() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  throw std::system_error(errno, std::generic_category(), "can't write to standard output");
}

// Where a launcher has closed a standard stream, a file of ours would get its number, and what is
// printed with it. Nothing can be read from these, or written to them.
void fill_standard_streams() {
  int file = -1;
  do {
    file = open("/dev/null", O_RDONLY | O_CLOEXEC);
  } while (file >= 0 && file <= STDERR_FILENO);
  if (file >= 0) close(file);
}

// Signals that a launcher may have left in another way than we need them.
void choose_signals() {
  std::signal(SIGCHLD, SIG_DFL);  // or no child could be waited for
  std::signal(SIGPIPE, SIG_IGN);  // who read the progress may die before the work is saved
  std::signal(SIGXFSZ, SIG_IGN);  // the write that goes beyond 'ulimit -f' fails, and is reported
}

constexpr int kNameColumns = 34;  // of 80
constexpr int kWordColumns = 80 - kNameColumns;
constexpr std::size_t kMostChoices = 4;  // that stand beside an option's name

bool has_many_choices(const CLI::Option& option) {
  return choices_of(option).size() > kMostChoices;
}

// CLI11 lists all words that it has no place for, and says that a command is missing where one is
// unknown.
std::string cause_of(const CLI::App& command, const CLI::Error& error) {
  std::vector<std::string> commands, options;
  for (const CLI::App* below : command.get_subcommands({})) commands.push_back(below->get_name());
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  }
  for (const std::string& word : command.remaining()) {
    const std::string name = word.substr(0, word.find('='));
    if (name.starts_with('-')) return unknown_name("option", name, options);
    if (!commands.empty()) return unknown_name("command", word, commands);
  }
  return error.what();
}

// Help of at most 80 columns: descriptions break into lines, and long lists of choices stand in
// them.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(kNameColumns); }

  std::string make_option_opts(const CLI::Option* option) const override {
    if (!has_many_choices(*option)) return CLI::Formatter::make_option_opts(option);
    return option->get_positional() ? "" : " NAME";
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    std::string words = option->get_description();
    if (has_many_choices(*option)) {
      words += (words.empty() ? "" : ": ") + join(choices_of(*option));
    }
    return wrapped(words, kWordColumns);
  }

  std::string make_subcommand(const CLI::App* command) const override {
    std::stringstream out;
    CLI::detail::format_help(out, command->get_name(),
                             wrapped(command->get_description(), kWordColumns), get_column_width());
    return out.str();
  }
};

// "npdr run: unknown option '--sed' (did you mean '--set'?); options and examples: npdr help run"
std::string words_of_failure(const CLI::App* app, const CLI::Error& error) {
  const auto called = app->get_subcommands();
  const bool is_front_door = !app->get_subcommands({}).empty();
  if (is_front_door && called.empty()) {
    return fmt::format(
        "{}: {}; 'npdr new NAME' begins a study, 'npdr run STUDY' brings one up to date, 'npdr "
        "help' lists all commands\n",
        app->get_name(), app->remaining().empty() ? "no command" : cause_of(*app, error));
  }
  const CLI::App& command = called.empty() ? *app : *called.front();
  return fmt::format(
      "{}: {}; options and examples: {}\n",
      called.empty() ? app->get_name() : "npdr " + command.get_name(), cause_of(command, error),
      called.empty() ? app->get_name() + " --help" : "npdr help " + command.get_name());
}

}  // namespace

int guarded_main(const std::string& program, const std::function<ExitStatus()>& body) {
  std::string message;
  ExitStatus failure = ExitStatus::failed;
  try {
    const ExitStatus status = body();
    if (status == ExitStatus::done) flush_output();
    return static_cast<int>(status);
  } catch (const Error& error) {
    message = error.what();
    failure = error.status();
  } catch (const std::filesystem::filesystem_error& error) {
    message = file_error_text(error.path1(), "be looked at", error.code().value());
  } catch (const std::system_error& error) {
    // `npdr ... | head`: who closes the pipe has seen enough.
    if (error.code() == std::errc::broken_pipe) return static_cast<int>(failure);
    message = error.what();
  } catch (const std::bad_alloc&) {
    message = "memory is used up; ask for less at once, or give it more";
  } catch (const std::exception& error) {
    message = error.what();
  }
  report_error(program, message);
  return static_cast<int>(failure);
}

Action done_after(std::function<void()> body) {
  return [body = std::move(body)] {
    body();
    return ExitStatus::done;
  };
}

void add_command(CLI::App& app, const Command& command, int& result) {
  CLI::App* added = app.add_subcommand(command.name, command.doc);
  const std::string program = fmt::format("npdr {}", command.name);
  added->callback([&result, program, action = command.add_to(*added)] {
    result = guarded_main(program, action);
  });
}

bool parse_command_line(CLI::App& app, int argc, char** argv, int& status) {
  fill_standard_streams();
  choose_signals();
  app.set_version_flag("--version", fmt::format("npdr {} ({})", creator_version(), git_revision()));
  const auto formatter = std::make_shared<HelpFormatter>();
  app.formatter(formatter);
  for (CLI::App* command : app.get_subcommands({})) command->formatter(formatter);
  app.failure_message(words_of_failure);
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::ParseError& error) {
    // Help and version are no errors, but output.
    status = guarded_main(app.get_name(), [&] {
      return app.exit(error) != 0 ? ExitStatus::invalid_input : ExitStatus::done;
    });
    return false;
  }
}

}  // namespace npdr::pipeline
