/// The files of one call of a simulator's command.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"
#include "pipeline/store/file_format.h"
#include "sim/segments.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// A folder for the files of one call, below the system's folder of temporary files; removed with
/// all that is in it. Names are absolute.
class CallFolder {
 public:
  /// Throws Error.
  explicit CallFolder(FileFormat format);
  ~CallFolder();
  CallFolder(const CallFolder&) = delete;
  CallFolder& operator=(const CallFolder&) = delete;

  std::filesystem::path theta() const { return path_ / ("theta" + extension_); }
  std::filesystem::path x() const { return path_ / ("x" + extension_); }
  std::filesystem::path seeds() const { return path_ / "seeds.txt"; }
  std::filesystem::path segments() const { return path_ / ("segments" + extension_); }
  std::filesystem::path actions() const { return path_ / ("actions" + extension_); }

 private:
  std::filesystem::path path_;
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
