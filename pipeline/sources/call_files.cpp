#include "pipeline/sources/call_files.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>

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
               const RowMatrix& values) {
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "{}\n", fmt::join(names, ","));
  for (Index i = 0; i < values.rows(); ++i) {
    fmt::format_to(std::back_inserter(text), "{}\n",
                   fmt::join(values.row(i).begin(), values.row(i).end(), ","));
  }
  write_file(path, fmt::to_string(text));
}

void write_hdf5(const std::filesystem::path& path, const std::vector<std::string>& names,
                const RowMatrix& values) {
  h5::File file = h5::File::create(path);
  h5::Dataset dataset = file.write(path.stem().string(), values, {.chunked = false});
  dataset.set_attribute("labels", names);
  file.close();
}

// A table of numbers; in HDF5 the dataset has the name of the file.
void write_table(const std::filesystem::path& path, FileFormat format,
                 const std::vector<std::string>& names, const RowMatrix& values) {
  format == FileFormat::csv ? write_csv(path, names, values) : write_hdf5(path, names, values);
}

}  // namespace

CallFolder::CallFolder(FileFormat format)
    : folder_("npdr-call", "calls of the simulator's command leave their files there"),
      extension_(format == FileFormat::csv ? ".csv" : ".h5") {}

void write_theta_file(const std::filesystem::path& path, FileFormat format,
                      const std::vector<sim::Parameter>& parameters, const RowMatrix& theta) {
  std::vector<std::string> names;
  for (const sim::Parameter& parameter : parameters) names.push_back(parameter.name);
  write_table(path, format, names, theta);
}

void write_segment_files(const CallFolder& folder, FileFormat format,
                         const sim::SimulatorInfo& info, const sim::Segments& segments) {
  std::vector<std::string> names = {"steps", "past"}, actions;
  for (const Channel& channel : info.state_channels) names.push_back(channel.label);
  for (const Channel& channel : info.action_channels) actions.push_back(channel.label);
  RowMatrix rows(segments.num_segments(), 2 + segments.num_states());
  for (Index s = 0; s < rows.rows(); ++s) {
    const auto i = static_cast<std::size_t>(s);
    rows.row(s) << static_cast<double>(segments.steps[i]), static_cast<double>(segments.past[i]),
        segments.first_states.row(s);
  }
  write_table(folder.segments(), format, names, rows);
  write_table(folder.actions(), format, actions, segments.actions);
}

void write_seeds_file(const std::filesystem::path& path, std::span<const std::uint32_t> seeds) {
  write_file(path, fmt::format("{}\n", fmt::join(seeds, "\n")));
}

}  // namespace npdr::pipeline
