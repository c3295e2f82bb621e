/// Rules between the fields of a study. Private to pipeline/config.
#pragma once

#include "pipeline/config/problems.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Checks a study whose fields have been read one by one, and takes the prior's units from the
/// simulator. Problems go to `reading`; a field that already has one isn't checked against others.
void check_study(Study& study, Reading& reading);

}  // namespace npdr::pipeline
