#include "pipeline/store/artefact.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "pipeline/process/build_info.h"
#include "pipeline/process/progress.h"
#include "pipeline/store/hash.h"
#include "pipeline/store/hostile_json.h"
#include "pipeline/store/seal.h"

namespace npdr::pipeline {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kProvenance = "provenance";
constexpr const char* kSealed = "sealed";

void write_identity(h5::File& file, const Schema& schema, const Identity& identity) {
  file.set_attribute("schema", schema.name);
  file.set_attribute("schema_version", schema.version);
  file.set_attribute("stage", schema.stage);
  file.set_attribute("key", identity.key());
  file.set_attribute("key_document", canonical_json(identity.key_document));
  file.set_attribute("seed", static_cast<Index>(identity.seed));
  if (identity.inputs.empty()) return;
  std::vector<std::string> names, keys;
  for (const auto& [name, key] : identity.inputs) {
    names.push_back(name);
    keys.push_back(key);
  }
  file.set_attribute("inputs", names);
  file.set_attribute("input_keys", keys);
}

// Texts of the group 'provenance'.
constexpr std::array<std::pair<const char*, std::string Provenance::*>, 5> kTexts = {
    {{"creator_version", &Provenance::creator_version},
     {"git_revision", &Provenance::git_revision},
     {"instruction_set", &Provenance::instruction_set},
     {"host", &Provenance::host},
     {"created", &Provenance::created}}};

void write_provenance(h5::File& file, const Json& study, const Cost& cost) {
  const Provenance made{.creator_version = creator_version(),
                        .git_revision = git_revision(),
                        .instruction_set = instruction_set(),
                        .host = host_name(),
                        .created = now_utc(),
                        .batch_job = batch_job_id(),
                        .cost = cost};
  h5::Group group = file.create_group(kProvenance);
  group.set_attribute(kVolatile, Index{1});
  for (const auto& [name, text] : kTexts) group.set_attribute(name, made.*text);
  if (!made.batch_job.empty()) group.set_attribute("batch_job", made.batch_job);
  group.set_attribute("wall_seconds", cost.wall_seconds);
  group.set_attribute("core_seconds", cost.core_seconds);
  group.set_attribute(kSealed, Index{1});
  // Paths needn't be UTF-8; JSON must.
  group.set_attribute("study", study.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void require_complete(const h5::File& file) {
  if (!file.has_attribute("schema") || !file.has_attribute("schema_version")) {
    throw InputError(file.where() + ": isn't an artefact of this program");
  }
  if (!file.has_attribute("complete") || file.attribute<Index>("complete") != 1) {
    throw InputError(file.where() + ": is incomplete; remove it and run its stage again");
  }
}

void require_schema(const h5::File& file, const Schema& schema) {
  const auto name = file.attribute<std::string>("schema");
  const auto version = file.attribute<Index>("schema_version");
  if (name != schema.name) {
    throw InputError(fmt::format("{}: schema '{}', must be '{}'; give an artefact of stage '{}'",
                                 file.where(), name, schema.name, schema.stage));
  }
  if (version != schema.version) {
    throw InputError(fmt::format("{}: schema '{}' {}, this build reads {}; rerun stage '{}'",
                                 file.where(), name, version, schema.version, schema.stage));
  }
}

std::map<std::string, std::string> read_inputs(const h5::File& file) {
  std::map<std::string, std::string> inputs;
  if (!file.has_attribute("inputs")) return inputs;
  const auto names = file.attribute<std::vector<std::string>>("inputs");
  const auto keys = file.attribute<std::vector<std::string>>("input_keys");
  if (names.size() != keys.size()) {
    throw InputError(file.where() + ": names and keys of its inputs don't match");
  }
  for (std::size_t i = 0; i < names.size(); ++i) inputs[names[i]] = keys[i];
  return inputs;
}

}  // namespace

Json key_document(const Schema& schema) {
  return {{"stage", schema.stage}, {"schema_version", schema.version}};
}

Cost& Cost::operator+=(const Cost& other) {
  wall_seconds += other.wall_seconds;
  core_seconds += other.core_seconds;
  return *this;
}

Cost cost_of_seconds(double seconds) { return {seconds, seconds * num_threads()}; }

std::string Identity::key() const { return content_key(key_document); }

ArtefactWriter::ArtefactWriter(const std::filesystem::path& path, const Schema& schema,
                               Identity identity, const std::filesystem::path& scratch)
    : identity_(std::move(identity)),
      atomic_(path, scratch),
      file_(h5::File::create(atomic_.temporary(), path.string())) {
  write_identity(file_, schema, identity_);
}

void ArtefactWriter::finish() {
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  add_cost(cost_of_seconds(elapsed.count()));
  write_provenance(file_, identity_.study, earlier_);
  file_.set_attribute("complete", Index{1});
  file_.close();
  seal_file(atomic_.temporary(), atomic_.path());
  atomic_.commit();
  mark_progress();
}

namespace {

// Damage is found before the HDF5 library sees it, which may crash on it. `is_made`: a file that we
// made, which can be made again. What isn't damaged must not be removed: HDF5 didn't get all of its
// bytes.
h5::File open_undamaged(const std::filesystem::path& path, bool is_made) try {
  const bool has_seal = has_intact_seal(path);
  h5::File file = h5::File::open(path);
  if (!has_seal && file.is_group(kProvenance) && file.group(kProvenance).has_attribute(kSealed)) {
    throw DamagedFile(path.string() + ": is damaged: its end with the checksum is missing");
  }
  return file;
} catch (const InputError& error) {
  const std::string what = error.what();
  if (is_damaged(path)) throw DamagedFile(what + (is_made ? "; remove it and run again" : ""));
  if (!is_made || !has_intact_seal(path)) throw;
  throw Error(what + "; its checksum is right, so it couldn't be read just now: run again");
}

}  // namespace

h5::File open_artefact(const ArtefactFile& artefact, const Schema& schema) {
  const std::string& key = artefact.key;
  // Without a key somebody named the file, and it needn't be one of ours.
  h5::File file = open_undamaged(artefact.path, !key.empty());
  require_complete(file);
  require_schema(file, schema);
  const auto found = file.attribute<std::string>("key");
  if (!key.empty() && found != key) {
    throw InputError(fmt::format("{}: key {}, must be {}; remove it and rerun stage '{}'",
                                 file.where(), found, key, schema.stage));
  }
  return file;
}

std::optional<h5::File> open_artefact_if_there(const ArtefactFile& file, const Schema& schema) {
  try {
    return open_artefact(file, schema);
  } catch (const Error&) {
    if (std::filesystem::exists(file.path)) throw;
    return std::nullopt;
  }
}

ArtefactInfo read_artefact_info(const std::filesystem::path& path) {
  const h5::File file = open_undamaged(path, false);
  require_complete(file);
  const h5::Group provenance = file.group(kProvenance);
  ArtefactInfo info;
  info.schema = {file.attribute<std::string>("schema"), file.attribute<Index>("schema_version"),
                 file.attribute<std::string>("stage")};
  info.key = file.attribute<std::string>("key");
  info.identity.key_document =
      parse_json(file.attribute<std::string>("key_document"), file.where() + ": key_document");
  info.identity.inputs = read_inputs(file);
  info.identity.study =
      parse_json(provenance.attribute<std::string>("study"), provenance.where() + ": study");
  info.identity.seed = static_cast<std::uint64_t>(file.attribute<Index>("seed"));
  info.provenance = provenance_of(file);
  if (info.key != info.identity.key()) {
    throw InputError(file.where() +
                     ": its key isn't that of its key document: somebody changed it");
  }
  return info;
}

std::vector<std::string> own_attributes(const h5::File& file) {
  static const std::set<std::string> common = {"schema", "schema_version", "stage",
                                               "key",    "key_document",   "seed",
                                               "inputs", "input_keys",     "complete"};
  std::vector<std::string> own = file.attribute_names();
  std::erase_if(own, [](const std::string& name) { return common.contains(name); });
  return own;
}

// Files of earlier versions don't tell how many cores they had.
Provenance provenance_of(const h5::File& file) {
  const h5::Group group = file.group(kProvenance);
  Provenance made;
  for (const auto& [name, text] : kTexts) made.*text = group.attribute<std::string>(name);
  if (group.has_attribute("batch_job")) made.batch_job = group.attribute<std::string>("batch_job");
  made.cost.wall_seconds = group.attribute<double>("wall_seconds");
  made.cost.core_seconds = group.has_attribute("core_seconds")
                               ? group.attribute<double>("core_seconds")
                               : made.cost.wall_seconds;
  return made;
}

namespace {

using h5::ElementType;

// Rows are hashed in blocks of about this size, so that a file of any size can be digested.
constexpr Index kBlockBytes = 8 << 20;

template <class T>
void add_numbers(Hasher& hasher, const h5::Dataset& dataset) {
  dataset.require_readable(h5::element_type<T>());  // before room for what it claims is made
  const Index row_bytes = std::max<Index>(1, dataset.row_size() * static_cast<Index>(sizeof(T)));
  const Index block_rows = std::max<Index>(1, kBlockBytes / row_bytes);
  std::vector<T> block;
  for (Index begin = 0; begin < dataset.num_rows(); begin += block_rows) {
    const Index count = std::min(block_rows, dataset.num_rows() - begin);
    block.resize(static_cast<std::size_t>(count * dataset.row_size()));
    dataset.read_rows<T>(begin, count, block);
    hasher.add_bytes(block.data(), block.size() * sizeof(T));
  }
}

template <class T>
void add_attribute(Hasher& hasher, const h5::Object& object, const std::string& name) {
  const auto values = object.attribute<std::vector<T>>(name);
  hasher.add(static_cast<std::int64_t>(values.size()));
  for (const T& value : values) hasher.add(value);
}

void add_attributes(Hasher& hasher, const h5::Object& object) {
  for (const std::string& name : object.attribute_names()) {
    hasher.add("attribute " + name);
    const ElementType type = object.attribute_type(name);
    if (type == ElementType::text) {
      add_attribute<std::string>(hasher, object, name);
    } else if (type == ElementType::f32 || type == ElementType::f64) {
      add_attribute<double>(hasher, object, name);
    } else {
      add_attribute<Index>(hasher, object, name);
    }
  }
}

void add_dataset(Hasher& hasher, const h5::Dataset& dataset) {
  hasher.add(static_cast<std::int64_t>(dataset.type()));
  hasher.add(static_cast<std::int64_t>(dataset.shape().size()));
  for (const Index extent : dataset.shape()) hasher.add(extent);
  add_attributes(hasher, dataset);
  switch (dataset.type()) {
    case ElementType::f32:
      return add_numbers<float>(hasher, dataset);
    case ElementType::f64:
      return add_numbers<double>(hasher, dataset);
    case ElementType::u8:
      return add_numbers<std::uint8_t>(hasher, dataset);
    case ElementType::i64:
      return add_numbers<std::int64_t>(hasher, dataset);
    case ElementType::text:
      for (const std::string& text : dataset.read<std::string>()) hasher.add(text);
  }
}

// A file whose groups hold each other would never end.
constexpr int kMaxDepth = 32;
constexpr int kMaxGroups = 10'000;

void add_group(Hasher& hasher, const h5::Group& group, int& num_groups, int depth = 0) {
  if (depth > kMaxDepth) {
    throw InputError(fmt::format("{}: groups are nested {} deep, must be <= {}", group.where(),
                                 depth, kMaxDepth));
  }
  if (++num_groups > kMaxGroups) {
    throw InputError(fmt::format("{}: more than {} groups", group.where(), kMaxGroups));
  }
  add_attributes(hasher, group);
  for (const std::string& name : group.names()) {
    if (group.is_group(name)) {
      const h5::Group member = group.group(name);
      if (member.has_attribute(kVolatile)) continue;
      hasher.add("group " + name);
      add_group(hasher, member, num_groups, depth + 1);
    } else {
      const h5::Dataset member = group.dataset(name);
      if (member.has_attribute(kVolatile)) continue;
      hasher.add("dataset " + name);
      add_dataset(hasher, member);
    }
  }
  hasher.add("end");
}

}  // namespace

std::string content_digest(const std::filesystem::path& path) {
  Hasher hasher;
  int num_groups = 0;
  add_group(hasher, h5::File::open(path), num_groups);
  return hasher.hex();
}

}  // namespace npdr::pipeline
