#include "core/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/file_error.h"
#include "core/open_file.h"

namespace npdr {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".tmp";

// Messages call it `shown_as`.
void sync(const fs::path& path, int flags, const fs::path& shown_as) {
  const OpenFile file(path, flags);
  if (file.is_open() && ::fsync(file.value()) == 0) return;
  // Some network file systems can't do this for folders, and need no telling.
  if (file.is_open() && (errno == EINVAL || errno == ENOTSUP)) return;
  throw_file_error(shown_as, "be brought to the disk", errno);
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// The process that a temporary of this host belongs to; 0 for every other name.
pid_t owner(const std::string& name) {
  const std::string host = fmt::format(".{}.", process_space());
  const std::size_t begin = name.rfind(host);
  if (!name.starts_with('.') || !name.ends_with(kSuffix) || begin == std::string::npos) return 0;
  const char* const end = name.data() + name.size() - kSuffix.size();
  pid_t process = 0;
  const auto [stop, error] = std::from_chars(name.data() + begin + host.size(), end, process);
  return error == std::errc() && stop < end && *stop == '.' ? process : 0;
}

// Ended, but nobody has asked how yet: in a container without an init process that is for good.
bool is_zombie(pid_t process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string text;
  std::getline(file, text);  // pid (name) state ...: the name may hold anything
  const std::size_t end = text.rfind(") ");
  return end != std::string::npos && (text[end + 2] == 'Z' || text[end + 2] == 'X');
}

bool is_dead(pid_t process) {
  return ::kill(process, 0) != 0 ? errno == ESRCH : is_zombie(process);
}

// In a folder that others may write to, too, somebody who knew the next name could put a link there
// that leads us elsewhere.
std::string unpredictable_digits() {
  std::uint64_t number = 0;
  [[maybe_unused]] const ssize_t count = ::getrandom(&number, sizeof(number), 0);
  return fmt::format("{:016x}", number);
}

// Renaming onto a device or pipe would put an end to it, for all programs.
void require_replaceable(const fs::path& path) {
  std::error_code unknown;
  // A link to one, too: /dev/stdout is.
  if (!fs::is_other(fs::status(path, unknown))) return;
  throw InputError(path.string() + ": is a device, pipe or socket, must be a file or a new name");
}

// Makes an empty file, and its folder: what can't be written is known before any work is done.
void reserve(const fs::path& file, const fs::path& shown_as) {
  make_folder(folder_of(file));
  remove_stale_temporaries_once(folder_of(file));
  if (!OpenFile(file, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW).is_open()) {
    throw_file_error(shown_as, "be written", errno);
  }
}

void remove_quietly(const fs::path& file) {
  std::error_code ignored;
  fs::remove(file, ignored);
}

}  // namespace

std::map<std::string, int> files_in_the_making(const fs::path& folder) {
  std::map<std::string, int> found;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (const auto end = fs::directory_iterator(); !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const pid_t process = owner(name);
    if (process == 0 || is_dead(process)) continue;
    found[name.substr(1, name.rfind(fmt::format(".{}.", process_space())) - 1)] = process;
  }
  return found;
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw_file_error(folder, "be made a folder", error.value());
}

fs::path temporary_name(const fs::path& path) {
  return folder_of(path) / fmt::format(".{}.{}.{}.{}{}", path.filename().string(), process_space(),
                                       ::getpid(), unpredictable_digits(), kSuffix);
}

AtomicFile::AtomicFile(fs::path path, const fs::path& scratch)
    : path_(std::move(path)),
      beside_(temporary_name(path_)),
      temporary_(scratch.empty() ? beside_ : scratch / beside_.filename()) {
  require_replaceable(path_);
  reserve(beside_, path_);
  if (temporary_ == beside_) return;
  try {
    reserve(temporary_, temporary_);
  } catch (...) {
    remove_quietly(beside_);
    throw;
  }
}

AtomicFile::~AtomicFile() {
  if (!committed_) remove_quietly(beside_);
  if (temporary_ != beside_) remove_quietly(temporary_);
}

void AtomicFile::commit() {
  if (temporary_ != beside_) {
    std::error_code error;
    fs::copy_file(temporary_, beside_, fs::copy_options::overwrite_existing, error);
    if (error) throw_file_error(path_, "be written", error.value());
  }
  sync(beside_, O_RDONLY, path_);
  if (::rename(beside_.c_str(), path_.c_str()) != 0) {
    throw_file_error(path_, "be given its name", errno);
  }
  committed_ = true;
  sync(folder_of(path_), O_RDONLY | O_DIRECTORY, path_);
}

void write_text_file(const fs::path& path, std::string_view text) {
  AtomicFile file(path);
  OpenFile open(file.temporary(), O_WRONLY | O_TRUNC | O_NOFOLLOW);
  if (!open.is_open() || !open.write(text) || !open.close()) {
    throw_file_error(path, "be written", errno);
  }
  file.commit();
}

std::string read_text_file(const fs::path& path) {
  const OpenFile file(path, O_RDONLY);
  if (!file.is_open()) throw_read_error(path, errno);
  std::string text;
  std::array<char, 65536> buffer;
  for (;;) {
    const ssize_t count = ::read(file.value(), buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_read_error(path, errno);
    if (count == 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

int remove_stale_temporaries(const fs::path& folder) {
  int removed = 0;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const pid_t process = owner(entry->path().filename().string());
    if (process <= 0 || !is_dead(process)) continue;
    std::error_code failed;
    const std::uintmax_t count = fs::remove_all(entry->path(), failed);
    removed += !failed && count > 0 ? 1 : 0;
  }
  return removed;
}

void remove_stale_temporaries_once(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<fs::path> done;
  const std::lock_guard lock(mutex);
  if (done.insert(folder).second) remove_stale_temporaries(folder);
}

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "unknown";
  return name.data();
}

namespace {

std::string find_process_space() {
  constexpr ino_t of_the_machine = 4026531836;  // Linux numbers its first namespaces so
  struct stat space = {};
  const bool is_known = ::stat("/proc/self/ns/pid", &space) == 0;
  std::string host = host_name();
  // Points are between the parts of a temporary's name: "n1.cluster" would end like "cluster".
  std::ranges::replace(host, '.', '~');
  if (!is_known || space.st_ino == of_the_machine) return host;
  return fmt::format("{}-{}", host, space.st_ino);
}

}  // namespace

const std::string& process_space() {
  static const std::string space = find_process_space();
  return space;
}

}  // namespace npdr
