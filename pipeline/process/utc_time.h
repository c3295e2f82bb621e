/// The time of day, for provenance only: nothing is decided by it.
#pragma once

#include <string>

namespace npdr::pipeline {

/// Now, such as "2024-03-01T12:00:00Z".
std::string now_utc();

}  // namespace npdr::pipeline
