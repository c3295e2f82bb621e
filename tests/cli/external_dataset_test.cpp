/// Datasets in a simulator's place.
#include "tests/cli/external_examples.h"

namespace npdr::pipeline {
namespace {

class ExternalDataset : public External {
 protected:
  // By what awk does with each row of theta.csv.
  void change_theta(const std::string& action) const {
    change_dataset("awk -F, 'NR > 1 { " + action +
                   "; next } 1' theta.csv > other.csv && mv other.csv theta.csv");
  }
  // Whether copies are found once a shell has changed the files.
  bool notes_copies(const std::string& change) const {
    change_dataset(change);
    run_well({"dataset.toml", "--set", "method.training.max_epochs=3"});
    return has(table("external-dataset", "parameters"), "are copies of others");
  }
};

TEST_F(ExternalDataset, ADatasetNeedsNoSimulator) {
  const Outcome imported = import_dataset();
  EXPECT_TRUE(
      says(imported.out, {"wrote dataset.h5: 1000 rows", "theta a, b", "x total, difference",
                          "\nnext: npdr new NAME --dataset dataset.h5; npdr run"}));
  EXPECT_TRUE(has(npdr({"validate", "dataset.toml"}).out,
                  "1 evaluation of 1000 samples, none of them simulated"));
  EXPECT_TRUE(
      has(npdr({"inspect", "dataset.h5"}).out, "a dataset of 1000 simulations of 2 features"));
  run_well({"dataset.toml"});
  expect_exact_posterior("external-dataset");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "runs/external-dataset/tables/fit.md"));
  EXPECT_FALSE(has(table("external-dataset", "parameters"), "isn't distributed"));
}

// Parameters that a study describes come in its order, which isn't the prior's.
TEST_F(ExternalDataset, ADatasetMayDescribeItsParametersInAnyOrder) {
  import_dataset();
  npdr(0, {"run", "dataset.toml", "--until", "simulate", "--set",
           "simulator.parameter=[{name='b', unit='m'}, {name='a'}]", "--set",
           "prior.a={uniform=[0.0, 9.0]}", "--set", "limits.max_failed_fraction=0.9"});
  const h5::File file = artefact("external-dataset", "simulate");
  const RowMatrix theta = file.read_matrix<double>("theta");
  const auto status = file.dataset("status").read<std::uint8_t>();
  for (Index i = 0; i < theta.rows(); ++i) {
    EXPECT_EQ(status[static_cast<std::size_t>(i)], theta(i, 0) < 0.0 ? 2 : 0) << i;
  }
}

TEST_F(ExternalDataset, ADatasetsUnitsAreThoseOfTheStudy) {
  import_dataset();
  change_dataset("sed -i '1s/.*/a [kg],b [mm]/' theta.csv");
  EXPECT_TRUE(has(npdr({"list", "simulators", "dataset.toml"}).out, "kg"));
  run_well({"dataset.toml", "--until", "infer"});
  const Outcome samples = npdr({"sample", "dataset.toml", "-n", "2"});
  EXPECT_TRUE(samples.out.starts_with("a [kg],b [mm]\n")) << samples.out << samples.err;
  EXPECT_TRUE(has(npdr(2, {"validate", "dataset.toml", "--set",
                           "simulator.parameter=[{name='b', unit='m'}, {name='a'}]"})
                      .err,
                  "unit = 'm', must be 'mm', as in the dataset"));
}

TEST_F(ExternalDataset, UnitsThatAStudyCantHaveAreRefused) {
  import_dataset();
  change_dataset("sed -i \"1s/.*/a [$(printf 'k%.0s' $(seq 200))],b/\" theta.csv");
  EXPECT_TRUE(has(npdr(2, {"validate", "dataset.toml"}).err,
                  {"with 'a' in 'kkk", "must be with units that are"}));
}

// Where it was cut on purpose, the rest is left out.
TEST_F(ExternalDataset, RowsOutsideOfThePriorAreNamed) {
  import_dataset();
  EXPECT_TRUE(has(npdr(3, {"run", "dataset.toml", "--set", "prior.a={uniform=[8.0, 9.0]}"}).err,
                  {"of the dataset, 'a' = ", "outside of the prior, [8, 9]",
                   "left out under a higher limits.max_failed_fraction"}));
}

TEST_F(ExternalDataset, ADatasetOfAnotherPriorIsNoticed) {
  import_dataset();
  run_well({"dataset.toml", "--set", "prior.a.normal=[0.0, 2.0]"});
  const std::string text = table("external-dataset", "parameters");
  EXPECT_TRUE(has(text, "a of the dataset was not drawn as"));
  EXPECT_FALSE(has(text, "b of the dataset"));
  EXPECT_TRUE(
      has(npdr(4, {"run", "dataset.toml", "--set", "prior.a.normal=[0.0, 2.0]", "--strict"}).out,
          "Dataset"));
}

TEST_F(ExternalDataset, FailedRowsOfADatasetAreTold) {
  import_dataset();
  change_dataset(
      "awk 'NR == 300 || NR == 700 { print \"nan,1\"; next } 1' x.csv > spoiled.csv && "
      "mv spoiled.csv x.csv");
  const Outcome outcome = npdr(0, {"run", "dataset.toml"});
  EXPECT_TRUE(has(outcome.err, "2 of 1000 rows failed (0.2 %: 2 diverged)"));
  EXPECT_TRUE((outcome.err.find("row 299 of the dataset, nan in 'total'") != std::string::npos) ||
              (outcome.err.find("row 699 of the dataset, nan in 'total'") != std::string::npos))
      << outcome.err;
  EXPECT_TRUE(has(outcome.out, "Calibration: a dataset can't show"));
}

// Those of theta alone may have been simulated anew.
TEST_F(ExternalDataset, ADatasetsCopiesAreNoticed) {
  import_dataset();
  change_theta("printf \"%.4f,%.4f\\n\", $1, $2");
  const auto noted_after_doubling = [&](const std::string& files) {
    return notes_copies("for file in " + files +
                        "; do { head -n 501 $file.csv; tail -n +2 $file.csv | head -n 500; } "
                        "> twice.csv && mv twice.csv $file.csv; done");
  };
  EXPECT_FALSE(noted_after_doubling("theta"));
  EXPECT_TRUE(noted_after_doubling("x"));
  EXPECT_TRUE(has(table("external-dataset", "parameters"), "500 of 1000 rows"));
  EXPECT_TRUE(has(npdr(4, {"run", "dataset.toml", "--strict"}).out, "Dataset"))
      << "also of rounded theta";
}

// Of ten simulations of one theta some have the same counts; of rows that are there twice all.
TEST_F(ExternalDataset, CountsThatAgreeByChanceArentCopies) {
  import_dataset();
  EXPECT_TRUE(notes_copies(
      "awk -F, 'NR > 1 { print int($1) \",\" int($2); next } 1' x.csv > counts.csv && "
      "mv counts.csv x.csv && for file in theta x; do awk 'NR == 1 || NR % 2 == 0 { row = $0 } "
      "{ print row }' $file.csv > twice.csv && mv twice.csv $file.csv; done"));
  EXPECT_FALSE(
      notes_copies("awk 'NR == 1 || NR % 10 == 2 { theta = $0 } { print theta }' theta.csv "
                   "> shared.csv && mv shared.csv theta.csv"));
}

TEST_F(ExternalDataset, ADatasetCanOnlyBeAskedWhatItHolds) {
  std::filesystem::create_directory(folder_ / "made");
  ASSERT_EQ(std::system(
                ("sh " + (folder_ / "make_dataset.sh").string() + " " + (folder_ / "made").string())
                    .c_str()),
            0);
  npdr(0, {"import", "--theta", "made/theta.csv", "--x", "made/x.csv", "-o", "d.h5"});
  run_well({"dataset.toml", "--set", "simulator.dataset=d.h5", "--set",
            "diagnose={ num_samples = 100 }"});
  const std::string text = table("external-dataset", "diagnostics");
  EXPECT_TRUE(has(text, {"x_o among simulations", "Training"}));
  EXPECT_FALSE(has(text, "fresh simulations"));
  EXPECT_FALSE(has(text, "SBC"));
  const Outcome asked = npdr({"run", "dataset.toml", "--set", "simulator.dataset=d.h5", "--set",
                              "diagnose={ checks = ['sbc', 'ood'] }"});
  EXPECT_TRUE(has(asked.err, "without sbc: a dataset can't be asked for other simulations"));
  EXPECT_TRUE(has(asked.out, "Calibration: a dataset can't show"));
}

TEST_F(ExternalDataset, SimulationsAreADataset) {
  run_well({"shell.toml", "--until", "simulate"});
  run_well({"dataset.toml", "--set",
            "simulator.dataset=runs/external-shell/npe-gaussian/seed-1/round-1/simulate.h5"});
  expect_exact_posterior("external-dataset");
}

}  // namespace
}  // namespace npdr::pipeline
