#include "inference/samplers/importance_certificate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"

namespace npdr::inference {
namespace {

const ImportanceCertificate kGood = {.power = 1.0,
                                     .wanted_power = 1.0,
                                     .num_draws = 100'000,
                                     .ess = 1200.0,
                                     .wanted_ess = 1000.0,
                                     .efficiency = 0.1,
                                     .missed_share = 0.04,
                                     .pareto_k = 0.6,
                                     .log_evidence = -3.0,
                                     .log_evidence_error = 0.03,
                                     .half_difference = -3.9};

TEST(ImportanceCertificate, HoldsWithoutFaults) {
  EXPECT_TRUE(faults_of(kGood).empty());
  EXPECT_EQ(verdict(kGood), "holds");
}

TEST(ImportanceCertificate, SaysWhatIsWrong) {
  ImportanceCertificate bad = kGood;
  bad.power = 0.25;
  EXPECT_EQ(verdict(bad), "FAILS: power 0.25, not 1");
  bad.ess = 999.0;
  bad.pareto_k = kInfinity;
  bad.half_difference = -4.1;
  EXPECT_EQ(verdict(bad),
            "FAILS: power 0.25, not 1, too few effective draws, heavy weights, halves differ");
}

TEST(ImportanceCertificate, ATailOfWeightsThatAreAlmostEvenIsNoFault) {
  ImportanceCertificate even = kGood;
  even.pareto_k = 1.2;
  EXPECT_EQ(verdict(even), "FAILS: heavy weights");
  even.efficiency = 0.8;
  EXPECT_EQ(verdict(even), "holds");
}

TEST(ImportanceCertificate, SaysWhatItsSearchesHaveDone) {
  EXPECT_EQ(words_of(kGood.searched), "") << "an older file";
  EXPECT_EQ(words_of(SearchCounts{84, 0}), "searched 84 places, found none");
  EXPECT_EQ(words_of(SearchCounts{84, 2}), "searched 84 places, found 2");
  EXPECT_EQ(words_of(SearchCounts{}), "too few simulations to search for modes");
}

TEST(ImportanceCertificate, MissesPointsThatWereKnown) {
  ImportanceCertificate missing = kGood;
  EXPECT_EQ(verdict(missing), "holds");
  missing.missed_share = 0.051;
  EXPECT_EQ(verdict(missing), "FAILS: a mode may be missed");
}

TEST(ImportanceCertificate, FindsLessThanAnotherWhoseEvidenceIsLarger) {
  const ImportanceCertificate own{.log_evidence = 5.0, .log_evidence_error = 0.03};
  const auto other = [](double log_evidence) {
    return ImportanceCertificate{.log_evidence = log_evidence, .log_evidence_error = 0.04};
  };
  EXPECT_FALSE(finds_less(own, own));
  EXPECT_FALSE(finds_less(own, other(5.24)));  // 0.05 and four errors of 0.05
  EXPECT_TRUE(finds_less(own, other(5.26)));
  EXPECT_FALSE(finds_less(other(5.26), own));
  ImportanceCertificate weaker = other(9.0);
  weaker.power = 0.5;
  EXPECT_FALSE(finds_less(own, weaker));
  EXPECT_FALSE(finds_less(own, other(kNaN)));
}

TEST(ImportanceCertificate, NumbersThatAreNoneAreFaults) {
  ImportanceCertificate bad = kGood;
  bad.ess = bad.pareto_k = bad.half_difference = kNaN;
  bad.missed_share = bad.ess;
  EXPECT_EQ(verdict(bad),
            "FAILS: too few effective draws, heavy weights, a mode may be missed, halves differ");
}

}  // namespace
}  // namespace npdr::inference
