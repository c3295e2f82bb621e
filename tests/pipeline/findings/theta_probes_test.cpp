#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "pipeline/findings/probe.h"
#include "pipeline/sources/marginal_fit.h"
#include "tests/message_of.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;
using Kind = Marginal::Kind;

const std::vector<Marginal> kPrior = {{"a", "1", Kind::uniform, 0.0, 10.0},
                                      {"b", "1", Kind::normal, 10.0, 1.0},
                                      {"c", "1", Kind::log_uniform, 0.45, 100.45}};

RowMatrix draws(const std::vector<Marginal>& prior, Index n, std::uint64_t seed = 1) {
  return inference::sample_prior(inference::Prior(prior), n, seed);
}

// "grave: end (0.1 of the rows ...): many rows have a = 0, ... Draw ...": of each fault its id,
// evidence and words.
std::string faults(const RowMatrix& theta, const std::vector<Marginal>& prior = kPrior) {
  std::string text;
  const Findings found = find_in_theta(theta, inference::Prior(prior));
  for (const Finding& fault : found) {
    text += fmt::format("{}{} ({}): {}. {}", text.empty() ? "" : "; ", fault.id, fault.evidence,
                        fault.what, fault.advice);
  }
  const bool are_grave = std::ranges::count(found, Severity::wrong, &Finding::severity) > 0;
  return are_grave ? "grave: " + text : text;
}

// Each row `times` times.
RowMatrix repeated(const RowMatrix& theta, Index times) {
  RowMatrix result(theta.rows() * times, theta.cols());
  for (Index i = 0; i < result.rows(); ++i) result.row(i) = theta.row(i / times);
  return result;
}

// 40 of each design, with some five tests each: a false alarm in 2 % of all runs at most.
TEST(ThetaFaults, DrawsOfThePriorHaveNone) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const RowMatrix theta = draws(kPrior, 1000, seed);
    EXPECT_EQ(faults(theta), "") << seed;
    EXPECT_EQ(faults(repeated(theta.topRows(100), 10)), "") << seed;
    EXPECT_EQ(faults(theta.topRows(7)), "") << seed;
    RowMatrix rounded = theta;
    rounded.rightCols(2) = (10.0 * rounded.rightCols(2).array()).round() / 10.0;
    EXPECT_EQ(faults(rounded), "") << seed;
    // Two parameters that ten simulations share, and one that they don't.
    RowMatrix nested = theta;
    nested.leftCols(2) = repeated(theta.topRows(100), 10).leftCols(2);
    EXPECT_EQ(faults(nested), "") << seed;
  }
}

// Rounded to a few places each form is proposed again, and has no fault.
TEST(ThetaFaults, RoundedDrawsHaveNoneInWhatTheyLookDrawnFrom) {
  const std::vector<Marginal> prior = {{"a", "1", Kind::uniform, 1.0, 3.0},
                                       {"b", "1", Kind::normal, 10.0, 1.0},
                                       {"c", "1", Kind::log_uniform, 1.0, 3.0},
                                       {"d", "1", Kind::log_normal, 0.5, 0.3}};
  const RowMatrix theta = (10.0 * draws(prior, 3000).array()).round() / 10.0;
  std::vector<Marginal> found;
  for (std::size_t d = 0; d < 4; ++d) {
    MarginalFit fit;
    fit.observe(theta.col(static_cast<Index>(d)));
    found.push_back(fit.likeliest());
    EXPECT_EQ(found.back().kind, prior[d].kind) << prior[d].name;
    found.back().name = prior[d].name;
  }
  EXPECT_EQ(faults(theta, found), "");
}

// What is proposed for a grid is what it is told to have.
TEST(ThetaFaults, GridsHaveNoneInWhatTheyLookDrawnFrom) {
  for (const Vector& levels :
       {Vector(Vector::LinSpaced(5, 1e-6, 1.0)), Vector(Vector::LinSpaced(6, 0.01, 1.01)),
        Vector{{0.1, 1.0, 10.0, 100.0, 1000.0}}, Vector(Vector::LinSpaced(12, 0.0, 330.0)),
        Vector{{0.1, 0.3, 0.5, 1.0, 2.0}}}) {
    RowMatrix theta(levels.size() * levels.size(), 2);
    for (Index i = 0; i < theta.rows(); ++i) {
      theta.row(i) << levels(i / levels.size()), levels(i % levels.size());
    }
    std::vector<Marginal> prior;
    for (Index d = 0; d < 2; ++d) {
      MarginalFit fit;
      fit.observe(repeated(theta, 40).col(d));
      prior.push_back(fit.likeliest());
      prior.back().name = d == 0 ? "a" : "b";
    }
    EXPECT_EQ(faults(repeated(theta, 40), prior), "") << levels.transpose();
  }
}

// Faults of 1000 draws whose `a` another rule gives, by row.
std::string faults_with(const std::function<double(Index)>& a,
                        const std::vector<Marginal>& prior = kPrior) {
  RowMatrix theta = draws(kPrior, 1000);
  for (Index i = 0; i < theta.rows(); ++i) theta(i, 0) = a(i);
  return faults(theta, prior);
}

TEST(ThetaFaults, AreOtherDistributions) {
  std::vector<Marginal> wider = kPrior;
  wider[1].b = 2.0;
  EXPECT_TRUE(has(faults(draws(kPrior, 1000), wider),
                  {"grave: prior (distribution functions differ by 0.", "b of the dataset"}));
  // Draws that several simulations share count once.
  EXPECT_EQ(faults(draws(kPrior, 60), wider), faults(repeated(draws(kPrior, 60), 5), wider));
  const Vector drawn = draws(kPrior, 1000).col(0);
  const auto half = [&](Index i) { return std::round(0.5 * drawn(i)); };
  EXPECT_TRUE(has(faults_with(half),
                  {"grave: end (0.1 of the rows", "a = 0, an end of the prior", "; prior ("}));
  EXPECT_TRUE(has(faults_with([&](Index i) { return half(i) + 0.25; }), "grave: prior ("));
  // A third of the rows has a default, which the others, by themselves, don't hide.
  EXPECT_TRUE(has(faults_with([&](Index i) { return i % 3 == 0 ? std::sqrt(30.0) : drawn(i); }),
                  "grave: prior ("));
  // Values at the ends don't hide others.
  EXPECT_TRUE(has(faults_with([](Index i) { return 0.1 * static_cast<double>(i % 41); }),
                  {"grave: end (0.025 of the rows", "a = 0, an end of the prior", "; prior ("}));
}

TEST(ThetaFaults, AreValuesAtAnEnd) {
  RowMatrix theta = draws(kPrior, 1100);
  for (Index i = 0; i < theta.rows(); ++i) theta(i, 0) = static_cast<double>(i % 11);
  EXPECT_TRUE(has(faults(theta), {"grave: end (0.091 of the rows", "a = 0, an end of the prior",
                                  "prior.a = { uniform = [-0.5, 10.5] }"}));
  const std::vector<double> steps = {0.0, 1.0, 2.0, 5.0, 10.0};  // whatever they are
  EXPECT_TRUE(has(faults_with([&](Index i) { return steps[static_cast<std::size_t>(i % 5)]; }),
                  {"grave: end (0.2 of the rows", "a = 0, an end of the prior", "prior.a = { "}));
  const Vector drawn = draws(kPrior, 1000).col(0);
  const std::string remedy = "Draw a from the prior, or leave these rows out";
  EXPECT_TRUE(has(faults_with([&](Index i) { return std::min(1.03 * drawn(i), 10.0); }),
                  {"end (0.034 of the rows", "a = 10, an end of the prior", remedy}));
  // Whatever the bounds are, which may have been taken from them, also where all are rounded.
  std::vector<Marginal> wider = kPrior;
  wider[0].a = -0.01;
  const auto clipped = [&](Index i) { return std::max(drawn(i) - 0.5, 0.0); };
  EXPECT_TRUE(has(faults_with(clipped, wider),
                  {"grave: end (0.05 of the rows", "a = 0, an end of its values", remedy}));
  EXPECT_TRUE(has(faults_with([&](Index i) { return std::round(1e4 * clipped(i)) / 1e4; }, wider),
                  "as if clipped"));
}

// Of which the distribution function differs little.
TEST(ThetaFaults, AreAnotherWidthAndAMissingTail) {
  RowMatrix theta = draws(kPrior, 3000);
  theta.col(1) = 10.0 + 1.1 * (theta.col(1).array() - 10.0);
  EXPECT_TRUE(has(faults(theta), {"prior (", "b of the dataset"}));
  theta = draws(kPrior, 1000);
  for (double& b : theta.col(1)) b = b < 8.5 ? 20.0 - b : b;
  EXPECT_TRUE(has(faults(theta), {"prior (", "b of the dataset"}));
}

// Levels of a design that isn't even: their distribution isn't any prior's.
TEST(ThetaFaults, AreUnevenDesigns) {
  RowMatrix theta(1050, 2);
  for (Index i = 0; i < theta.rows(); ++i) {
    theta(i, 0) = std::vector{0.0, 1.0, 3.0, 10.0, 30.0}[static_cast<std::size_t>(i % 5)];
    theta(i, 1) = 1.0 + static_cast<double>((i / 5) % 7);
  }
  EXPECT_TRUE(has(
      faults(theta, {{"a", "1", Kind::uniform, -3.8, 33.8}, {"b", "1", Kind::uniform, 0.5, 7.5}}),
      "grave: prior ("));
}

TEST(ThetaFaults, AreValuesThatTeachNothing) {
  EXPECT_TRUE(has(faults_with([](Index) { return 3.5; }),
                  {"grave: constant (3.5 in all rows)", "Leave a out of [prior]"}));
}

TEST(ThetaFaults, AreCorrelations) {
  RowMatrix theta = draws(kPrior, 1000);
  theta.col(1) = 10.0 + 0.8 * (theta.col(1).array() - 10.0) +
                 0.6 * (theta.col(0).array() - 5.0) / std::sqrt(100.0 / 12.0);
  EXPECT_TRUE(
      has(faults(theta), {"grave: correlated (correlation 0.63", "a and b of the dataset"}));
  // As those of 15 draws may be, however often each is simulated.
  EXPECT_FALSE(has(faults(repeated(theta.topRows(15), 50)), "correlated"));
  const RowMatrix rounded = (10.0 * theta.topRows(15).array()).round() / 10.0;
  EXPECT_FALSE(has(faults(repeated(rounded, 50)), "correlated")) << "not by its 750 rows";
  // Two that a few draws correlate more, by chance, don't hide it.
  RowMatrix nested(1000, 4);
  nested << theta, repeated(draws(kPrior, 50, 7), 20).col(0);
  std::vector<Marginal> prior = kPrior;
  prior.push_back({"d", "1", Kind::uniform, 0.0, 10.0});
  EXPECT_TRUE(has(faults(nested, prior), {"grave: correlated (", "a and b of the dataset"}));
}

}  // namespace
}  // namespace npdr::pipeline
