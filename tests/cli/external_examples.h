/// The studies of experiments/external, whose posterior is known, in a folder of their own.
#pragma once

#include <cmath>
#include <cstdlib>

#include "pipeline/store/h5.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {

inline const std::filesystem::path kExamples =
    std::filesystem::path(NPDR_SOURCE_DIR) / "experiments" / "external";

class External : public CommandTest {
 protected:
  External() { std::filesystem::copy(kExamples, folder_.path()); }

  void run_well(const std::vector<std::string>& words) const { npdr(0, joined({"run"}, words)); }
  // dataset.h5 of the example.
  Outcome import_dataset() const {
    const std::string folder = folder_.path().string();
    EXPECT_EQ(std::system(("sh " + folder + "/make_dataset.sh " + folder).c_str()), 0);
    return npdr(0, {"import", "--theta", "theta.csv", "--x", "x.csv", "-o", "dataset.h5"});
  }
  // By what a shell makes of theta.csv and x.csv.
  void change_dataset(const std::string& command) const {
    EXPECT_EQ(std::system(("cd '" + folder_.path().string() + "' && " + command).c_str()), 0);
    npdr(0, {"import", "--theta", "theta.csv", "--x", "x.csv", "-o", "dataset.h5", "--force"});
  }
  h5::File artefact(const std::string& study, const std::string& name) const {
    return h5::File::open(folder_ / "runs" / study / "npe-gaussian/seed-1/round-1" /
                          (name + ".h5"));
  }
  std::string table(const std::string& study, const std::string& name) const {
    return text_of(folder_ / "runs" / study / "tables" / (name + ".md"));
  }

  // The exact posterior has the mean (2/3, 2/9) and the deviation 1/3 (linear_gaussian.py). That of
  // 1000 simulations misses the mean by about 1/3 / sqrt(800) per coefficient of its regression,
  // and 1000 samples of it by 1/3 / sqrt(1000): 0.02 together, so that six times as much is a false
  // alarm in 10^8. The relative error of a deviation is sqrt(1/2) of that of a mean in its units.
  void expect_exact_posterior(const std::string& study) const {
    const RowMatrix theta = artefact(study, "evaluate").read_matrix<double>("theta");
    const double expected[] = {2.0 / 3.0, 2.0 / 9.0};
    for (Index d = 0; d < 2; ++d) {
      const Vector column = theta.col(d);
      const double mean = column.mean();
      const double deviation = std::sqrt((column.array() - mean).square().mean());
      EXPECT_NEAR(mean, expected[d], 0.12) << study << ", parameter " << d;
      EXPECT_NEAR(deviation, 1.0 / 3.0, 0.07) << study << ", parameter " << d;
    }
  }

  // Rows of `study` with this status; all others have the values of the study without bad rows.
  Index num_rows_lost(const std::string& study, std::uint8_t status) const {
    const h5::File some = artefact(study, "simulate"), all = artefact("external-shell", "simulate");
    const auto statuses = some.dataset("status").read<std::uint8_t>();
    const RowMatrixF x = some.read_matrix<float>("x"), whole = all.read_matrix<float>("x");
    EXPECT_EQ(some.read_matrix<double>("theta"), all.read_matrix<double>("theta"));
    Index num_lost = 0;
    for (Index i = 0; i < x.rows(); ++i) {
      const std::uint8_t found = statuses[static_cast<std::size_t>(i)];
      num_lost += found == status;
      EXPECT_TRUE(found == 0 || found == status) << i;
      EXPECT_TRUE(found == 0 ? x.row(i) == whole.row(i) : x.row(i).hasNaN()) << i;
    }
    return num_lost;
  }
};

}  // namespace npdr::pipeline
