/// Who may include whom: core <- {sim, inference, analysis} <- pipeline. The three siblings never
/// include each other; the folders of pipeline are layers in one order, and no include runs against
/// it; HDF5 and TOML each stay in one of them.
///
/// The rules hold for any source tree of that layout; tests check them on small ones of their own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace npdr::architecture {

/// A line of a source file that includes something.
struct Include {
  std::filesystem::path file;  ///< relative to the root, as below
  int line = 0;
  std::string text;  ///< as written between the quotes or brackets
  std::filesystem::path
      path;  ///< of the included file relative to the root; empty: not one of ours
};

/// The folders that the rules know, those that others may include first.
std::vector<std::string> known_folders();

/// The layers of pipeline, those that others may include first.
std::vector<std::string> known_layers();

/// All includes of the *.h and *.cpp files anywhere below root/folder, sorted by file and line.
/// Throws Error when there is no such folder or a file can't be read.
std::vector<Include> includes_below(const std::filesystem::path& root, const std::string& folder);

/// Rules that includes break, one message each, such as
///   sim/pendulum.cpp:3: includes analysis/table.h; sim may include only: core, sim
///   sim/pendulum.cpp:4: includes hdf5.h; only pipeline/store may include HDF5
/// Empty when all is well. `include` is of a known folder.
std::vector<std::string> broken_rules(const Include& include);

/// The same for all known folders of a source tree.
std::vector<std::string> broken_rules(const std::filesystem::path& root);

/// The files foo.cpp next to a foo.h that don't include it before anything else. That foo.cpp
/// compiles by itself, without precompiled headers, proves that foo.h includes all that it needs
/// only when nothing comes before it.
std::vector<std::string> late_own_headers(const std::filesystem::path& root);

}  // namespace npdr::architecture
