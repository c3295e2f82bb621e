/// Makes an artefact a second time.
#pragma once

#include <filesystem>
#include <string>

#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// An artefact of a plan that is made again, from the plan's inputs of it, in a folder of its own.
class Remake {
 public:
  /// Throws InputError for a file that HDF5 doesn't survive, that isn't complete or that the plan
  /// knows nothing of, and when an input isn't there.
  Remake(const std::filesystem::path& file, Plan plan);

  /// What is made, and what that cost the first time.
  std::string title() const;
  /// How its maker differs from this program, as far as bits may depend on it; "": not at all.
  std::string difference_of_builds() const;

  /// Makes it; whether it holds the same bits. Throws what the stage throws, and Error when a stop
  /// was requested: nothing of it stays.
  bool gives_same_bits();

 private:
  std::filesystem::path file_;
  Plan plan_;
  Node node_;
  Provenance provenance_;
};

}  // namespace npdr::pipeline
