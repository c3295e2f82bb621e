/// Artefacts as models (h5_model.h) that get their key and seal again after they were changed, as
/// by somebody who means harm.
#pragma once

#include <functional>

#include "pipeline/store/artefact.h"
#include "tests/fuzz/h5_model.h"

namespace npdr::pipeline {

/// The model of an artefact that `write` fills.
H5Model model_of(const Schema& schema, const std::function<void(h5::File&)>& write);

/// Replaces the file.
void write_sealed(H5Model model, const std::filesystem::path& path);

}  // namespace npdr::pipeline
