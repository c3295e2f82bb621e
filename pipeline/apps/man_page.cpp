#include "pipeline/apps/man_page.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "core/text.h"
#include "pipeline/process/build_info.h"

namespace npdr::pipeline {
namespace {

// What man(7) would take for its own: backslashes, hyphens, and a dot or quote at the beginning.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n')) result += "\\&";
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  return result;
}

// "-j, --jobs INT".
std::string title_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  if (option.get_positional()) names.push_back(option.get_name(true));
  const bool has_value = option.get_items_expected_max() > 0 && !option.get_positional();
  return join(names) + (has_value ? " " + option.get_type_name() : "");
}

std::string section_of(const CLI::App& command) {
  std::string text = fmt::format(".SS npdr {}\n{}\n", escaped(command.get_name()),
                                 escaped(command.get_description()));
  for (const CLI::Option* option : command.get_options()) {
    std::string doc = option->get_description();
    if (!option->get_default_str().empty()) doc += " (default " + option->get_default_str() + ")";
    text += fmt::format(".TP\n.B {}\n{}\n", escaped(title_of(*option)), escaped(doc));
  }
  if (!command.get_footer().empty())
    text += ".PP\n.nf\n" + escaped(command.get_footer()) + "\n.fi\n";
  return text;
}

constexpr const char* kEnd = R"(.SH EXIT STATUS
0 done; 1 failed; 2 invalid input; 3 too many failed rollouts; 4 a check failed (npdr run \-\-strict);
75 stopped with everything saved, run it again.
.SH ENVIRONMENT
.TP
.B OMP_NUM_THREADS
threads of a stage's executable that is called alone
.TP
.B NPDR_SITE
file with a table [cluster], for npdr submit
)";

}  // namespace

std::string man_page(CLI::App& app) {
  std::string text = fmt::format(
      ".TH NPDR 1 \"\" \"npdr {}\"\n.SH NAME\nnpdr \\- physics parameters of recorded motion, as a "
      "Bayesian posterior\n.SH SYNOPSIS\n.B npdr\nCOMMAND [OPTIONS]\n.SH DESCRIPTION\n{}\n"
      ".SH COMMANDS\n",
      creator_version(), escaped(app.get_description()));
  for (const CLI::App* command : app.get_subcommands({})) text += section_of(*command);
  return text + kEnd;
}

}  // namespace npdr::pipeline
