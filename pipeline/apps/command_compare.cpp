// The command that compares two sets of samples: how far apart are two posteriors?
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/feature_names.h"
#include "core/printable.h"
#include "inference/diagnostics/c2st.h"
#include "inference/diagnostics/mmd.h"
#include "inference/diagnostics/two_samples.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/outside_file.h"

namespace npdr::pipeline {
namespace {

struct CompareArguments {
  std::string first, second;
  std::vector<std::string> datasets = {"theta"};  ///< one for both, or one for each
  Index most_rows = 10'000;
  std::uint64_t seed = 0;
  bool json = false;
};

struct Comparison {
  SampleSet first, second;
  inference::C2st c2st;
  inference::Mmd mmd;
};

Index smaller_size(const CompareArguments& arguments, const SampleSet& first,
                   const SampleSet& second) {
  for (const SampleSet* set : {&first, &second}) {
    if (set->rows.rows() >= inference::kFewestRowsOfSample) continue;
    throw InputError(fmt::format("{}: {} rows, must be at least {}", set->where, set->rows.rows(),
                                 inference::kFewestRowsOfSample));
  }
  return std::min({arguments.most_rows, first.rows.rows(), second.rows.rows()});
}

Comparison compare(const CompareArguments& arguments) {
  const StreamId id{arguments.seed, "compare_rows", 0, 0, 0};
  SampleSet first =
      read_sample_set(arguments.first, arguments.datasets.front(), arguments.most_rows, id);
  SampleSet second = in_order_of(
      first, read_sample_set(arguments.second, arguments.datasets.back(), arguments.most_rows, id));
  const Index n = smaller_size(arguments, first, second);
  for (SampleSet* set : {&first, &second}) {
    set->rows = set->rows(spread_positions(n, set->rows.rows(), id), Eigen::all).eval();
  }
  const inference::C2st c2st =
      inference::c2st(first.rows, second.rows, {arguments.seed, "c2st", 0, 0, 0});
  const inference::Mmd mmd =
      inference::mmd(first.rows, second.rows, {arguments.seed, "mmd", 0, 0, 0});
  return {std::move(first), std::move(second), c2st, mmd};
}

// Calls visit(name, moments of the first, of the second).
template <class Visit>
void for_each_column(const Comparison& c, const Visit& visit) {
  const auto& names = c.first.columns.empty() ? c.second.columns : c.first.columns;
  const auto first = inference::column_moments(c.first.rows);
  const auto second = inference::column_moments(c.second.rows);
  for (std::size_t d = 0; d < first.size(); ++d) {
    visit(names.empty() ? Channel{fmt::format("column {}", d + 1), "1"} : names[d], first[d],
          second[d]);
  }
}

void print_as_json(const Comparison& c) {
  nlohmann::ordered_json json = {
      {"first", c.first.where},
      {"second", c.second.where},
      {"num_rows", c.first.rows.rows()},
      {"num_repeated_rows",
       {inference::num_repeated_rows(c.first.rows), inference::num_repeated_rows(c.second.rows)}},
      {"c2st", {{"accuracy", c.c2st.accuracy}, {"standard_error", c.c2st.standard_error}}},
      {"mmd",
       {{"squared", c.mmd.squared}, {"p_value", c.mmd.p_value}, {"bandwidth", c.mmd.bandwidth}}}};
  for_each_column(c, [&](const Channel& name, const auto& a, const auto& b) {
    json["parameters"].push_back({{"name", name.label},
                                  {"unit", name.unit},
                                  {"first", {{"mean", a.mean}, {"std", a.deviation}}},
                                  {"second", {{"mean", b.mean}, {"std", b.deviation}}}});
  });
  print_json(json);
}

// A classifier knows rows that it has been taught, and a posterior of weighted particles repeats
// them.
void warn_of_repeats(const SampleSet& set, const char* name) {
  constexpr double many = 0.02;
  const Index repeats = inference::num_repeated_rows(set.rows);
  if (static_cast<double>(repeats) < many * static_cast<double>(set.rows.rows())) return;
  fmt::print(
      "warning: {} of the {} rows picked of {} are copies of others, which C2ST takes for a "
      "difference: take fewer (-n), or draws that are all different\n",
      repeats, set.rows.rows(), name);
}

void print_text(const Comparison& c) {
  print_line("first   {}", c.first.where);
  print_line("second  {}", c.second.where);
  fmt::print("{} rows of each, picked at random where it has more\n", c.first.rows.rows());
  warn_of_repeats(c.first, "the first");
  warn_of_repeats(c.second, "the second");
  fmt::print(
      "\nC2ST   {:.4f} ± {:.4f}  (0.5: can't be told apart, 1: don't overlap; far below 0.5: "
      "rows are in both)\n",
      c.c2st.accuracy, c.c2st.standard_error);
  fmt::print("MMD^2  {:.3g}, p = {:.2g}  (p: as large by chance, when both are the same)\n\n",
             c.mmd.squared, c.mmd.p_value);
  fmt::print("{:<28} {:>11} {:>11} {:>11} {:>11}\n", "", "mean first", "mean second", "std first",
             "std second");
  for_each_column(c, [](const Channel& name, const auto& a, const auto& b) {
    fmt::print("{:<28} {:>11.4g} {:>11.4g} {:>11.4g} {:>11.4g}\n",
               printable_line(feature_name(name)), a.mean, b.mean, a.deviation, b.deviation);
  });
}

}  // namespace

Action compare_command(CLI::App& command) {
  auto arguments = std::make_shared<CompareArguments>();
  command
      .add_option("FIRST", arguments->first,
                  "HDF5 with a dataset (rows, parameters), such as evaluate.h5, or CSV")
      ->required();
  command.add_option("SECOND", arguments->second, "the same")->required();
  command
      .add_option("--dataset", arguments->datasets,
                  "of the HDF5 files: one name for both, or one for each")
      ->expected(1, 2)
      ->capture_default_str();
  command.add_option("-n,--num-samples", arguments->most_rows, "rows of each, at most")
      ->capture_default_str()
      ->check(CLI::Range(inference::kFewestRowsOfSample, Index{1'000'000}));
  add_seed_option(command, "--seed", arguments->seed);
  command.add_flag("--json", arguments->json, "for programs");
  command.footer("Example:\n  npdr compare mine.csv runs/study/npe/seed-1/round-1/evaluate.h5");
  return [arguments] {
    const Comparison comparison = compare(*arguments);
    arguments->json ? print_as_json(comparison) : print_text(comparison);
    return ExitStatus::done;
  };
}

}  // namespace npdr::pipeline
