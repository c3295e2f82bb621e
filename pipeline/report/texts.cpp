#include "pipeline/report/texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

#include "core/shell_text.h"
#include "core/text.h"
#include "pipeline/findings/findings.h"

namespace npdr::pipeline {
namespace {

std::string posterior_of(const ReportData& data, const std::string& method) {
  const Use& use = data.runs_of(method).front()->use;
  return link_of(data.plan, data.plan.node(Stage::infer, use), use).string();
}

}  // namespace

std::string pooling_text(const Study& study) {
  std::vector<std::string> names;
  for (const MethodConfig& method : study.methods) {
    if (method.algorithm.kind == inference::Algorithm::npe_nle) names.push_back(method.name);
  }
  if (names.empty()) return "";
  return fmt::format(
      "{} combine{} two kinds of neural networks that learn from the same simulations: one says "
      "which parameters explain the observation (neural posterior estimation, NPE), the other to "
      "which observation parameters lead (neural likelihood estimation, NLE). Each counts as much "
      "as it has proved to predict simulations that neither had seen: its power in the table of "
      "experiments. Where the powers add up to more than 1, both together are narrower than each, "
      "which such simulations bore out.",
      join(names, names.size() == 2 ? " and " : ", "), names.size() == 1 ? "s" : "");
}

std::string next_steps(const ReportData& data) {
  std::map<std::string, CheckSummary> checks;
  for (const CheckSummary& summary : check_summaries(data)) checks[summary.method] = summary;
  std::string text = fmt::format("# Posteriors, seed {}\n", data.seeds.front());
  for (const std::string& method : data.methods) {
    const std::string words = checks.contains(method) ? words_of(checks[method]) : method;
    text += fmt::format("{}    # {}\n", posterior_of(data, method), words);
  }
  // That of which the fewest checks fail, then can't tell, of those that were checked at all.
  const std::string best =
      *std::ranges::min_element(data.methods, {}, [&](const std::string& method) {
        const auto found = checks.find(method);
        if (found == checks.end()) return std::tuple(true, std::size_t{0}, std::size_t{0});
        return std::tuple(false, found->second.failed.size(), found->second.unknown.size());
      });
  if (checks.contains(best) && !checks[best].failed.empty()) {
    text += fmt::format(
        "\n# Checks of {} fail: do first what the verdicts say; its draws may be wrong\n", best);
  }
  return text + fmt::format(
                    "\n# Domain parameters for a simulator of yours: 1000 draws of the posterior, "
                    "one a line\n"
                    "npdr sample {} -n 1000 > theta.csv\n"
                    "\n# In Python, a new one for each training episode\n"
                    "import numpy as np\n"
                    "header = open(\"theta.csv\").readline().strip()\n"
                    "names = [name.split(\" [\")[0] for name in header.split(\",\")]\n"
                    "theta = np.loadtxt(\"theta.csv\", delimiter=\",\", skiprows=1, ndmin=2)\n"
                    "rng = np.random.default_rng(1)\n"
                    "for episode in range(100):\n"
                    "    parameters = dict(zip(names, rng.choice(theta)))\n",
                    shell_word(posterior_of(data, best)));
}

}  // namespace npdr::pipeline
