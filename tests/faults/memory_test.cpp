#include <fmt/format.h>

#include <cstdlib>

#include "core/random.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

constexpr Index kParameters = 2;
constexpr Index kFeatures = 200;

// theta uniform, x uniform: how they hang together doesn't matter here.
void write_dataset(const std::filesystem::path& folder, Index num_rows) {
  h5::File file = h5::File::create(folder / "data.h5");
  RowMatrix theta(num_rows, kParameters);
  RowMatrixF x(num_rows, kFeatures);
  Stream stream({1, "memory_test", 0, 0, 0});
  for (double& value : theta.reshaped()) value = stream.uniform();
  for (float& value : x.reshaped()) value = static_cast<float>(stream.uniform());
  file.write("theta", theta, {.deflate = 0})
      .set_attribute("labels", std::vector<std::string>{"a", "b"});
  file.write("x", x, {.deflate = 0});
  file.close();
  h5::File observed = h5::File::create(folder / "x_o.h5");
  observed.write("x", RowMatrix(RowMatrix::Constant(1, kFeatures, 0.5)));
  observed.close();
}

std::string study(Index num_rows) {
  return dataset_study("memory")
      .with("target", {"observation = \"x_o.h5\""})
      .with("simulate", {"shard_size = 5000"})
      .method("MoG", {fmt::format("num_simulations = {}", num_rows), kSmallMixture,
                      "training = { max_epochs = 1, batch_size = 500 }"})
      .with("evaluate", {"num_samples = 50"});
}

// Peaks of each stage [bytes].
std::vector<double> peaks(Index num_rows, const std::vector<std::string>& programs) {
  const TempFolder folder;
  write_dataset(folder.path(), num_rows);
  std::ofstream(folder.path() / "memory.toml") << study(num_rows);
  std::vector<double> result;
  for (const std::string& program : programs) {
    const Outcome outcome = run(folder.path(), {program, "memory.toml"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    result.push_back(1024.0 * static_cast<double>(outcome.peak_kib));
  }
  return result;
}

// Memory that a row may cost: proposals hold theta, simulations the order of a dataset's rows;
// training holds x, and theta as it is, over u, and twice while one is made of the other.
TEST(Memory, GrowsByNoMoreThanThetaAndWhatTrainingHolds) {
  setenv("OMP_NUM_THREADS", "1", 1);
  constexpr Index few = 10'000, many = 40'000;
  constexpr double theta = 8.0 * kParameters, x = 4.0 * kFeatures, row_numbers = 40.0;
  constexpr double slack = 4 << 20;  // caches of HDF5, and pages that the allocator keeps
  const std::vector<std::string> programs = {"npdr-propose", "npdr-simulate", "npdr-infer",
                                             "npdr-evaluate"};
  const std::vector<double> allowed = {3.0 * theta + row_numbers, row_numbers,
                                       x + 5.0 * theta + row_numbers, 0.0};
  const std::vector<double> small = peaks(few, programs), large = peaks(many, programs);
  unsetenv("OMP_NUM_THREADS");
  for (std::size_t i = 0; i < programs.size(); ++i) {
    const double growth = large[i] - small[i];
    fmt::print("{}: {:.0f} MiB of {} rows, {:.0f} MiB of {}\n", programs[i], small[i] / (1 << 20),
               few, large[i] / (1 << 20), many);
    EXPECT_LE(growth, static_cast<double>(many - few) * allowed[i] + slack) << programs[i];
  }
}

}  // namespace
}  // namespace npdr::pipeline
