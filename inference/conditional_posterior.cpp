#include "inference/conditional_posterior.h"

#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "core/text.h"
#include "inference/log_normalizer.h"
#include "inference/samplers/tempered_chains.h"

namespace npdr::inference {
namespace {

constexpr SamplerConfig kSampler = {.num_chains = 400, .num_candidates = 20'000};

using Given = std::vector<std::pair<std::string, double>>;

void require_possible(const Marginal& marginal, double value) {
  if (Prior({marginal}).contains(Vector::Constant(1, value))) return;
  std::ostringstream message;
  message << "given " << marginal.name << " = " << value << ", must lie within its prior, from "
          << marginal.lower() << " to " << marginal.upper();
  throw InputError(message.str());
}

// The marginals that no value is given of.
std::vector<Marginal> others(const std::vector<Marginal>& all, const Given& given) {
  std::vector<std::string> names;
  for (const Marginal& m : all) names.push_back(m.name);
  std::vector<Marginal> left = all;
  for (const auto& [name, value] : given) {
    if (std::ranges::count(names, name) == 0) {
      throw InputError(unknown_name("parameter", name, names));
    }
    if (std::erase_if(left, [&name = name](const Marginal& m) { return m.name == name; }) == 0) {
      throw InputError("given " + name + ": twice, must be once");
    }
  }
  if (left.empty()) throw InputError("given: all parameters, must leave one");
  return left;
}

}  // namespace

ConditionalPosterior::ConditionalPosterior(std::unique_ptr<Posterior> whole, const Given& given)
    : whole_(std::move(whole)),
      values_(Eigen::RowVectorXd::Zero(whole_->prior().dimension())),
      prior_(others(whole_->prior().marginals(), given)) {
  const std::vector<Marginal>& all = whole_->prior().marginals();
  for (Index d = 0; d < values_.size(); ++d) {
    const Marginal& marginal = all[static_cast<std::size_t>(d)];
    const auto value = std::ranges::find(given, marginal.name, &Given::value_type::first);
    if (value == given.end()) {
      columns_.push_back(d);
      continue;
    }
    require_possible(marginal, value->second);
    values_(d) = value->second;
  }
}

RowMatrix ConditionalPosterior::complete(const RowMatrix& theta) const {
  RowMatrix all = values_.replicate(theta.rows(), 1);
  all(Eigen::all, columns_) = theta;
  return all;
}

Vector ConditionalPosterior::relative_log_prob(const RowMatrix& theta) const {
  return whole_->relative_log_prob(complete(theta));
}

Samples ConditionalPosterior::draw(Index n, const StreamId& id) const {
  const LogDensity over_prior = [&](const RowMatrix& u) -> Vector {
    const RowMatrix theta = prior_.to_theta(u);
    return relative_log_prob(theta) - prior_.log_prob(theta);
  };
  TemperedDraws draws = sample_tempered(over_prior, prior_.dimension(), n, kSampler, id);
  return {prior_.to_theta(draws.u), std::move(draws.report)};
}

Vector ConditionalPosterior::log_prob(const RowMatrix& theta) const {
  std::call_once(has_normalizer_, [&] {
    constexpr Index num_samples = 1000;
    const StreamId id{0, "conditional_normalizer", 0, 0, 0};
    const LogDensity of_u = [&](const RowMatrix& u) -> Vector {
      const RowMatrix at = prior_.to_theta(u);
      return relative_log_prob(at) - prior_.log_det_to_normal(at);
    };
    log_z_ = log_normalizer(of_u, prior_.to_normal(sample(num_samples, id)),
                            named(id, "conditional_points"));
  });
  return relative_log_prob(theta).array() - log_z_;
}

}  // namespace npdr::inference
