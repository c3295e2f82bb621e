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
  const Outcome outcome =
      npdr({"run", "dataset.toml", "--until", "simulate", "--set",
            "simulator.parameter=[{name='b', unit='m'}, {name='a'}]", "--set",
            "prior.a={uniform=[0.0, 9.0]}", "--set", "limits.max_failed_fraction=0.9"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
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
  const Outcome other = npdr({"validate", "dataset.toml", "--set",
                              "simulator.parameter=[{name='b', unit='m'}, {name='a'}]"});
  EXPECT_EQ(other.status, 2);
  EXPECT_TRUE(has(other.err, "unit = 'm', must be 'mm', as in the dataset"));
}

TEST_F(ExternalDataset, UnitsThatAStudyCantHaveAreRefused) {
  import_dataset();
  change_dataset("sed -i \"1s/.*/a [$(printf 'k%.0s' $(seq 200))],b/\" theta.csv");
  const Outcome outcome = npdr({"validate", "dataset.toml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(has(outcome.err, {"with 'a' in 'kkk", "must be with units that are"}));
}

// Where it was cut on purpose, the rest is left out.
TEST_F(ExternalDataset, RowsOutsideOfThePriorAreNamed) {
  import_dataset();
  const Outcome narrow = npdr({"run", "dataset.toml", "--set", "prior.a={uniform=[8.0, 9.0]}"});
  EXPECT_EQ(narrow.status, 3) << narrow.err;
  EXPECT_TRUE(has(narrow.err, {"of the dataset, 'a' = ", "outside of the prior, [8, 9]",
                               "left out under a higher limits.max_failed_fraction"}));
}

TEST_F(ExternalDataset, ADatasetOfAnotherPriorIsNoticed) {
  import_dataset();
  run_well({"dataset.toml", "--set", "prior.a.normal=[0.0, 2.0]"});
  const std::string text = table("external-dataset", "parameters");
  EXPECT_TRUE(has(text, "a of the dataset isn't distributed as the prior says"));
  EXPECT_FALSE(has(text, "b of the dataset"));
  const Outcome strict =
      npdr({"run", "dataset.toml", "--set", "prior.a.normal=[0.0, 2.0]", "--strict"});
  EXPECT_EQ(strict.status, 4) << strict.out;
  EXPECT_TRUE(has(strict.out, "Dataset"));
}

TEST_F(ExternalDataset, CorrelatedParametersOfADatasetAreNoticed) {
  import_dataset();
  change_theta("print $1 \",\" 0.6 * $1 + 0.8 * $2");
  run_well({"dataset.toml"});
  EXPECT_TRUE(
      has(table("external-dataset", "parameters"), "a and b of the dataset are correlated (0."));
  const Outcome strict = npdr({"run", "dataset.toml", "--strict"});
  EXPECT_EQ(strict.status, 4);
  EXPECT_TRUE(has(strict.out, "Dataset: a and b"));
}

TEST_F(ExternalDataset, OneParameterCorrelatesWithNothing) {
  import_dataset();
  change_dataset("sed -i '/^b = /d; /^\\[\\[reference/,$d' dataset.toml");
  run_well({"dataset.toml"});
  const std::string text = table("external-dataset", "parameters");
  EXPECT_TRUE(has(text, "mean and standard deviation"));
  EXPECT_FALSE(has(text, "the dataset"));
}

// A grid of 11 values: distributed as the prior but for half of a step.
TEST_F(ExternalDataset, ADatasetThatLiesAtThePriorsEndIsNoticed) {
  import_dataset();
  change_theta("print NR % 11 \",\" $2");
  const auto faults_with = [&](const std::string& prior) {
    run_well({"dataset.toml", "--set", "prior.a={uniform=" + prior + "}"});
    return table("external-dataset", "parameters");
  };
  const std::string at_ends = faults_with("[0.0, 10.0]");
  EXPECT_TRUE(has(at_ends,
                  "0.091 of a in the dataset are 0, an end of its prior, [0, 10], where a "
                  "posterior's density is cut: values on a grid stand for those around "
                  "them, which prior.a = { uniform = [-0.5, 10.5] } holds"));
  EXPECT_FALSE(has(at_ends, "isn't distributed"));
  const Outcome strict =
      npdr({"run", "dataset.toml", "--set", "prior.a={uniform=[0.0, 10.0]}", "--strict"});
  EXPECT_EQ(strict.status, 4);
  EXPECT_TRUE(has(strict.out, "Dataset: 0.091 of a"));
  EXPECT_FALSE(has(faults_with("[-0.5, 10.5]"), "the dataset"));
}

TEST_F(ExternalDataset, ADatasetWhoseRowsAreAllTheSameIsTold) {
  import_dataset();
  change_dataset("awk 'NR > 1 { print \"7,7\"; next } 1' x.csv > same.csv && mv same.csv x.csv");
  const Outcome outcome = npdr({"run", "dataset.toml", "--until", "simulate"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(has(outcome.err, "rows are the same, whatever their parameters"));
}

TEST_F(ExternalDataset, FailedRowsOfADatasetAreTold) {
  import_dataset();
  change_dataset(
      "awk 'NR == 300 || NR == 700 { print \"nan,1\"; next } 1' x.csv > spoiled.csv && "
      "mv spoiled.csv x.csv");
  const Outcome outcome = npdr({"run", "dataset.toml"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(has(outcome.err, "2 of 1000 rows failed (2 diverged)"));
  EXPECT_TRUE((outcome.err.find("row 299 of the dataset, nan in 'total'") != std::string::npos) ||
              (outcome.err.find("row 699 of the dataset, nan in 'total'") != std::string::npos))
      << outcome.err;
  EXPECT_TRUE(has(outcome.out, "Calibration: a dataset can't be asked"));
}

// Those of theta alone may have been simulated anew.
TEST_F(ExternalDataset, ADatasetsCopiesAreNoticed) {
  import_dataset();
  change_theta("printf \"%.4f,%.4f\\n\", $1, $2");
  const std::string note = "500 of 1000 rows of the dataset are copies of others";
  const auto noted_after_doubling = [&](const std::string& files) {
    const std::string twice = "for file in " + files +
                              "; do { head -n 501 $file.csv; tail -n +2 $file.csv | head -n 500; } "
                              "> twice.csv && mv twice.csv $file.csv; done";
    change_dataset(twice);
    run_well({"dataset.toml"});
    return table("external-dataset", "parameters").find(note) != std::string::npos;
  };
  EXPECT_FALSE(noted_after_doubling("theta"));
  EXPECT_TRUE(noted_after_doubling("x"));
  EXPECT_EQ(npdr({"run", "dataset.toml", "--strict"}).status, 4) << "also of rounded theta";
}

// Of ten simulations of one theta some have the same counts; of rows that are there twice all.
TEST_F(ExternalDataset, CountsThatAgreeByChanceArentCopies) {
  import_dataset();
  const auto noted_with = [&](const std::string& changes) {
    change_dataset(changes);
    run_well({"dataset.toml"});
    return table("external-dataset", "parameters").find("are copies of others") !=
           std::string::npos;
  };
  EXPECT_TRUE(noted_with(
      "awk -F, 'NR > 1 { print int($1) \",\" int($2); next } 1' x.csv > counts.csv && "
      "mv counts.csv x.csv && for file in theta x; do awk 'NR == 1 || NR % 2 == 0 { row = $0 } "
      "{ print row }' $file.csv > twice.csv && mv twice.csv $file.csv; done"));
  EXPECT_FALSE(
      noted_with("awk 'NR == 1 || NR % 10 == 2 { theta = $0 } { print theta }' theta.csv "
                 "> shared.csv && mv shared.csv theta.csv"));
}

// Two among 1000, which the first rows don't show.
TEST_F(ExternalDataset, RareNumbersThatStandForFailuresAreTold) {
  import_dataset();
  change_dataset(
      "awk 'NR == 300 || NR == 700 { print \"-999,-999\"; next } 1' x.csv > spoiled.csv && "
      "mv spoiled.csv x.csv");
  const std::string warning = " is -999 in 2 of 1000 rows";
  const Outcome outcome = npdr({"run", "dataset.toml"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(has(outcome.err, warning));
  EXPECT_TRUE(has(text_of(folder_ / "runs/external-dataset/report.html"), warning));
}

TEST_F(ExternalDataset, ADatasetCanOnlyBeAskedWhatItHolds) {
  std::filesystem::create_directory(folder_ / "made");
  ASSERT_EQ(std::system(
                ("sh " + (folder_ / "make_dataset.sh").string() + " " + (folder_ / "made").string())
                    .c_str()),
            0);
  ASSERT_EQ(npdr({"import", "--theta", "made/theta.csv", "--x", "made/x.csv", "-o", "d.h5"}).status,
            0);
  run_well({"dataset.toml", "--set", "simulator.dataset=d.h5", "--set",
            "diagnose={ num_samples = 100 }"});
  const std::string text = table("external-dataset", "diagnostics");
  EXPECT_TRUE(has(text, {"x_o among simulations", "Training"}));
  EXPECT_FALSE(has(text, "fresh simulations"));
  EXPECT_FALSE(has(text, "SBC"));
  const Outcome asked = npdr({"run", "dataset.toml", "--set", "simulator.dataset=d.h5", "--set",
                              "diagnose={ checks = ['sbc', 'ood'] }"});
  EXPECT_TRUE(has(asked.err, "without sbc: a dataset can't be asked for other simulations"));
  EXPECT_TRUE(has(asked.out, "Calibration: a dataset can't be asked"));
}

TEST_F(ExternalDataset, SimulationsAreADataset) {
  run_well({"shell.toml", "--until", "simulate"});
  run_well({"dataset.toml", "--set",
            "simulator.dataset=runs/external-shell/npe-gaussian/seed-1/round-1/simulate.h5"});
  expect_exact_posterior("external-dataset");
}

}  // namespace
}  // namespace npdr::pipeline
