#include "pipeline/report/next_steps.h"

#include <fmt/format.h>

#include "pipeline/process/shell_text.h"

namespace npdr::pipeline {
namespace {

std::string posterior_of(const ReportData& data, const std::string& method) {
  const Use& use = data.runs_of(method).front()->use;
  return link_of(data.plan, data.plan.node(Stage::infer, use), use).string();
}

}  // namespace

std::string next_steps(const ReportData& data) {
  std::string text = fmt::format("# Posteriors, seed {}\n", data.seeds.front());
  for (const std::string& method : data.methods) {
    text += fmt::format("{}    # {}\n", posterior_of(data, method), method);
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
                    shell_word(posterior_of(data, data.methods.front())));
}

}  // namespace npdr::pipeline
