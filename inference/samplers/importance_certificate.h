/// Quality of importance-weighted draws.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "inference/samplers/weight_search.h"

namespace npdr::inference {

/// Quality of the reported levels' independent draws.
struct ImportanceCertificate {
  double power = 0.0;               ///< of the likelihood: less than wanted where draws ran out
  double wanted_power = 0.0;        ///< given, or chosen
  Index num_draws = 0;              ///< simulated in all
  double ess = 0.0;                 ///< effective size of the weights (weighted_population.h)
  double wanted_ess = 0.0;          ///< at least
  double efficiency = 0.0;          ///< ess over the draws that are reported
  double missed_share = 0.0;        ///< of pi, by points that were known before (heavy_share())
  double pareto_k = 0.0;            ///< of the weights (pareto_tail.h)
  double log_evidence = 0.0;        ///< log Z [nats]
  double log_evidence_error = 0.0;  ///< its standard error
  double half_difference = 0.0;     ///< of both halves' log Z, over its standard error
  double ess_of_all = 0.0;  ///< of the points of all levels, where these are the result; or 0
  std::optional<SearchCounts> searched = {};  ///< before the reported levels, for what they miss
};

/// A Pareto k above 0.7 (Vehtari et al. 2024) where the efficiency is below 0.5: means may hang on
/// draws that are yet to come. NaN is heavy.
bool has_heavy_weights(const ImportanceCertificate& certificate);

/// More than 5 % of pi, as points that were known before tell, is where the draws' density is too
/// low for them to find it, and they haven't: such as a mode. NaN misses them.
bool misses_known_points(const ImportanceCertificate& certificate);

/// Whether other draws of the same posterior, by another seed, have found more of it: their log Z
/// is larger by more than four standard errors and 0.05, a share of 5 % of pi. Not so at another
/// power, or where a log Z is no number.
bool finds_less(const ImportanceCertificate& certificate, const ImportanceCertificate& other);

/// Reasons not to trust the draws, in words; none: they hold. Faults are a power or effective size
/// that is less than wanted, heavy weights, known points that are missed, and halves whose log Z
/// are more than 4 standard errors apart. NaN is a fault.
std::vector<std::string> faults_of(const ImportanceCertificate& certificate);

/// "holds", or "FAILS: " and the faults.
std::string verdict(const ImportanceCertificate& certificate);

/// "searched 84 places, found none"; "" where nobody has noted that.
std::string words_of(const std::optional<SearchCounts>& searched);

}  // namespace npdr::inference
