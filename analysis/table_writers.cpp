#include "analysis/table_writers.h"

#include "core/atomic_file.h"
#include "core/file_error.h"

namespace npdr::analysis {

std::vector<std::filesystem::path> table_files(std::string_view name,
                                               const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files;
  for (const TableFormat& format : kTableFormats) {
    files.push_back(directory / (std::string(name) + format.extension));
  }
  return files;
}

void write_table(const Table& table, const std::filesystem::path& directory) {
  for (const TableFormat& format : kTableFormats) {
    write_text_file(directory / (table.name + format.extension), format.to_text(table));
  }
}

void remove_table(std::string_view name, const std::filesystem::path& directory) {
  for (const std::filesystem::path& path : table_files(name, directory)) {
    std::error_code error;
    std::filesystem::remove(path, error);
    if (error) throw_file_error(path, "be removed", error.value());
  }
}

}  // namespace npdr::analysis
