// How often a study's posteriors hold the truth: the study is repeated with simulated recordings,
// each of another truth.
//
//   bench_truths experiments/pendulum.toml --count 200
//
// Truths are drawn from the study's own prior, where posteriors that are right pass, or from that
// of another study of the same simulator (--from), which may have more parameters: effects that the
// fitted model lacks, because it takes their nominal values as known.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <map>

#include "analysis/summary.h"
#include "analysis/table_writers.h"
#include "core/error.h"
#include "inference/diagnostics/sbc.h"
#include "inference/prior.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/run/run_stage.h"

namespace npdr::pipeline {
namespace {

constexpr Index kSamples = 99;  // of a posterior, so that ranks divide by five and ten

struct Options {
  std::filesystem::path study;
  std::filesystem::path from;
  std::vector<std::string> overrides;
  std::vector<std::string> from_overrides;
  std::filesystem::path work = "bench-truths";
  Index count = 20;
  std::uint64_t seed = 1;
};

// Of one method, a row for each truth.
struct Outcome {
  RowMatrix ranks;      // (n, D) of the truth among the samples
  RowMatrix deviation;  // (n, D) of the samples, over that of the prior
};

// Parameters of a truth as an override: what --set would be given. Those that the study takes to be
// other than nominal are the truth's, too.
std::string truth_text(const Study& from, const Vector& theta) {
  std::map<std::string, double> truth = from.simulator.parameters;
  for (std::size_t d = 0; d < from.prior.size(); ++d) {
    truth[from.prior[d].name] = theta(static_cast<Index>(d));
  }
  std::string text;
  for (const auto& [name, value] : truth) {
    text += fmt::format("{}{} = {:.17g}", text.empty() ? "" : ", ", name, value);
  }
  return "target.truth={ " + text + " }";
}

Plan plan_of(const Options& options, const std::string& truth, Index number) {
  std::vector<std::string> overrides = options.overrides;
  overrides.push_back(truth);
  overrides.emplace_back("evaluate.leave_out=0");
  overrides.push_back(fmt::format("target.seed={}", options.seed + number));
  overrides.push_back(fmt::format("study.seeds=[{}]", options.seed + number));
  return make_plan(read_study(options.study, overrides),
                   WorkFolder(options.work / fmt::format("truth-{}", number + 1)));
}

// The truth's value of each parameter of the prior.
Vector truth_of(const Plan& plan) {
  const ParameterMap& parameters = plan.source->parameters();
  return parameters.pick_one(parameters.nominal(*plan.study.target.truth));
}

Vector deviation_of(const RowMatrix& samples) {
  Vector deviation(samples.cols());
  for (Index d = 0; d < samples.cols(); ++d) {
    deviation(d) = analysis::summarize(samples.col(d)).std;
  }
  return deviation;
}

void judge(const Plan& plan, Index number, std::map<std::string, Outcome>& outcomes,
           const Options& options) {
  const Vector truth = truth_of(plan);
  const inference::Prior prior(plan.study.prior);
  const Vector prior_deviation = deviation_of(inference::sample_prior(prior, 10'000, options.seed));
  for (const Node& node : plan.nodes) {
    if (node.stage <= Stage::infer) run_stage(plan, node);
  }
  for (const MethodConfig& method : plan.study.methods) {
    const Use use{.method = method.name,
                  .seed = plan.study.seeds.front(),
                  .round = method.algorithm.num_rounds};
    const RowMatrix samples = read_posterior(plan.node(Stage::infer, use))
                                  ->sample(kSamples, {use.seed, "posterior", 1, 0, 0});
    Outcome& outcome = outcomes[method.name];
    if (number == 0) {
      outcome.ranks.resize(options.count, truth.size());
      outcome.deviation.resize(options.count, truth.size());
    }
    const std::vector<Index> ranks = inference::ranks(samples, truth);
    for (Index d = 0; d < truth.size(); ++d) {
      outcome.ranks(number, d) = static_cast<double>(ranks[static_cast<std::size_t>(d)]);
    }
    outcome.deviation.row(number) =
        deviation_of(samples).cwiseQuotient(prior_deviation).transpose();
  }
}

// Share of the truths whose rank lies in the middle of 100 places, `level` of them.
double share_within(const Vector& ranks, double level) {
  const auto is_within = ((ranks.array() + 0.5) / (kSamples + 1.0) - 0.5).abs() < 0.5 * level;
  return is_within.cast<double>().mean();
}

inference::Sbc test(const Outcome& outcome, std::uint64_t seed) {
  RowMatrix spread(outcome.ranks.rows(), outcome.ranks.cols());
  for (Index d = 0; d < spread.cols(); ++d) {
    std::vector<Index> ranks;
    for (const double rank : outcome.ranks.col(d)) ranks.push_back(static_cast<Index>(rank));
    const StreamId id{seed, "bench_truths", static_cast<std::uint64_t>(d), 0, 0};
    spread.col(d) = inference::spread_ranks(ranks, kSamples, id);
  }
  return inference::test_sbc(spread);
}

void print(const std::string& method, const Outcome& outcome,
           const std::vector<inference::Marginal>& prior, std::uint64_t seed) {
  const inference::Sbc sbc = test(outcome, seed);
  analysis::Table table;
  table.name = folder_slug(method);
  table.caption = fmt::format("{}, {} truths: p = {:.3f} that ranks are as uneven by chance.",
                              method, outcome.ranks.rows(), sbc.p_value);
  table.row_header = "Parameter";
  table.columns = {"50 % hold it", "90 % hold it", "deviation / prior's", "p"};
  const auto add = [&](const std::string& label, const auto& ranks, double width, double p) {
    const Vector all = ranks.reshaped();
    table.rows.push_back({label,
                          {fmt::format("{:.2f}", share_within(all, 0.5)),
                           fmt::format("{:.2f}", share_within(all, 0.9)),
                           fmt::format("{:.3f}", width), fmt::format("{:.3f}", p)}});
  };
  for (Index d = 0; d < outcome.ranks.cols(); ++d) {
    add(prior[static_cast<std::size_t>(d)].name, outcome.ranks.col(d),
        outcome.deviation.col(d).mean(), sbc.parameter_p_value(d));
  }
  add("all", outcome.ranks, outcome.deviation.mean(), sbc.p_value);
  std::cout << analysis::to_markdown(table) << '\n';
}

void run_bench(const Options& options) {
  const Study study = read_study(options.study, options.overrides);
  const Study from =
      options.from.empty() ? study : read_study(options.from, options.from_overrides);
  const RowMatrix truths =
      inference::sample_prior(inference::Prior(from.prior), options.count, options.seed);
  std::map<std::string, Outcome> outcomes;
  for (Index i = 0; i < options.count; ++i) {
    const Plan plan = plan_of(options, truth_text(from, truths.row(i).transpose()), i);
    judge(plan, i, outcomes, options);
    std::filesystem::remove_all(options.work / fmt::format("truth-{}", i + 1));
    fmt::print(stderr, "{} of {} truths\n", i + 1, options.count);
  }
  for (const auto& [method, outcome] : outcomes) print(method, outcome, study.prior, options.seed);
}

}  // namespace
}  // namespace npdr::pipeline

int main(int argc, char** argv) {
  using namespace npdr;
  pipeline::Options options;
  CLI::App app("How often posteriors hold the truth of simulated recordings");
  app.add_option("study", options.study, "a study file; its target is replaced")->required();
  app.add_option("--count", options.count, "truths")->check(CLI::Range(2, 100'000));
  app.add_option("--from", options.from, "study whose prior truths are drawn from; else the same");
  app.add_option("--set", options.overrides, "KEY=VALUE of the study, as of npdr run");
  app.add_option("--from-set", options.from_overrides, "the same of the other study");
  app.add_option("--work", options.work, "folder for what is made, and removed again");
  app.add_option("--seed", options.seed, "of everything random");
  CLI11_PARSE(app, argc, argv);
  try {
    pipeline::run_bench(options);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
