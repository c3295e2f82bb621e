#include "inference/samplers/importance_certificate.h"

#include <fmt/format.h>

#include <cmath>

#include "core/text.h"

namespace npdr::inference {
namespace {

constexpr double kLargestParetoK = 0.7;
constexpr double kGoodEfficiency = 0.5;     // above, few weights are large, whatever their tail
constexpr double kLargestDifference = 4.0;  // of the halves: passed by chance with p = 6e-5

}  // namespace

std::vector<std::string> faults_of(const ImportanceCertificate& certificate) {
  std::vector<std::string> faults;
  if (certificate.power < certificate.wanted_power) {
    faults.push_back(
        fmt::format("power {:.3g}, not {:.3g}", certificate.power, certificate.wanted_power));
  }
  if (!(certificate.ess >= certificate.wanted_ess)) faults.emplace_back("too few effective draws");
  if (!(certificate.pareto_k <= kLargestParetoK || certificate.efficiency >= kGoodEfficiency)) {
    faults.emplace_back("heavy weights");
  }
  if (!(std::abs(certificate.half_difference) <= kLargestDifference)) {
    faults.emplace_back("halves differ");
  }
  return faults;
}

std::string verdict(const ImportanceCertificate& certificate) {
  const std::vector<std::string> faults = faults_of(certificate);
  return faults.empty() ? "holds" : "FAILS: " + join(faults);
}

}  // namespace npdr::inference
