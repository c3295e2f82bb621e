/// How commands print their help, and what they say of words that they can't read.
#pragma once

#include <CLI/Formatter.hpp>
#include <string>

namespace npdr::pipeline {

/// Help of at most 80 columns: descriptions break into lines, and long lists of choices stand in
/// them.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();

  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
  std::string make_subcommand(const CLI::App* command) const override;
};

/// "npdr run: unknown option '--sed' (did you mean '--set'?); options and examples: npdr help run"
std::string words_of_failure(const CLI::App* app, const CLI::Error& error);

}  // namespace npdr::pipeline
