/// The files of one call of a simulator's command.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/temporary_folder.h"
#include "core/types.h"
#include "pipeline/store/file_format.h"
#include "sim/segments.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// A folder for the files of one call. Names are absolute.
class CallFolder {
 public:
  /// Throws Error.
  explicit CallFolder(FileFormat format);

  std::filesystem::path theta() const { return folder_.path() / ("theta" + extension_); }
  std::filesystem::path x() const { return folder_.path() / ("x" + extension_); }
  std::filesystem::path seeds() const { return folder_.path() / "seeds.txt"; }
  std::filesystem::path failed() const { return folder_.path() / "failed.txt"; }
  std::filesystem::path segments() const { return folder_.path() / ("segments" + extension_); }
  std::filesystem::path actions() const { return folder_.path() / ("actions" + extension_); }

 private:
  TemporaryFolder folder_;
  std::string extension_;
};

/// theta (n, P) with the names of its columns: CSV with the digits that give back the same doubles,
/// or the dataset `theta` with the attribute `labels`. Throws Error.
void write_theta_file(const std::filesystem::path& path, FileFormat format,
                      const std::vector<sim::Parameter>& parameters, const RowMatrix& theta);

/// Writes what rollouts are simulated over: a file of segments, a row each with the columns
/// `steps`, `past` and the first states; a file of actions, a row each step. CSV, or the datasets
/// `segments` and `actions`.
void write_segment_files(const CallFolder& folder, FileFormat format,
                         const sim::SimulatorInfo& info, const sim::Segments& segments);

/// One integer a line. Throws Error.
void write_seeds_file(const std::filesystem::path& path, std::span<const std::uint32_t> seeds);

}  // namespace npdr::pipeline
