#include "inference/conditional_posterior.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "tests/message_of.h"

namespace npdr::inference {
namespace {

// N(mean, P^-1) of three parameters, known up to a constant; `b` has a uniform prior.
class Gaussian final : public Posterior {
 public:
  const Prior& prior() const override { return prior_; }
  Samples draw(Index, const StreamId&) const override { return {}; }
  Vector log_prob(const RowMatrix& theta) const override {
    const RowMatrix off = theta.rowwise() - mean.transpose();
    return 7.0 - 0.5 * (off * precision).cwiseProduct(off).rowwise().sum().array();
  }

  const Vector mean{{0.3, 0.5, -0.4}};
  const RowMatrix precision{{9.0, 4.0, -3.0}, {4.0, 8.0, 2.0}, {-3.0, 2.0, 6.0}};

 private:
  Prior prior_{{{"a", "", Marginal::Kind::normal, 0.0, 1.0},
                {"b", "", Marginal::Kind::uniform, -4.0, 4.0},
                {"c", "", Marginal::Kind::normal, 0.0, 1.0}}};
};

ConditionalPosterior given(const std::vector<std::pair<std::string, double>>& values) {
  return {std::make_unique<Gaussian>(), values};
}

// N(m_r - P_rr^-1 P_rg (theta_g - m_g), P_rr^-1). Of some 2000 effective draws a mean has a
// standard error of .022 deviations, a deviation one of 1.6 %: five of them.
TEST(ConditionalPosterior, OfAGaussianIsTheKnownOne) {
  const Gaussian whole;
  const std::vector<Index> rest = {0, 2};
  const Eigen::MatrixXd covariance = Eigen::MatrixXd(whole.precision(rest, rest)).inverse();
  const Vector slope = -covariance * Vector(whole.precision(rest, std::vector<Index>{1}));
  for (const double b : {0.5, -0.6}) {
    const Vector mean = whole.mean(rest) + slope * (b - whole.mean(1));
    const ConditionalPosterior posterior = given({{"b", b}});
    const RowMatrix theta = posterior.sample(4000, {1, "conditional_test", 0, 0, 0});
    for (Index d = 0; d < 2; ++d) {
      const double deviation = std::sqrt(covariance(d, d));
      const Vector off = theta.col(d).array() - mean(d);
      EXPECT_NEAR(off.mean() / deviation, 0.0, 0.11);
      EXPECT_NEAR(std::sqrt(off.squaredNorm() / 4000.0) / deviation, 1.0, 0.08);
    }
    const double log_peak =
        -std::log(2.0 * std::numbers::pi) - 0.5 * std::log(covariance.determinant());
    EXPECT_NEAR(posterior.log_prob(mean.transpose())(0), log_peak, 0.03);
  }
}

TEST(ConditionalPosterior, OfOneParameterThatIsLeft) {
  const ConditionalPosterior posterior = given({{"c", -0.4}, {"a", 0.3}});
  EXPECT_EQ(posterior.prior().marginals().front().name, "b");
  const RowMatrix theta = posterior.sample(4000, {2, "conditional_test", 0, 0, 0});
  EXPECT_NEAR(theta.mean(), 0.5, 0.04);
  EXPECT_NEAR(std::sqrt((theta.array() - 0.5).square().mean()), 1.0 / std::sqrt(8.0), 0.03);
}

TEST(ConditionalPosterior, NamesWhatCantBeGiven) {
  const auto message = [](const std::vector<std::pair<std::string, double>>& values) {
    return message_of<InputError>([&] { given(values); });
  };
  EXPECT_EQ(message({{"d", 1.0}}), "unknown parameter 'd'; known: a, b, c");
  EXPECT_EQ(message({{"b", 1.0}, {"b", 2.0}}), "given b: twice, must be once");
  EXPECT_EQ(message({{"b", 5.0}}), "given b = 5, must lie within its prior, from -4 to 4");
  EXPECT_EQ(message({{"a", 1.0}, {"b", 1.0}, {"c", 1.0}}), "given: all parameters, must leave one");
}

}  // namespace
}  // namespace npdr::inference
