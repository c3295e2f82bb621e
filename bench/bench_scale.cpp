// How memory and time grow with the number of simulations and of shards.
//
//   bench_scale                        100,000 and 1,000,000 rows of a dataset; 1000 shards
//   bench_scale --rows 20000,80000     other numbers of rows
//
// Every stage runs as a process of its own, as under `npdr run`; its peak of resident memory is
// what the system counted (getrusage).
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "core/random.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr Index kParameters = 5;
constexpr Index kFeatures = 20;

// Where the programs are.
std::string programs = std::string(NPDR_BINARY_DIR) + "/bin";  // NOLINT: an option of this program

struct Cost {
  double seconds = 0.0;
  double peak = 0.0;  // [MiB]
};

// Runs a program of this build in `folder`; its output goes to a file there.
Cost measure(const fs::path& folder, const std::vector<std::string>& words) {
  const auto start = std::chrono::steady_clock::now();
  const std::string path = programs + "/" + words.front();
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder.c_str()) != 0) _exit(127);
    const int output = open("output.txt", O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    execv(path.c_str(), arguments.data());
    _exit(127);
  }
  int status = 0;
  rusage usage = {};
  wait4(child, &status, 0, &usage);
  if (status != 0) {
    std::ifstream output(folder / "output.txt");
    throw Error(fmt::format("{} failed:\n{}", words.front(),
                            std::string(std::istreambuf_iterator<char>(output), {})));
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return {elapsed.count(), static_cast<double>(usage.ru_maxrss) / 1024.0};
}

// theta uniform in (0, 1); x its squares with noise.
void write_dataset(const fs::path& path, Index num_rows) {
  constexpr Index block = 10'000;
  h5::File file = h5::File::create(path);
  h5::Dataset theta = file.create_dataset("theta", h5::ElementType::f64, {num_rows, kParameters});
  h5::Dataset x = file.create_dataset("x", h5::ElementType::f32, {num_rows, kFeatures});
  std::vector<std::string> labels;
  for (Index d = 0; d < kParameters; ++d) labels.push_back(fmt::format("p{}", d));
  theta.set_attribute("labels", labels);
  RowMatrix thetas(block, kParameters);
  RowMatrixF xs(block, kFeatures);
  for (Index begin = 0; begin < num_rows; begin += block) {
    const Index count = std::min(block, num_rows - begin);
    for (Index i = 0; i < count; ++i) {
      Stream stream({1, "bench_scale", 0, static_cast<std::uint64_t>(begin + i), 0});
      for (Index d = 0; d < kParameters; ++d) thetas(i, d) = stream.uniform();
      for (Index f = 0; f < kFeatures; ++f) {
        const double value = thetas(i, f % kParameters);
        xs(i, f) = static_cast<float>(value * value + 0.1 * stream.uniform());
      }
    }
    theta.write_rows<double>(begin, count,
                             {thetas.data(), static_cast<std::size_t>(count * kParameters)});
    x.write_rows<float>(begin, count, {xs.data(), static_cast<std::size_t>(count * kFeatures)});
  }
  file.close();
  h5::File observed = h5::File::create(path.parent_path() / "x_o.h5");
  observed.write("x", RowMatrix(RowMatrix::Constant(1, kFeatures, 0.3)));
  observed.close();
}

std::string study(Index num_rows, Index shard_size, Index num_seeds) {
  std::vector<Index> seeds(static_cast<std::size_t>(num_seeds));
  std::iota(seeds.begin(), seeds.end(), Index{1});
  std::string text = fmt::format(
      "[study]\nname = \"scale\"\nseeds = [{}]\n[target]\nobservation = \"x_o.h5\"\n[simulator]\n"
      "dataset = \"data.h5\"\n[simulate]\nshard_size = {}\n[[method]]\nname = \"MAF\"\n"
      "num_simulations = {}\ndensity_estimator = {{ kind = \"maf\", num_transforms = 2, "
      "hidden_features = 20 }}\ntraining = {{ max_epochs = 2, batch_size = {} }}\n"
      "[evaluate]\nnum_samples = 1000\n[prior]\n",
      fmt::join(seeds, ", "), shard_size, num_rows, std::min<Index>(500, num_rows / 20));
  for (Index d = 0; d < kParameters; ++d) text += fmt::format("p{} = {{ uniform = [0, 1] }}\n", d);
  return text;
}

void measure_memory(const fs::path& folder, const std::vector<Index>& numbers) {
  fmt::print("| rows | stage | seconds | peak, MiB |\n|--:|:--|--:|--:|\n");
  for (const Index num_rows : numbers) {
    fs::remove_all(folder / "runs");
    write_dataset(folder / "data.h5", num_rows);
    std::ofstream(folder / "scale.toml") << study(num_rows, 10'000, 1);
    for (const char* program : {"npdr-propose", "npdr-simulate", "npdr-infer", "npdr-evaluate"}) {
      const Cost cost = measure(folder, {program, "scale.toml"});
      fmt::print("| {} | {} | {:.1f} | {:.0f} |\n", num_rows, program, cost.seconds, cost.peak);
      std::fflush(stdout);
    }
  }
}

// Simulations of `num_shards` shards each.
void measure_plan(const fs::path& folder, Index num_shards, Index num_simulations) {
  fs::remove_all(folder / "runs");
  write_dataset(folder / "data.h5", 2 * num_shards);
  std::ofstream(folder / "scale.toml") << study(2 * num_shards, 2, num_simulations);
  const auto show = [&](const std::string& what, const std::vector<std::string>& words) {
    const Cost cost = measure(folder, words);
    fmt::print("| {} x {} | {} | {:.2f} | {:.0f} |\n", num_simulations, num_shards, what,
               cost.seconds, cost.peak);
    std::fflush(stdout);
  };
  show("plan (npdr run --dry-run)", {"npdr", "run", "scale.toml", "--dry-run"});
  show("npdr run --until simulate", {"npdr", "run", "scale.toml", "--until", "simulate"});
  show("npdr status", {"npdr", "status", "scale.toml"});
  show("npdr status --check", {"npdr", "status", "scale.toml", "--check"});
  for (const auto& entry : fs::directory_iterator(folder / "runs/.cache/simulate")) {
    if (entry.is_regular_file()) fs::remove(entry.path());
  }
  show("npdr status, not joined", {"npdr", "status", "scale.toml"});
  show("npdr-simulate: join all", {"npdr-simulate", "scale.toml"});
  show("npdr-infer", {"npdr-infer", "scale.toml"});
}

}  // namespace
}  // namespace npdr::pipeline

int main(int argc, char** argv) {
  using namespace npdr::pipeline;
  CLI::App app("memory and time for many rows and shards");
  std::vector<npdr::Index> rows = {100'000, 1'000'000};
  std::string folder = ".";
  npdr::Index shards = 1000, simulations = 20;
  app.add_option("--rows", rows, "of the dataset, separated by commas; 0: skip")->delimiter(',');
  app.add_option("--shards", shards, "of each simulation; 0: skip");
  app.add_option("--simulations", simulations, "with so many shards");
  app.add_option("--work", folder, "where its folder 'bench-scale' may be, which is removed");
  app.add_option("--programs", programs, "folder of those to measure: another build's");
  CLI11_PARSE(app, argc, argv);
  try {
    const auto place = std::filesystem::absolute(folder) / "bench-scale";
    std::filesystem::create_directories(place);
    if (rows.front() > 0) measure_memory(place, rows);
    if (shards > 0) {
      fmt::print("\n| simulations x shards | | seconds | peak, MiB |\n|:--|:--|--:|--:|\n");
      measure_plan(place, shards, 1);
      if (simulations > 1) measure_plan(place, shards, simulations);
    }
    std::filesystem::remove_all(place);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_scale: {}\n", error.what());
    return 1;
  }
}
