#include "sim/library/library_simulator.h"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/printable.h"
#include "core/text.h"
#include "sim/library/npdr_simulator.h"
#include "sim/simulator_check.h"

namespace npdr::sim {
namespace {

constexpr std::int64_t kMostMembers = 100'000;  // parameters or channels that aren't nonsense
constexpr Index kMostRowsPerCall = 32;
constexpr std::size_t kLongestFingerprint = std::size_t{1} << 24;

// The text behind a pointer that a library has given us, up to a length that isn't nonsense.
std::string raw_text_of(const char* text, std::size_t most) {
  return text == nullptr ? "" : std::string(text, strnlen(text, most));
}

// The same as UTF-8: it stands in studies and reports.
std::string text_of(const char* text, std::size_t most = 4096) {
  return printable(raw_text_of(text, most));
}

// How many bytes an ELF file must have for its segments to be there; 0 for what is none. Whoever
// maps more of a file than there is, as dlopen() does, is ended by the system when it looks there.
std::uint64_t least_size_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  Elf64_Ehdr head = {};
  if (!file.read(reinterpret_cast<char*>(&head), sizeof head)) return 0;
  const bool is_elf = std::memcmp(head.e_ident, ELFMAG, SELFMAG) == 0;
  if (!is_elf || head.e_ident[EI_CLASS] != ELFCLASS64 || head.e_ident[EI_DATA] != ELFDATA2LSB) {
    return 0;  // dlopen() says so
  }
  std::uint64_t size = head.e_phoff + std::uint64_t{head.e_phnum} * sizeof(Elf64_Phdr);
  file.seekg(static_cast<std::streamoff>(head.e_phoff));
  for (Elf64_Half i = 0; i < head.e_phnum; ++i) {
    Elf64_Phdr segment = {};
    if (!file.read(reinterpret_cast<char*>(&segment), sizeof segment)) break;
    if (segment.p_type == PT_LOAD) size = std::max(size, segment.p_offset + segment.p_filesz);
  }
  return size;
}

npdr_batch batch_of(const Segments& segments, const RowMatrix& theta,
                    const std::vector<std::uint32_t>& seeds) {
  return {theta.rows(),
          segments.num_segments(),
          segments.num_steps(),
          segments.dt,
          theta.data(),
          seeds.data(),
          segments.steps.data(),
          segments.past.data(),
          segments.first_states.data(),
          segments.actions.data()};
}

// While this thread is in the library's code: a library that calls exit() there would end the
// program as if all were done.
class InLibrary {
 public:
  explicit InLibrary(const std::filesystem::path& file) : before_(file_) {
    static const bool is_registered = std::atexit(&refuse_exit) == 0;
    static_cast<void>(is_registered);
    file_ = file.c_str();
    process_ = getpid();
  }
  ~InLibrary() { file_ = before_; }
  InLibrary(const InLibrary&) = delete;
  InLibrary& operator=(const InLibrary&) = delete;

 private:
  static void refuse_exit() {
    if (file_ == nullptr || getpid() != process_) return;  // a child of the library may exit
    std::fflush(nullptr);                                  // what the library has said
    std::fprintf(stderr, "%s: calls exit(), which ends the program; must return an error\n", file_);
    _exit(EXIT_FAILURE);
  }

  static thread_local const char* file_;
  static thread_local pid_t process_;
  const char* before_;
};

thread_local const char* InLibrary::file_ = nullptr;
thread_local pid_t InLibrary::process_ = 0;

std::string no_words() { return ""; }

}  // namespace

// The loaded library, and instances of its simulator that no thread uses at the moment.
class LibrarySimulator::Instances {
 public:
  explicit Instances(const LibraryConfig& config)
      : config_(config), watch_(config.file, config.time_limit, config.end_late) {
    load();
    free_.push_back({open(), {}});
    try {
      describe(free_.back().made);
    } catch (...) {  // nobody destroys what isn't made
      close_all();
      throw;
    }
  }
  Instances(const Instances&) = delete;
  Instances& operator=(const Instances&) = delete;
  ~Instances() { close_all(); }

  const SimulatorInfo& info() const { return info_; }
  const std::string& fingerprint() const { return fingerprint_; }

  // Simulates a batch on an instance that is free, and hands its states to `use`, a function.
  template <class Use>
  void replay(const npdr_batch& batch, std::uint8_t* status, const Use& use) {
    Instance instance = take();
    const Index size = batch.num_rows * batch.num_steps * std::ssize(info_.state_channels);
    if (std::ssize(instance.states) < size) instance.states.resize(static_cast<std::size_t>(size));
    try {
      const auto replayed = [&](char* error) {
        return library_->replay(instance.made, &batch, instance.states.data(), status, error);
      };
      call("replay", replayed, [&] { return words_of(batch); });
      use(instance.states.data());
    } catch (...) {  // nobody knows what state it is in
      close(instance);
      throw;
    }
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(instance));
  }

 private:
  // Room for states that is kept: to get it anew would take as long as short rows do.
  struct Instance {
    npdr_instance* made;
    std::vector<double> states;
  };

  void close(const Instance& instance) {
    const InLibrary in_library(config_.file);
    const CallWatch::Call watched(watch_, "close", no_words);
    library_->close(instance.made);
  }

  void close_all() {
    for (const Instance& instance : free_) close(instance);
  }

  void load() {
    std::error_code unreadable;
    const std::string file = std::filesystem::absolute(config_.file, unreadable).string();
    if (!std::filesystem::is_regular_file(file, unreadable)) {
      fail("isn't there, must be a shared library that 'cc -shared -fPIC' has made");
    }
    const std::uint64_t least = least_size_of(file), size = std::filesystem::file_size(file);
    if (size < least) {
      fail(fmt::format("has {} bytes of {}: it was cut; compile or copy it again", size, least));
    }
    const InLibrary in_library(config_.file);
    const CallWatch::Call watched(watch_, "npdr_simulator", no_words);
    // It stays loaded: threads that it may have started, and exit handlers, are in its code.
    void* const handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) fail("can't be loaded: " + text_of(dlerror()));
    using Exported = const npdr_library* (*)();
    const auto exported = reinterpret_cast<Exported>(dlsym(handle, "npdr_simulator"));
    if (exported == nullptr) {
      fail("exports no function npdr_simulator(), which npdr_simulator.h declares");
    }
    library_ = exported();
    if (library_ == nullptr) fail("npdr_simulator() returned NULL");
    if (library_->version != NPDR_SIMULATOR_VERSION) {
      fail(
          fmt::format("has version {} of the interface, must be {}: compile it with this npdr's "
                      "npdr_simulator.h",
                      library_->version, NPDR_SIMULATOR_VERSION));
    }
    if (library_->open == nullptr || library_->describe == nullptr || library_->replay == nullptr ||
        library_->close == nullptr) {
      fail("npdr_simulator() leaves out one of open, describe, replay and close");
    }
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(config_.file.string() + ": " + problem);
  }

  // Calls a function of the library; what it says when it fails, or throws, becomes an exception.
  template <class Function>
  void call(const char* name, const Function& function, CallWatch::Words words = no_words) {
    std::array<char, NPDR_ERROR_SIZE> error = {};
    std::string problem;
    const InLibrary in_library(config_.file);
    const CallWatch::Call watched(watch_, name, std::move(words));
    try {
      if (function(error.data()) == 0) return;
      error.back() = '\0';
      problem = text_of(error.data());
      if (problem.empty()) problem = "no reason given";
    } catch (const std::exception& thrown) {
      problem = fmt::format("threw an exception: {}", thrown.what());
    } catch (...) {
      problem = "threw an exception";
    }
    throw InputError(fmt::format("{}: {}() failed: {}", config_.file.string(), name, problem));
  }

  // The rows that a call is about.
  std::string words_of(const npdr_batch& batch) const {
    std::vector<std::string> values;
    for (std::size_t p = 0; p < info_.parameters.size(); ++p) {
      values.push_back(fmt::format("{} = {}", info_.parameters[p].name, batch.theta[p]));
    }
    return fmt::format(" for {}, the first of which has {}, seed = {}",
                       counted(batch.num_rows, "row"), join(values), batch.seeds[0]);
  }

  npdr_instance* open() {
    npdr_instance* instance = nullptr;
    const std::string folder = config_.folder.string();
    call("open", [&](char* error) {
      return library_->open(config_.settings.c_str(), folder.c_str(), &instance, error);
    });
    if (instance == nullptr) fail("open() succeeded, but made no simulator");
    return instance;
  }

  Instance take() {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        Instance instance = std::move(free_.back());
        free_.pop_back();
        return instance;
      }
    }
    return {open(), {}};
  }

  void describe(npdr_instance* instance) {
    npdr_description found = {};
    call("describe", [&](char* error) { return library_->describe(instance, &found, error); });
    require_list("parameters", found.num_parameters, found.parameters, 0);
    require_list("states", found.num_states, found.states, 1);
    require_list("actions", found.num_actions, found.actions, 0);
    info_.name = found.name == nullptr ? config_.file.stem().string() : text_of(found.name, 100);
    info_.description = text_of(found.text);
    fingerprint_ = raw_text_of(found.fingerprint, kLongestFingerprint);
    if (fingerprint_.size() == kLongestFingerprint)
      fail("describe() gives a fingerprint without end");
    for (std::int64_t p = 0; p < found.num_parameters; ++p) add_parameter(found.parameters[p]);
    info_.state_channels = channels("state", found.states, found.num_states);
    info_.action_channels = channels("action", found.actions, found.num_actions);
  }

  void require_list(const char* what, std::int64_t count, const void* members, std::int64_t least) {
    if (count < least || count > kMostMembers || (count > 0 && members == nullptr)) {
      fail(fmt::format("describe() gives {} {}{}, must be {} to {}", count, what,
                       members == nullptr ? " at NULL" : "", least, kMostMembers));
    }
  }

  // They head columns, and are keys of studies.
  std::string name_of(const char* what, const char* name, std::set<std::string>& names) const {
    const std::string text = raw_text_of(name, 200);
    if (text.empty() || text.size() > 100 || printable_line(text) != text) {
      fail(fmt::format("describe() calls a {} {}, must be text of 1 to 100 bytes in UTF-8", what,
                       npdr::quoted(printable_line(text))));
    }
    if (!names.insert(text).second) {
      fail(fmt::format("describe() gives two of the name {}, must be unique", npdr::quoted(text)));
    }
    return text;
  }

  void add_parameter(const npdr_parameter& found) {
    Parameter parameter;
    parameter.name = name_of("parameter", found.name, names_);
    parameter.unit = found.unit == nullptr ? "1" : text_of(found.unit, 100);
    parameter.nominal = found.nominal;
    parameter.lower = found.lower;
    parameter.upper = found.upper;
    parameter.period = found.period;
    parameter.description = text_of(found.description);
    if (!(found.lower <= found.nominal && found.nominal <= found.upper) ||
        !std::isfinite(found.nominal)) {
      fail(
          fmt::format("describe() says that {} is {} by default, must be a number in its limits "
                      "[{}, {}]",
                      npdr::quoted(parameter.name), found.nominal, found.lower, found.upper));
    }
    if (!(found.period >= 0.0 && std::isfinite(found.period))) {
      fail(fmt::format("describe() says that {} has the period {}, must be >= 0",
                       npdr::quoted(parameter.name), found.period));
    }
    info_.parameters.push_back(std::move(parameter));
  }

  std::vector<Channel> channels(const char* what, const npdr_channel* found, std::int64_t count) {
    std::vector<Channel> all;
    std::set<std::string> labels;
    for (std::int64_t c = 0; c < count; ++c) {
      all.push_back({name_of(what, found[c].label, labels),
                     found[c].unit == nullptr ? "1" : text_of(found[c].unit, 100)});
    }
    return all;
  }

  LibraryConfig config_;
  CallWatch watch_;
  const npdr_library* library_ = nullptr;
  SimulatorInfo info_;
  std::string fingerprint_;
  std::set<std::string> names_;  // of parameters
  std::mutex mutex_;
  std::vector<Instance> free_;
};

LibrarySimulator::LibrarySimulator(const LibraryConfig& config)
    : instances_(std::make_unique<Instances>(config)) {}
LibrarySimulator::~LibrarySimulator() = default;

const SimulatorInfo& LibrarySimulator::info() const { return instances_->info(); }

const std::string& LibrarySimulator::fingerprint() const { return instances_->fingerprint(); }

Trajectories LibrarySimulator::replay(const Segments& segments, Index store_every,
                                      const RowMatrix& theta,
                                      std::span<const std::uint32_t> seeds) const {
  check_num_parameters(theta.cols(), info());
  if (std::ssize(info().state_channels) != segments.num_states() ||
      std::ssize(info().action_channels) != segments.actions.cols()) {
    throw InputError(fmt::format("target has {} state and {} action channels; '{}' has {} and {}",
                                 segments.num_states(), segments.actions.cols(), info().name,
                                 info().state_channels.size(), info().action_channels.size()));
  }
  Trajectories result = empty_trajectories(segments, theta.rows(), store_every);
  const Index row_size = segments.num_steps() * segments.num_states();
  // Several calls for each thread, since rows may take longer than others.
  const Index rows_per_call =
      std::clamp<Index>(theta.rows() / (4 * num_threads()), 1, kMostRowsPerCall);
  const Index calls = (theta.rows() + rows_per_call - 1) / rows_per_call;
  parallel_for(calls, [&](Index c) {
    const Index first = c * rows_per_call, end = std::min(first + rows_per_call, theta.rows());
    std::vector<Index> rows;  // that can be simulated
    std::vector<std::uint32_t> row_seeds;
    for (Index i = first; i < end; ++i) {
      if (is_possible(theta.row(i), info())) {
        rows.push_back(i);
        row_seeds.push_back(seeds[static_cast<std::size_t>(i)]);
      } else {
        lose_row(i, RolloutStatus::out_of_limits, result);
      }
    }
    if (rows.empty()) return;
    const RowMatrix part = theta(rows, Eigen::all);
    std::vector<std::uint8_t> status(rows.size(), NPDR_OK);
    instances_->replay(
        batch_of(segments, part, row_seeds), status.data(), [&](const double* states) {
          for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto ended = static_cast<RolloutStatus>(status[i]);
            if (ended > RolloutStatus::out_of_limits) {
              throw Error(fmt::format("'{}': replay() gives a row the status {}, must be 0, 1 or 2",
                                      info().name, static_cast<int>(status[i])));
            }
            if (ended != RolloutStatus::ok) {
              lose_row(rows[i], ended, result);
            } else {
              store_states(segments, states + static_cast<Index>(i) * row_size, store_every,
                           rows[i], result);
            }
          }
        });
  });
  return result;
}

}  // namespace npdr::sim
