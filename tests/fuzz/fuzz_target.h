/// Readers of what comes from outside, each as a function of bytes that a fuzzer makes up.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace npdr::pipeline {

struct FuzzTarget {
  std::string name;
  /// Inputs that the reader accepts: a fuzzer begins with them.
  std::vector<std::string> (*seeds)();
  /// Makes of the input what the reader takes, in a folder of its own, and reads it. Throws Error
  /// for what is refused; nothing else may happen.
  void (*run)(std::string_view input, const std::filesystem::path& folder);
};

std::vector<std::string> study_seeds();
void fuzz_study(std::string_view input, const std::filesystem::path& folder);
std::vector<std::string> csv_seeds();
void fuzz_csv(std::string_view input, const std::filesystem::path& folder);
std::vector<std::string> recording_seeds();
void fuzz_recording(std::string_view input, const std::filesystem::path& folder);
std::vector<std::string> posterior_seeds();
void fuzz_posterior(std::string_view input, const std::filesystem::path& folder);
std::vector<std::string> artefact_seeds();
void fuzz_artefact(std::string_view input, const std::filesystem::path& folder);
std::vector<std::string> worker_seeds();
void fuzz_worker(std::string_view input, const std::filesystem::path& folder);

inline const std::vector<FuzzTarget> kFuzzTargets = {
    {"study", study_seeds, fuzz_study},
    {"csv", csv_seeds, fuzz_csv},
    {"recording", recording_seeds, fuzz_recording},
    {"posterior", posterior_seeds, fuzz_posterior},
    {"artefact", artefact_seeds, fuzz_artefact},
    {"worker", worker_seeds, fuzz_worker},
};

/// Whether the target accepts the input; false: it says why not. Aborts where a child process had
/// to crash to find out.
bool accepts(const FuzzTarget& target, std::string_view input, const std::filesystem::path& folder);

}  // namespace npdr::pipeline
