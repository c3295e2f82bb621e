#include <algorithm>
#include <functional>

#include "core/error.h"
#include "pipeline/apps/commands.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/study_reader.h"
#include "pipeline/run/run_stage.h"
#include "tests/study_text.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class Verify : public FolderTest {
 protected:
  // What is said of an artefact that `write` has changed.
  std::string refusal(const Schema& schema, const std::function<void(ArtefactWriter&)>& write = {},
                      const nlohmann::ordered_json& study = {{"name", "s"}}) const {
    ArtefactWriter writer(folder_ / "a.h5", schema, {key_document(schema), {}, study, 1});
    if (write) write(writer);
    writer.finish();
    return problem([&] { verify(folder_ / "a.h5", {}); });
  }
};

TEST_F(Verify, RefusesAKeyThatIsntThatOfItsDocument) {
  EXPECT_TRUE(says(refusal(kProposalSchema,
                           [](ArtefactWriter& writer) {
                             writer.file().set_attribute("key", std::string(32, '0'));
                           }),
                   {"a.h5: its key isn't that of its key document"}));
}

TEST_F(Verify, SaysHowToCheckAPosteriorAndWhatThatCosts) {
  EXPECT_TRUE(says(refusal(kPosteriorSchema,
                           [](ArtefactWriter& writer) {
                             writer.add_cost({90.0, 180.0});
                           }),
                   {"a.h5: a posterior, which has no rows", "add --remake STUDY",
                    "which took 90.0 s (180.", "core-seconds)"}));
}

// A simulation whose rows come, as it says, from a command.
TEST_F(Verify, RunsNothingThatTheFileNamesUnlessToldTo) {
  const std::string command = "touch " + (folder_ / "ran").string() + "\ntrue";
  const std::string said = refusal(
      kSimulationSchema,
      [](ArtefactWriter& writer) {
        writer.file().write("theta", RowMatrix(RowMatrix::Ones(2, 1)));
        writer.file().write("x", RowMatrixF(RowMatrixF::Ones(2, 1)));
        writer.file().write("status", VectorX<std::uint8_t>(VectorX<std::uint8_t>::Zero(2)));
      },
      {{"name", "s"},
       {"simulator", {{"command", command}, {"folder", "/"}}},
       {"prior", nlohmann::ordered_json::array()}});
  EXPECT_TRUE(
      says(said, {"a.h5: to make its rows again runs, with your rights, the command \"touch ran",
                  "\\ntrue\" in the folder", "add --run-command if you trust them"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "ran"));
}

using Json = nlohmann::ordered_json;

const std::vector<Json> kOthers = {nullptr, -1, 1e300, "other", Json::array()};

// Each value at or below `at`: everything else in its place, and without it.
void for_each_change(const Json& document, const Json::json_pointer& at,
                     const std::function<void(const Json&, const std::string&)>& act) {
  for (const Json& other : kOthers) {
    Json changed = document;
    changed[at] = other;
    act(changed, at.to_string() + " = " + other.dump());
  }
  const Json& value = document.at(at);
  if (!value.is_structured()) return;
  for (const auto& [name, below] : value.items()) {
    Json changed = document;
    if (value.is_array()) {
      changed[at].erase(static_cast<std::size_t>(std::stoi(name)));
    } else {
      changed[at].erase(name);
    }
    act(changed, at.to_string() + " without " + name);
    for_each_change(document, value.is_array() ? at / std::stoul(name) : at / name, act);
  }
}

class VerifyDocuments : public FolderTest {
 protected:
  // Everything that a node needs, and itself.
  static void make(const Plan& plan, const Node& node) {
    for (const std::size_t input : node.needs) make(plan, plan.nodes[input]);
    run_stage(plan, node);
  }

  // Verifies the artefact with each change of its documents. Those that mean nothing to its rows
  // may pass; all others are refused, or give other rows.
  static void change_each(const Node& node, const std::function<void(h5::File&)>& write) {
    ArtefactInfo info = read_artefact_info(node.path);
    Json& study = info.identity.study;
    study = {{"simulator", study.at("simulator")}, {"prior", study.at("prior")}};  // what is read
    const auto verify_with = [&](const Identity& identity, const std::string& change) {
      ArtefactWriter writer(node.path, info.schema, identity);
      write(writer.file());
      writer.finish();
      try {
        verify(node.path, {.count = 1});
      } catch (const Error& error) {
        EXPECT_EQ(error.status(), ExitStatus::invalid_input) << change << ": " << error.what();
        EXPECT_TRUE(std::string(error.what()).find(".h5") != std::string::npos) << error.what();
      } catch (const std::exception& error) {
        ADD_FAILURE() << change << ": " << error.what();
      }
    };
    const auto with = [&](Json Identity::*document) {
      for_each_change(info.identity.*document, Json::json_pointer(),
                      [&](const Json& changed, const auto& change) {
                        Identity identity = info.identity;
                        identity.*document = changed;
                        verify_with(identity, change);
                      });
    };
    with(&Identity::key_document);
    with(&Identity::study);
    for (const auto& [name, key] : info.identity.inputs) {
      Identity identity = info.identity;
      identity.inputs.erase(name);
      verify_with(identity, "without input " + name);
      identity.inputs[name] = "../../other";
      verify_with(identity, "another input " + name);
    }
    verify_with(info.identity, "none");
    EXPECT_TRUE(verify(node.path, {}).different.empty()) << "and unchanged it's good";
  }

  Plan twenty_simulations() const {
    const std::string text =
        pendulum_study("s")
            .with("simulator", {"store_every = 100"})
            .method("A", {"num_simulations = 20", "algorithm = \"abc_rejection\""});
    return make_plan(parse_study(text, "s.toml"), WorkFolder(folder_.path()));
  }
};

TEST_F(VerifyDocuments, OfSimulationsAndProposalsAreCheckedAsTheyAreUsed) {
  const Plan plan = twenty_simulations();
  const Node& simulation = plan.node(Stage::simulate, {"A", 1, 1});
  make(plan, simulation);
  const auto read = [](const Node& node, const Schema& schema, const char* name) {
    return open_artefact(node.path, schema).dataset(name);
  };
  const h5::Shape shape = read(simulation, kSimulationSchema, "trajectories").shape();
  const auto trajectories = read(simulation, kSimulationSchema, "trajectories").read<float>();
  const auto theta = read(simulation, kSimulationSchema, "theta").read<double>();
  const auto write_theta = [&](h5::File& file) {
    file.create_dataset("theta", h5::ElementType::f64, {20, 2}).write_rows<double>(0, 20, theta);
  };
  change_each(simulation, [&](h5::File& file) {
    write_theta(file);
    file.create_dataset("trajectories", h5::ElementType::f32, shape)
        .write_rows<float>(0, 20, trajectories);
    file.write("status", VectorX<std::uint8_t>(VectorX<std::uint8_t>::Zero(20)));
  });
  change_each(plan.node(Stage::propose, {"A", 1, 1}), write_theta);
}

TEST_F(VerifyDocuments, AreNotToBlameForATargetThatIsDamaged) {
  const Plan plan = twenty_simulations();
  const Node& simulation = plan.node(Stage::simulate, {"A", 1, 1});
  make(plan, simulation);
  const auto target = std::ranges::find(plan.nodes, Stage::target, &Node::stage);
  std::filesystem::resize_file(target->path, std::filesystem::file_size(target->path) / 2);
  const std::string message = message_of<Error>([&] { verify(simulation.path, {}); });
  EXPECT_TRUE(has(message, target->key + ".h5")) << message;
  EXPECT_FALSE(has(message, "can't be done")) << message;
}

// What a document leads to may be gone, though the document is as its stage has written it.
TEST_F(VerifyDocuments, AreNotToBlameForALibraryThatIsGone) {
  const Plan plan = twenty_simulations();
  const Node& simulation = plan.node(Stage::simulate, {"A", 1, 1});
  make(plan, simulation);
  ArtefactInfo info = read_artefact_info(simulation.path);
  info.identity.study["simulator"] = {{"library", "gone.so"}};
  const h5::Shape shape =
      open_artefact(simulation.path, kSimulationSchema).dataset("trajectories").shape();
  ArtefactWriter writer(simulation.path, info.schema, info.identity);
  writer.file().create_dataset("theta", h5::ElementType::f64, {20, 2});
  writer.file().create_dataset("trajectories", h5::ElementType::f32, shape);
  writer.file().write("status", VectorX<std::uint8_t>(VectorX<std::uint8_t>::Zero(20)));
  writer.finish();
  const std::string message =
      message_of<InputError>([&] { verify(simulation.path, {.runs_command = true}); }, &folder_);
  EXPECT_NE(message.find(".h5: what its key document and study say can't be done: gone.so: "),
            std::string::npos)
      << message;
}

}  // namespace
}  // namespace npdr::pipeline
