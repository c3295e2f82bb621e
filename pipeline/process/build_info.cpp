#include "pipeline/process/build_info.h"

#include <fmt/chrono.h>

#include <ctime>

#include "npdr_revision.h"

namespace npdr::pipeline {

std::string creator_version() { return kVersion; }

std::string git_revision() { return kGitRevision; }

std::string instruction_set() {
  std::string text;
#if defined(__x86_64__)
  text = "x86-64";
#elif defined(__aarch64__)
  text = "aarch64";
#else
  text = "other";
#endif
#ifdef __AVX__
  text += " avx";
#endif
#ifdef __AVX2__
  text += " avx2";
#endif
#ifdef __FMA__
  text += " fma";
#endif
#ifdef __AVX512F__
  text += " avx512f";
#endif
#ifdef __ARM_FEATURE_SVE
  text += " sve";
#endif
  return text;
}

std::string now_utc() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace npdr::pipeline
