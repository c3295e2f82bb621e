#include "pipeline/report/chain_files.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "pipeline/report/inference_chains.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

constexpr const char* kGetdistEnd = ".txt";

// Blanks and commas are between columns.
std::string column_name(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return c == ' ' || c == '\t' || c == ','; }, '_');
  return name;
}

std::string lines_of(const Evaluation& chain, double sign, const char* separator,
                     const std::string& before) {
  std::string text;
  for (Index i = 0; i < chain.theta.rows(); ++i) {
    text += fmt::format("{}{}{}{}\n", before, sign * chain.log_prob(i), separator,
                        fmt::join(chain.theta.row(i), separator));
  }
  return text;
}

std::string latex_of(const Study& study, const std::string& name) {
  const auto& symbols = study.report.symbols;
  if (const auto symbol = symbols.find(name); symbol != symbols.end()) return symbol->second;
  std::string words = "\\mathrm{";
  for (const char c : name) words += c == '_' || c == ' ' ? "\\ " : std::string(1, c);
  return words + "}";
}

std::string bound(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "N"; }

// What stands beside the chains: a line for each parameter.
std::string names_text(const Study& study) {
  std::string text;
  for (const Marginal& parameter : study.prior) {
    text += fmt::format("{} {}\n", column_name(parameter.name), latex_of(study, parameter.name));
  }
  return text;
}

std::string ranges_text(const Study& study) {
  std::string text;
  for (const Marginal& parameter : study.prior) {
    text += fmt::format("{} {} {}\n", column_name(parameter.name), bound(parameter.lower()),
                        bound(parameter.upper()));
  }
  return text;
}

std::string cmdstan_head(const Study& study, const Chains& chains, std::size_t chain) {
  std::string text = fmt::format(
      "# method = sample\n# num_samples = {}\n# num_warmup = 0\n"
      "# save_warmup = 0\n# thin = 1\n# id = {}\nlp__",
      chains.num_draws(), chain + 1);
  for (const Marginal& parameter : study.prior) text += "," + column_name(parameter.name);
  return text + "\n";
}

std::string chain_file(const std::string& root, std::size_t chain, const std::string& end) {
  return fmt::format("{}_{}{}", root, chain, end);
}

// The first that is there of the files that are written, and of those that would be read as one
// chain more.
void require_absent(const std::string& root, std::size_t num_chains, const std::string& end) {
  std::vector<std::string> files = {root + end};
  for (std::size_t k = 1; k <= num_chains + 1; ++k) files.push_back(chain_file(root, k, end));
  if (end == kGetdistEnd) files.insert(files.end(), {root + ".paramnames", root + ".ranges"});
  for (const std::string& file : files) {
    std::error_code unreadable;
    if (!std::filesystem::exists(file, unreadable)) continue;
    throw InputError(file +
                     " is there already, and would be overwritten, or read as one more "
                     "chain; remove it or choose another name");
  }
}

// Writes files; those that it has written go again when one can't be.
class FileSet {
 public:
  void write(const std::string& file, const std::string& text) {
    try {
      write_text_file(file, text);
    } catch (...) {
      std::error_code ignored;
      for (const std::string& written : files_) std::filesystem::remove(written, ignored);
      throw;
    }
    files_.push_back(file);
  }
  const std::vector<std::string>& files() const { return files_; }

 private:
  std::vector<std::string> files_;
};

}  // namespace

std::vector<std::string> write_chain_files(const Plan& plan, const std::string& root,
                                           ExportFormat format) {
  const Chains chains = find_chains(plan);
  const bool is_getdist = format == ExportFormat::getdist;
  const std::string end = is_getdist ? kGetdistEnd : ".csv";
  require_absent(root, chains.seeds.size(), end);
  FileSet set;
  for (std::size_t k = 0; k < chains.seeds.size(); ++k) {
    const Evaluation& chain = chains.evaluations[k];
    set.write(chain_file(root, k + 1, end),
              is_getdist ? lines_of(chain, -1.0, " ", "1 ")
                         : cmdstan_head(plan.study, chains, k) + lines_of(chain, 1.0, ",", ""));
  }
  if (is_getdist) {
    set.write(root + ".paramnames", names_text(plan.study));
    set.write(root + ".ranges", ranges_text(plan.study));
  }
  return set.files();
}

}  // namespace npdr::pipeline
