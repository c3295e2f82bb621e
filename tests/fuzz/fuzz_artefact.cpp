// Artefacts of the other stages, as the descriptions of their layouts say that they are.
#include <charconv>
#include <functional>

#include "pipeline/artefacts/asked_rows_file.h"
#include "pipeline/artefacts/diagnosis_file.h"
#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/artefacts/layout.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/sealed_model.h"

namespace npdr::pipeline {
namespace {

using Path = std::filesystem::path;

// An artefact whose members are listed, and what is done with what is read.
struct Kind {
  Schema schema;
  void (*list)(Layout);
  std::function<void(const Path&)> read;
};

void use(const PolicyCheckpoint& checkpoint) {
  inference::make_policy_optimizer({}, checkpoint.optimizer)->state();
}
void use(const RefinementCheckpoint& checkpoint) {
  const inference::ImportanceState& state = checkpoint.state;
  if (state.levels.empty()) return;
  const RowMatrix& u = state.levels.front().u;
  try {
    inference::ImportanceSampler({.level_size = u.rows()}, u.cols(), {}, {}, state);
  } catch (const ShapeError&) {  // the state of no refinement
  }
}
void use(const Diagnosis& diagnosis) { diagnosis.p_values(); }
void use(const AskedRows& asked) { shards_of(asked, "a posterior's"); }
template <class T>
void use(const T&) {}

// Groups that their tables leave to another's.
template <class T>
void list_all(Layout f) {
  Artefact<T>::list(f);
  if constexpr (std::is_same_v<T, PolicyCheckpoint>) Artefact<FoundPolicy>::list(f);
  if constexpr (std::is_same_v<T, RefinementCheckpoint>) list_certificate(f);
}

template <class T>
Kind kind_of(const Artefact<T>& artefact) {
  return {artefact, list_all<T>, [&](const Path& path) { use(artefact.read(path)); }};
}

void read_theta(const Path& path) {
  const h5::Dataset theta = open_proposal(path);
  read_proposal(theta, {0, theta.num_rows()});
}

void read_simulation(const Path& path) {
  const h5::File file = open_artefact(path, kSimulationSchema);
  simulated_values(file).read<float>();
  failures(file);
  warnings_of(file);
}

void read_rows(const Path& path) {
  read_simulated_rows(path.parent_path(), {{0, 1}, "", path.filename()});
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = [] {
    std::vector<Kind> made = {
        {kTargetSchema, list_observation, [](const Path& p) { read_target_artefact(p); }},
        {kProposalSchema, kProposalSchema.list, read_theta},
        {kSimulationSchema, list_simulation, read_simulation},
        {kSimulatedRowsSchema, kSimulatedRowsSchema.list, read_rows}};
    std::apply([&](const auto&... each) { (made.push_back(kind_of(each)), ...); }, kArtefacts);
    return made;
  }();
  return all;
}

// "(n, 101)": a number is itself, a name 1.
h5::Shape shape_of(const std::string& text) {
  h5::Shape shape;
  for (std::size_t begin = 1; begin + 1 < text.size();) {
    const std::size_t end = std::min(text.find(", ", begin), text.size() - 1);
    Index extent = 1;
    std::from_chars(text.data() + begin, text.data() + end, extent);
    shape.push_back(extent);
    begin = end + 2;
  }
  return shape;
}

H5Value value_of(const LayoutRow& row) {
  if (row.type.starts_with("text")) return {h5::ElementType::text, shape_of(row.shape), {}, {"a"}};
  if (row.type == "uint8") return {h5::ElementType::u8, shape_of(row.shape), {0.0}, {}};
  if (row.type == "int64") return {h5::ElementType::i64, shape_of(row.shape), {1.0}, {}};
  const bool is_single = row.type == "float32";
  return {is_single ? h5::ElementType::f32 : h5::ElementType::f64,
          shape_of(row.shape),
          {0.5, 0.25},
          {}};
}

H5Model model_of(const Kind& kind) {
  H5Model model = model_of(kind.schema, [](h5::File&) {});
  const Layout layout = Layout::lister();
  kind.list(layout);
  for (const LayoutRow& row : layout.rows()) {
    const std::string path = row.path.substr(0, row.path.find(','));
    H5Value value = value_of(row);
    if (path.find('@') != std::string::npos) value.shape = {1};
    model.add(path, value);
    if (row.meaning.find("`labels`") == std::string::npos) continue;
    for (const char* attribute : {"@labels", "@units"}) {
      model.add(path + attribute, {h5::ElementType::text, {1}, {}, {"a"}});
    }
  }
  model.add_groups();
  return model;
}

const std::vector<H5Model>& models() {
  static const std::vector<H5Model> all = [] {
    std::vector<H5Model> made;
    for (const Kind& kind : kinds()) made.push_back(model_of(kind));
    return made;
  }();
  return all;
}

}  // namespace

std::vector<std::string> artefact_seeds() {
  std::vector<std::string> seeds;
  for (std::size_t i = 0; i < models().size(); ++i) seeds.emplace_back(1, static_cast<char>(i));
  return seeds;
}

void fuzz_artefact(std::string_view input, const Path& folder) {
  InputBytes bytes(input);
  const std::size_t kind = bytes.below(models().size());
  H5Model model = models()[kind];
  model.edit(bytes);
  const Path path = folder / "a.h5";
  write_sealed(model, path);
  read_artefact_info(path);
  content_digest(path);
  kinds()[kind].read(path);
}

}  // namespace npdr::pipeline
