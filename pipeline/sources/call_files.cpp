#include "pipeline/sources/call_files.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_error.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {
namespace {

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw_file_error(path, "write this file", errno);
}

void write_csv(const std::filesystem::path& path, const std::vector<std::string>& names,
               const RowMatrix& theta) {
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "{}\n", fmt::join(names, ","));
  for (Index i = 0; i < theta.rows(); ++i) {
    fmt::format_to(std::back_inserter(text), "{}\n",
                   fmt::join(theta.row(i).begin(), theta.row(i).end(), ","));
  }
  write_file(path, fmt::to_string(text));
}

void write_hdf5(const std::filesystem::path& path, const std::vector<std::string>& names,
                const RowMatrix& theta) {
  h5::File file = h5::File::create(path);
  h5::Dataset dataset = file.write("theta", theta, {.chunked = false});
  dataset.set_attribute("labels", names);
  file.close();
}

}  // namespace

CallFolder::CallFolder(FileFormat format) : extension_(format == FileFormat::csv ? ".csv" : ".h5") {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  if (error) {
    throw InputError(
        fmt::format("TMPDIR = '{}', must be an existing folder: calls of the "
                    "simulator's command leave their files there",
                    parent.string()));
  }
  remove_stale_temporaries_once(parent);
  do {
    path_ = temporary_name(std::filesystem::absolute(parent) / "npdr-call");
  } while (mkdir(path_.c_str(), 0700) != 0 && errno == EEXIST);
  if (!std::filesystem::is_directory(path_)) throw_file_error(path_, "make this folder", errno);
}

CallFolder::~CallFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void write_theta_file(const std::filesystem::path& path, FileFormat format,
                      const std::vector<sim::Parameter>& parameters, const RowMatrix& theta) {
  std::vector<std::string> names;
  for (const sim::Parameter& parameter : parameters) names.push_back(parameter.name);
  format == FileFormat::csv ? write_csv(path, names, theta) : write_hdf5(path, names, theta);
}

void write_seeds_file(const std::filesystem::path& path, std::span<const std::uint32_t> seeds) {
  write_file(path, fmt::format("{}\n", fmt::join(seeds, "\n")));
}

}  // namespace npdr::pipeline
