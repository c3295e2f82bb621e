/// Files that are complete or absent, whatever happens while they are written.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace npdr {

/// A folder and those above it, unless they are there. Throws Error as AtomicFile.
void make_folder(const std::filesystem::path& folder);

/// A file in the making: it is written under another name in the same folder and takes its own name
/// in one step when it is complete. The other name is ".<name>.<host>.<pid>.<random digits>.tmp",
/// new in the folder; what a dead process of this host left behind there is removed on the way.
class AtomicFile {
 public:
  /// Makes the folder if there is none. Throws Error when it can't be written to: says why and what
  /// to do, and InputError where the name is a device's or pipe's. `scratch`: a folder of this
  /// machine to write in first, from where commit() copies the file; empty: none.
  explicit AtomicFile(std::filesystem::path path, const std::filesystem::path& scratch = {});
  /// Removes the temporary unless commit() has been called.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// The path to write to. The caller closes the file before it calls commit().
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Brings the content to the disk, then gives it its name, in place of an old file of that name.
  /// Throws Error when that fails; an old file is then still there.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path beside_;     ///< the temporary in the folder of `path_`
  std::filesystem::path temporary_;  ///< the same, or in scratch
  bool committed_ = false;
};

/// Writes a text as a whole or not at all. Throws Error.
void write_text_file(const std::filesystem::path& path, std::string_view text);

/// The whole file. Throws Error.
std::string read_text_file(const std::filesystem::path& path);

/// A new name in the folder of `path` for what becomes `path` when it is complete, in the way of
/// AtomicFile: whoever comes next removes what a dead process has left there.
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// Removes the temporaries in `folder`, files and folders, of processes of this host that no longer
/// run. Returns how many.
int remove_stale_temporaries(const std::filesystem::path& folder);

/// Calls remove_stale_temporaries() the first time that this process asks for this folder: looking
/// through a folder of a thousand shards for each of them would take longer than to write them.
void remove_stale_temporaries_once(const std::filesystem::path& folder);

/// Names of the files in `folder` that processes of this host are writing in the way of AtomicFile,
/// and the numbers of those processes.
std::map<std::string, int> files_in_the_making(const std::filesystem::path& folder);

/// Name of this machine.
std::string host_name();

/// Name of the space in which process numbers mean the same as here: this machine, or on it this
/// container, which may share the machine's name and folders.
const std::string& process_space();

}  // namespace npdr
