/// Reads study files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Reads and checks the study file `file`.
///
/// `overrides` are "dotted.key=value" with TOML values, applied in order before anything is
/// checked; a bare word that isn't TOML counts as text. `method.num_rounds=2` sets the key of every
/// method, `method."NPDR (MAF)".num_rounds=2` that of one. Setting target.truth removes
/// target.recording. Setting target.recording removes target.truth, and all settings of a truth in
/// the file. A recording's relative path starts at the study file's folder, or at the current
/// folder when an override gives it.
///
/// The result is resolved: defaults filled in, older spellings of names replaced, units of the
/// prior taken from the simulator. Throws one InputError that reports every problem on a line of
/// its own:
///   study.toml:14:17: method.training.learning_rate = -0.1, must be > 0
///   --set simulate.shard_size=0: simulate.shard_size = 0, must be >= 1 and <= 10^9
/// `site`: what [cluster] has where the study leaves keys out.
Study read_study(const std::filesystem::path& file, const std::vector<std::string>& overrides = {},
                 const ClusterConfig& site = {});

/// The same for a study's text; `file` names it in messages and gives its folder.
Study parse_study(std::string_view text, const std::filesystem::path& file,
                  const std::vector<std::string>& overrides = {}, const ClusterConfig& site = {});

/// A site's file: nothing but a table [cluster]. Throws InputError as above.
ClusterConfig read_site(const std::filesystem::path& file);

}  // namespace npdr::pipeline
