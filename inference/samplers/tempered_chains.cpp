#include "inference/samplers/tempered_chains.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/error.h"
#include "inference/samplers/chain_diagnostics.h"
#include "inference/samplers/slice_sampler.h"
#include "inference/samplers/tempered_walkers.h"
#include "inference/standard_normal.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr Index kPopulations = 4;
constexpr double kEffectiveCandidates = 4.0;  // of each walker, at the first power
constexpr double kEffectiveShare = 0.5;       // of walkers, at the next power
constexpr Index kSweeps = 10;                 // of each dimension, at each power
constexpr Index kMostRaises = 100;            // then on to power 1, whatever that leaves
constexpr Index kFewestThatWalk = 3;

// Walkers on their way to power 1, and the candidate that each descends from.
class Climb {
 public:
  Climb(const LogDensity& log_likelihood, const RowMatrix& candidates)
      : log_likelihood_(log_likelihood) {
    walkers_.u = candidates;
    walkers_.log_likelihood = evaluate(candidates);
    if (!std::isfinite(walkers_.log_likelihood.maxCoeff())) {
      throw Error("posterior: its density is 0 or infinite throughout");
    }
    families_.resize(static_cast<std::size_t>(candidates.rows()));
    std::iota(families_.begin(), families_.end(), 0);
  }

  // `id` is of this climb alone: its round and epoch count raises and sweeps.
  void run(Index num_walkers, StreamId id) {
    while (walkers_.power < 1.0) {
      const double power = ++id.round < kMostRaises ? next_power_of(num_walkers) : 1.0;
      inherit(raise_power(walkers_, power, num_walkers, named(id, "raise")));
      if (num_walkers < kFewestThatWalk) continue;
      for (id.epoch = 0; std::cmp_less(id.epoch, kSweeps * walkers_.u.cols()); ++id.epoch) {
        const RowMatrix proposed = propose_steps(walkers_, StepKind::wide, named(id, "steps"));
        take_steps(walkers_, StepKind::wide, proposed, evaluate(proposed), named(id, "choice"));
      }
    }
  }

  const RowMatrix& u() const { return walkers_.u; }
  const std::vector<Index>& families() const { return families_; }
  Index num_points() const { return num_points_; }

 private:
  Vector evaluate(const RowMatrix& u) {
    num_points_ += u.rows();
    return numbers(log_likelihood_(u));
  }

  // 1 where likelihoods differ by so much that no power is small enough.
  double next_power_of(Index num_walkers) const {
    const auto usable = static_cast<double>(walkers_.log_likelihood.array().isFinite().count());
    const double enough =
        std::min(kEffectiveShare * usable, kEffectiveCandidates * static_cast<double>(num_walkers));
    const double power = next_power(walkers_, 1.0, enough);
    return power > walkers_.power ? power : 1.0;
  }

  void inherit(const std::vector<Index>& rows) {
    std::vector<Index> inherited;
    for (const Index row : rows) inherited.push_back(families_[static_cast<std::size_t>(row)]);
    families_.swap(inherited);
  }

  const LogDensity& log_likelihood_;
  TemperedWalkers walkers_;
  std::vector<Index> families_;
  Index num_points_ = 0;
};

// Starts of the chains: chain c in row c, of population c mod kPopulations.
struct Starts {
  RowMatrix u;
  std::vector<Index> families;
  Index num_points = 0;
};

// Every kPopulations-th start from `population` on; in random order, since relatives are neighbors.
void add_population(const LogDensity& log_likelihood, Index population, Index num_candidates,
                    StreamId id, Starts& starts) {
  const Index size = starts.u.rows() / kPopulations;
  id.row += static_cast<std::uint64_t>(population * num_candidates);
  Stream stream(within(id, "climb"));
  const std::uint64_t seed = (std::uint64_t{stream.bits()} << 32) | stream.bits();
  Climb climb(log_likelihood, draw_standard_normal(num_candidates, starts.u.cols(), id));
  climb.run(size, {seed, "climb", 0, 0, 0});
  starts.num_points += climb.num_points();
  Index start = population;
  for (const std::uint32_t i : stream.permutation(static_cast<std::uint32_t>(size))) {
    starts.u.row(start) = climb.u().row(i);
    starts.families[static_cast<std::size_t>(start)] =
        population * num_candidates + climb.families()[i];
    start += kPopulations;
  }
}

Starts make_starts(const LogDensity& log_likelihood, Index dimension, const SamplerConfig& config,
                   const StreamId& id) {
  const auto of_a_population = [](Index n) { return (n + kPopulations - 1) / kPopulations; };
  const Index chains = kPopulations * of_a_population(config.num_chains);
  Starts starts{RowMatrix(chains, dimension), std::vector<Index>(static_cast<std::size_t>(chains))};
  for (Index p = 0; p < kPopulations; ++p) {
    add_population(log_likelihood, p, of_a_population(config.num_candidates), id, starts);
  }
  return starts;
}

// families: of each chain.
Vector effective_sizes(const ChainDraws& draws, std::vector<Index> families) {
  std::vector<Index> distinct = families;
  std::ranges::sort(distinct);
  distinct.erase(std::ranges::unique(distinct).begin(), distinct.end());
  for (Index& family : families) {
    family = std::ranges::lower_bound(distinct, family) - distinct.begin();
  }
  const RowMatrix centered = draws.u.rowwise() - draws.u.colwise().mean();
  RowMatrix sums = RowMatrix::Zero(std::ssize(distinct), centered.cols());
  for (Index i = 0; i < centered.rows(); ++i) {
    sums.row(families[static_cast<std::size_t>(i % draws.num_chains)]) += centered.row(i);
  }
  const auto n = static_cast<double>(centered.rows()), count = static_cast<double>(sums.rows());
  const Eigen::ArrayXd sum_of_squares = sums.colwise().squaredNorm().transpose();
  return (n * (count - 1.0) / count * centered.colwise().squaredNorm().transpose().array() /
          sum_of_squares)
      .min(n);
}

}  // namespace

TemperedDraws sample_tempered(const LogDensity& log_likelihood, Index dimension, Index n,
                              const SamplerConfig& config, const StreamId& id) {
  const Starts starts = make_starts(log_likelihood, dimension, config, within(id, "candidates"));
  const Index chains = starts.u.rows();
  const ChainDraws draws = slice_sample(
      [&](const RowMatrix& u) -> Vector { return log_likelihood(u) + log_standard_normal(u); },
      starts.u, (n + chains - 1) / chains, {config.num_warmup, config.thin}, id);
  SamplerReport report;
  report.r_hat = diagnose({draws.u, kPopulations}).r_hat;
  report.ess = effective_sizes(draws, starts.families);
  report.num_evaluations = starts.num_points + draws.num_points;
  return {draws.u.topRows(n), report};
}

}  // namespace npdr::inference
