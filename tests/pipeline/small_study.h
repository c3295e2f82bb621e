/// A small valid study that tests take apart, and what the reader says of studies.
#pragma once

#include <string>
#include <vector>

#include "core/error.h"
#include "pipeline/config/study_reader.h"
#include "tests/message_of.h"
#include "tests/study_text.h"

namespace npdr::pipeline {

/// A small valid study that tests take apart: messages tell places in this text.
inline constexpr const char* kStudyText = R"toml([study]
name = "small"
seeds = [1, 2]

[target]
truth = { pole_mass = 1.1 }

[simulator]
name = "pendulum"

[prior]
pole_mass = { uniform = [0.3, 1.7] }
pole_length = { log_uniform = [0.3, 1.7] }

[[method]]
name = "NPDR (MAF)"
num_simulations = 200

[[method]]
name = "NPDR (MoG)"
density_estimator = { kind = "mog" }
)toml";

/// The problems of a study's text, as the reader reports them; "" when there are none.
inline std::string problems_of(const std::string& text,
                               const std::vector<std::string>& overrides = {}) {
  return message_of<InputError>([&] { parse_study(text, "s.toml", overrides); });
}

/// The problems of the small study after one edit.
inline std::string problems_after(const std::string& from, const std::string& to) {
  return problems_of(edited(kStudyText, from, to));
}

}  // namespace npdr::pipeline
