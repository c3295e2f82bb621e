#include "pipeline/process/utc_time.h"

#include <fmt/chrono.h>

#include <ctime>

namespace npdr::pipeline {

std::string now_utc() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace npdr::pipeline
