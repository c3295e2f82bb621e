/// What a report says of posteriors that two kinds of networks make together.
#pragma once

#include <string>

#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// A paragraph for people who didn't choose them, since they are the default; "" without any.
std::string pooling_text(const Study& study);

}  // namespace npdr::pipeline
