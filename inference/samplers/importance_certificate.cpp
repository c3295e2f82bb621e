#include "inference/samplers/importance_certificate.h"

#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "inference/samplers/importance_constants.h"

namespace npdr::inference {

bool has_heavy_weights(const ImportanceCertificate& certificate) {
  // Few weights are large where most draws count, whatever their tail.
  return !(certificate.pareto_k <= kLargestParetoK || certificate.efficiency >= kGoodEfficiency);
}

bool misses_known_points(const ImportanceCertificate& certificate) {
  return !(certificate.missed_share <= kMostMissed);
}

bool finds_less(const ImportanceCertificate& certificate, const ImportanceCertificate& other) {
  const double error = std::hypot(certificate.log_evidence_error, other.log_evidence_error);
  return certificate.power == other.power &&
         other.log_evidence - certificate.log_evidence > kMostMissed + kLargestDifference * error;
}

std::vector<std::string> faults_of(const ImportanceCertificate& certificate) {
  std::vector<std::string> faults;
  if (certificate.power < certificate.wanted_power) {
    faults.push_back(
        fmt::format("power {:.3g}, not {:.3g}", certificate.power, certificate.wanted_power));
  }
  if (!(certificate.ess >= certificate.wanted_ess)) faults.emplace_back("too few effective draws");
  if (has_heavy_weights(certificate)) faults.emplace_back("heavy weights");
  if (misses_known_points(certificate)) faults.emplace_back("a mode may be missed");
  if (!(std::abs(certificate.half_difference) <= kLargestDifference)) {
    faults.emplace_back("halves differ");
  }
  return faults;
}

std::string verdict(const ImportanceCertificate& certificate) {
  const std::vector<std::string> faults = faults_of(certificate);
  return faults.empty() ? "holds" : "FAILS: " + join(faults);
}

std::string words_of(const std::optional<SearchCounts>& searched) {
  if (!searched) return "";
  if (searched->num_started == 0) return "too few simulations to search for modes";
  return fmt::format("searched {}, found {}", counted(searched->num_started, "place"),
                     searched->num_found == 0 ? "none" : std::to_string(searched->num_found));
}

}  // namespace npdr::inference
