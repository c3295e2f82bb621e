// Artefacts of the other stages, as the descriptions of their layouts say that they are.
#include <charconv>

#include "pipeline/artefacts/asked_rows_file.h"
#include "pipeline/artefacts/baseline_file.h"
#include "pipeline/artefacts/checkpoint_file.h"
#include "pipeline/artefacts/diagnosis_file.h"
#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/policy_outcomes.h"
#include "pipeline/artefacts/proposal_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/artefacts/target_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/sealed_model.h"

namespace npdr::pipeline {
namespace {

using Path = std::filesystem::path;

struct Artefact {
  Schema schema;
  void (*list)(Layout);
  void (*read)(const Path&);
};

void read_search(const Path& path) {
  const auto checkpoint = read_policy_checkpoint(path);
  if (checkpoint) inference::make_policy_optimizer({}, checkpoint->optimizer)->state();
}

void list_refined(Layout f) {
  list_refinement_checkpoint(f);
  list_certificate(f);
}

void read_refined(const Path& path) {
  const inference::ImportanceState state = read_refinement(path).state;
  if (state.levels.empty()) return;
  const RowMatrix& u = state.levels.front().u;
  try {
    inference::ImportanceSampler({.level_size = u.rows()}, u.cols(), {}, {}, state);
  } catch (const ShapeError&) {  // the state of no refinement
  }
}

void list_search(Layout f) {
  list_policy(f);
  list_policy_checkpoint(f);
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

void read_asked(const Path& path) {
  if (const auto asked = read_asked_rows(path)) shards_of(*asked, "a posterior's");
}

void read_rows(const Path& path) {
  read_simulated_rows(path.parent_path(), {{0, 1}, "", path.filename()});
}

const std::vector<Artefact> kArtefacts = {
    {kAskedRowsSchema, list_asked_rows, read_asked},
    {kBaselineSchema, list_baseline, [](const Path& p) { read_baseline(p); }},
    {kDiagnosisSchema, list_diagnosis, [](const Path& p) { read_diagnosis(p).p_values(); }},
    {kEvaluationSchema, list_evaluation, [](const Path& p) { read_evaluation(p); }},
    {kTargetSchema, list_observation, [](const Path& p) { read_target_artefact(p); }},
    {kPolicySchema, list_policy, [](const Path& p) { read_policy(p), read_policy_history(p); }},
    {kPolicyCheckpointSchema, list_search, read_search},
    {kPolicyTestSchema, list_policy_test, [](const Path& p) { read_policy_test(p); }},
    {kProposalSchema, list_proposal, read_theta},
    {kSimulationSchema, list_simulation, read_simulation},
    {kSimulatedRowsSchema, list_simulated_rows, read_rows},
    {kCheckpointSchema, list_training_checkpoint, [](const Path& p) { read_checkpoint(p); }},
    {kRefinementCheckpointSchema, list_refined, read_refined}};

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

H5Model model_of(const Artefact& artefact) {
  H5Model model = model_of(artefact.schema, [](h5::File&) {});
  const Layout layout = Layout::lister();
  artefact.list(layout);
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
    for (const Artefact& artefact : kArtefacts) made.push_back(model_of(artefact));
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
  kArtefacts[kind].read(path);
}

}  // namespace npdr::pipeline
