#include "pipeline/artefacts/diagnosis_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

using inference::CalibrationRanks;

class DiagnosisCheckpoints : public ::testing::Test {
 protected:
  // Three of five simulations are ranked.
  static CalibrationRanks three_ranks() {
    CalibrationRanks ranks{.num_samples = 50, .num_done = 3};
    ranks.parameter = RowMatrixX<std::int64_t>::Constant(5, 2, 7);
    ranks.density = VectorX<std::int64_t>::Constant(5, 50);
    ranks.distance = VectorX<std::int64_t>::Constant(5, 0);
    ranks.theta = RowMatrix::Constant(5, 2, 0.5);
    ranks.log_prob = Vector::Constant(5, 1.25);
    return ranks;
  }

  CalibrationRanks written_and_read(const CalibrationRanks& ranks, Index num_simulations = 5,
                                    Index dimension = 2) {
    kDiagnosisCheckpointSchema.write(path_, identity_, {ranks, {}});
    return read_diagnosis_checkpoint({path_, identity_.key()},
                                     RowMatrix::Zero(num_simulations, dimension), 50)
        .ranks;
  }

  TempFolder folder_;
  std::filesystem::path path_ = folder_.path() / "a.checkpoint.h5";
  Identity identity_{.key_document = {{"stage", "diagnose"}}, .inputs = {}, .study = {}};
};

TEST_F(DiagnosisCheckpoints, HoldWhatIsDone) {
  const CalibrationRanks read = written_and_read(three_ranks());
  EXPECT_EQ(read.num_samples, 50);
  EXPECT_EQ(read.num_done, 3);
  EXPECT_EQ(read.parameter, three_ranks().parameter.topRows(3));
  EXPECT_EQ(read.density, three_ranks().density.head(3));
  EXPECT_EQ(read.distance, three_ranks().distance.head(3));
  EXPECT_EQ(read.theta, three_ranks().theta.topRows(3));
  EXPECT_EQ(read.log_prob, three_ranks().log_prob.head(3));
}

TEST_F(DiagnosisCheckpoints, NoneIsOneWithoutRanks) {
  const CalibrationRanks read =
      read_diagnosis_checkpoint({path_, identity_.key()}, RowMatrix::Zero(5, 2), 50).ranks;
  EXPECT_EQ(read.num_samples, 50);
  EXPECT_EQ(read.num_done, 0);
}

TEST_F(DiagnosisCheckpoints, AreRejectedWhereTheyDontFit) {
  EXPECT_THROW(written_and_read(three_ranks(), 2), InputError) << "more than there are";
  EXPECT_THROW(written_and_read(three_ranks(), 5, 3), InputError) << "parameters";
  CalibrationRanks others = three_ranks();
  others.num_samples = 60;
  EXPECT_THROW(written_and_read(others), InputError);
  CalibrationRanks damaged = three_ranks();
  damaged.density(1) = 51;
  EXPECT_THROW(written_and_read(damaged), InputError) << "more than there are samples";
  damaged = three_ranks();
  damaged.parameter(2, 1) = -1;
  EXPECT_THROW(written_and_read(damaged), InputError);
}

}  // namespace
}  // namespace npdr::pipeline
