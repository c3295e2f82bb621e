/// Artefacts: what a stage makes, with where it comes from. Each is one HDF5 file.
///
/// Attributes of the file say what it is: schema, schema_version, stage, key, key_document, inputs
/// (and input_keys beside them), seed, complete. The group 'provenance' says who made it, when and
/// where: creator_version, git_revision, instruction_set, host, batch_job, created, wall_seconds,
/// core_seconds, study. Runs that computed the same thing may differ in it, and in every other
/// group or dataset with the attribute kVolatile, such as the seconds that each row took.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/atomic_file.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

/// Kind of artefact that a file is, and the stage that makes it.
struct Schema {
  std::string name;   ///< such as "posterior"
  Index version = 1;  ///< raised whenever the meaning of the content changes
  std::string stage;  ///< to rerun for a new one, such as "infer"
};

/// The begin of every key document: stage and schema version.
nlohmann::ordered_json key_document(const Schema& schema);

/// Everything that an artefact is made from.
struct Identity {  // NOLINT(bugprone-exception-escape): moving JSON doesn't throw
  nlohmann::ordered_json key_document;        ///< everything that it depends on
  std::map<std::string, std::string> inputs;  ///< keys of the artefacts that it is made from
  nlohmann::ordered_json study;               ///< resolved
  std::uint64_t seed = 0;

  /// The artefact's key: content_key(key_document).
  std::string key() const;
};

/// An artefact: where it lies, and which one it must be.
struct ArtefactFile {
  ArtefactFile() = default;
  ArtefactFile(std::filesystem::path file, std::string its_key = "")
      : path(std::move(file)), key(std::move(its_key)) {}

  std::filesystem::path path;
  std::string key;  ///< empty: any
};

/// Time that it took to make something.
struct Cost {
  double wall_seconds = 0.0;
  double core_seconds = 0.0;  ///< wall time by the threads that it had

  Cost& operator+=(const Cost& other);
};

/// Cost of so many seconds of work on all threads of this process.
Cost cost_of_seconds(double seconds);

/// Who made an artefact, when and where.
struct Provenance {
  std::string creator_version;
  std::string git_revision;
  std::string instruction_set;
  std::string host;
  std::string created;    ///< UTC, such as "2024-03-01T12:00:00Z"
  std::string batch_job;  ///< id of the batch system's task; "": none
  Cost cost;
};

/// Everything that an artefact says about itself.
struct ArtefactInfo {  // NOLINT(bugprone-exception-escape): moving JSON doesn't throw
  Schema schema;
  std::string key;
  Identity identity;
  Provenance provenance;
};

/// An artefact in the making, made before the work begins: a folder that can't be written to is an
/// error before hours were spent. Only finish() gives the file its name.
class ArtefactWriter {
 public:
  /// `scratch`: see AtomicFile.
  ArtefactWriter(const std::filesystem::path& path, const Schema& schema, Identity identity,
                 const std::filesystem::path& scratch = {});

  h5::File& file() { return file_; }

  /// Counts work that was done before the constructor, such as that of shards.
  void add_cost(const Cost& cost) { earlier_ += cost; }

  /// Writes who made it and how long that took since the constructor, marks the artefact as
  /// complete and gives it its name. Throws Error.
  void finish();

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  Cost earlier_;
  Identity identity_;
  AtomicFile atomic_;
  h5::File file_;
};

/// open_artefact() of a file that may not be there, such as a checkpoint, which another process may
/// remove at any instant.
std::optional<h5::File> open_artefact_if_there(const ArtefactFile& file, const Schema& schema);

/// Opens a complete artefact of this schema, and of this key when that isn't empty. Throws
/// InputError otherwise: says what was found, what is expected and which stage to rerun.
h5::File open_artefact(const ArtefactFile& artefact, const Schema& schema);

/// Of any schema. Throws InputError for a file that isn't a complete artefact.
ArtefactInfo read_artefact_info(const std::filesystem::path& path);

/// Attributes that a stage has added to those of every artefact.
std::vector<std::string> own_attributes(const h5::File& file);

/// Throws InputError.
Provenance provenance_of(const h5::File& file);

/// Attribute that excludes a group or dataset from content_digest().
inline constexpr const char* kVolatile = "volatile";

/// XXH3-128 of what an artefact holds, 32 hexadecimal digits: names, types, shapes and values of
/// all datasets and attributes in the order of their names. How values are chunked and compressed
/// doesn't count. Equal digests: the same bits were computed.
/// Throws InputError for a file that can't be read.
std::string content_digest(const std::filesystem::path& path);

}  // namespace npdr::pipeline
