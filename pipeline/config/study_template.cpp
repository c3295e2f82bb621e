// The commented study that `npdr new NAME` writes.

#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/study_keys.h"

namespace npdr::pipeline {
namespace {

struct Text {
  std::string_view path, text;
};

// What the study says; all other keys are comments.
constexpr Text kSettings[] = {
    {"study.seeds", "[1, 2, 3]"},
    {"target.truth", "{ pole_mass = 1.2, pole_length = 0.8 }"},
    {"target.num_rollouts", "1"},
    {"simulator.name", R"("pendulum")"},
    {"method.name", "\"NPDR (MAF)\""},
    {"method.algorithm", R"("npe_c")"},
    {"method.num_rounds", "2"},
    {"method.num_simulations", "500"},
    {"method.embedding.kind", R"("bayessim")"},
    {"method.density_estimator.kind", R"("maf")"},
    {"method.density_estimator.num_transforms", "2"},
    {"method.density_estimator.hidden_features", "20"},
    {"method.training.learning_rate", "1e-3"},
    {"evaluate.num_samples", "100"},
    {"report.title", R"("Pendulum")"},
};

// Values of keys whose default, if there is one, shows little.
constexpr Text kExamples[] = {
    {"target.recording", R"("rollouts.h5")"},
    {"target.observation", R"("x_o.csv")"},
    {"target.inputs", R"("recording.h5")"},
    {"target.rollouts", "[3, 4, 5, 1]"},
    {"simulator.parameters", "{ gravity = 9.81 }"},
    {"simulator.command", R"("python3 sim.py {theta} {x}")"},
    {"simulator.worker", R"("python3 sim.py")"},
    {"simulator.library", R"("sim.so")"},
    {"simulator.mjcf", R"("robot.xml")"},
    {"simulator.dataset", R"("dataset.h5")"},
    {"simulator.states", R"(["q [rad]", "q_dot [rad/s]"])"},
    {"simulator.actions", R"(["torque [N m]"])"},
    {"simulator.features", R"(["peak [m]", "mean"])"},
    {"simulator.parameter.name", R"("mass")"},
    {"simulator.parameter.unit", R"("kg")"},
    {"simulator.parameter.nominal", "1.0"},
    {"simulator.parameter.lower", "0.0"},
    {"simulator.parameter.upper", "10.0"},
    {"simulator.goal.place", "{ q = 0.0 }"},
    {"observation_noise.scale_prior", "[0.2, 1.0]"},
    {"observation_noise.std", "{ theta = 0.01 }"},
    {"observation_noise.correlation", "0.8"},
    {"observation_noise.correlation_prior", "[0.5, 1.5]"},
    {"observation_noise.degrees_of_freedom", "4.0"},
    {"observation_noise.degrees_of_freedom_prior", "[3.7, 1.0]"},
    {"method.published", "{ rmse = { mean = 0.263, std = 0.004 } }"},
    {"diagnose.checks", R"(["sbc", "coverage", "ood", "training"])"},
    {"policy.optimizer", R"("power")"},
    {"policy.grid.x.parameter", R"("pole_mass")"},
    {"policy.grid.x.range", "[0.018, 0.03]"},
    {"policy.grid.x.values", "[0.018, 0.024]"},
    {"reference.name", R"("measured")"},
};

// Text in front of tables, but for what their documentation says.
constexpr Text kIntroductions[] = {
    {"study",
     R"(# A study: infer the physics parameters of a simulator from recorded motion.
# Check it with `npdr validate`, run it with `npdr run`. Lines that begin with "# key =" show a
# default, those with "#   key =" what another study may say. `npdr list keys` lists all keys,
# `npdr list simulators` the simulators' parameters.

)"},
    {"target", "# Recorded rollouts, or, as here, rollouts that the simulator makes at a truth:\n"},
    {"simulator",
     "# A simulator of your own, or finished simulations, may take the place of the name:\n"
     "# docs/external-simulators.md.\n"},
    {"prior",
     R"(# What to infer: parameter = { uniform = [low, high] }, { log_uniform = [low, high] },
# { normal = [mean, std] } or { log_normal = [mean of log, std of log] }, in the simulator's units;
# "npdr list priors" has more. The rest stay nominal.
[prior]
pole_mass = { uniform = [0.3, 1.7] }    # [kg]
pole_length = { uniform = [0.3, 1.7] }  # [m]

)"},
    {"observation_noise",
     "# When no parameter reproduces the recordings, noise of the size of what is left makes them\n"
     "# look like simulations. It is Gaussian and independent from state to state, unless more is\n"
     "# said.\n"},
    {"method", "# One [[method]] for each of the methods.\n"},
    {"evaluate",
     R"toml(# Two algorithms infer nothing, to compare policies with (studies with [policy] only): "prior" is
# domain randomization over the prior, "nominal" takes the nominal parameters for granted.

[[method]]
name = "NPDR (MoG)"
algorithm = "npe_c"
num_rounds = 2
num_simulations = 500
embedding = { kind = "bayessim" }
density_estimator = { kind = "mdn", num_components = 5, hidden_features = 20 }

)toml"},
    {"diagnose", "# Without this table, checks that cost little.\n"},
    {"policy",
     "# Search for a policy that does well under the posterior (simulator \"furuta\" only). A "
     "whole\n"
     "# study to start from: experiments/furuta_policy.toml.\n"},
    {"cluster", "# What 'npdr submit' asks a cluster for; no result depends on it.\n"},
};

// Tables that this study goes without.
constexpr std::array<std::string_view, 4> kLeftOut = {"diagnose", "policy", "reference", "cluster"};

// The text at `path`; "" for none.
std::string text_at(std::span<const Text> texts, const std::string& path) {
  const auto found = std::ranges::find(texts, path, &Text::path);
  return found == texts.end() ? "" : std::string(found->text);
}

// A line with its comment behind it, or below it; what is too long goes on in further lines.
std::string commented(const std::string& line, const std::string& comment) {
  constexpr std::size_t column = 32, longest = 60, width = 110;
  const std::string below = line.starts_with('#') ? "#" : "";
  std::string text, row = line;
  if (row.size() > longest) {
    text = row + "\n";
    row = below;
  }
  row.resize(std::max(column, row.size() + 2), ' ');
  row += '#';
  for (const std::string& word : split(comment, ' ')) {
    if (row.size() + 1 + word.size() > width) {
      text += row + "\n";
      row = below;
      row.resize(column, ' ');
      row += "#  ";
    }
    row += ' ' + word;
  }
  return text + row + "\n";
}

// Writes tables with the keys of their description.
class TemplateWriter {
 public:
  explicit TemplateWriter(const std::string& name) : name_(name) {}

  // `is_aside`: it means nothing to this study, which shows it in comments.
  void write(const Field& field, bool is_aside) {
    const std::string path = display(field.path);
    text_ += text_at(kIntroductions, path);
    if (field.kind == Field::Kind::value) return;  // the prior
    const std::string name = field.kind == Field::Kind::list ? "[" + path + "]" : path;
    text_ += commented((is_aside ? "#   [" : "[") + name + "]", field.doc);
    const Fields& members = field.members.front();
    if (is_new(members)) {
      for (const Field& member : members) write_key(member, is_aside);
    }
    text_ += "\n";
    for (const Field& member : members) {
      if (member.kind == Field::Kind::value) continue;
      write(member, is_aside || !member.use.unused.empty());
    }
  }

  const std::string& text() const { return text_; }

 private:
  // Tables that are alike, such as the stages of [cluster], have their keys explained once.
  bool is_new(const Fields& members) {
    std::string docs;
    for (const Field& member : members) docs += member.doc;
    return told_.insert(docs).second;
  }

  void write_key(const Field& field, bool is_aside) {
    if (field.kind != Field::Kind::value) return;
    const std::string path = display(field.path);
    const std::string setting =
        path == "study.name" ? "\"" + name_ + "\"" : text_at(kSettings, path);
    const std::string example = text_at(kExamples, path);
    const bool is_default = setting.empty() && example.empty();
    const bool is_of_others = is_aside || !field.use.unused.empty() || !is_default;
    const std::string mark = !setting.empty() ? "" : is_of_others ? "#   " : "# ";
    const std::string choices = field.names.empty() ? "" : " (" + join(field.names) + ")";
    text_ +=
        commented(mark + field.key + " = " + (is_default ? default_text(field) : setting + example),
                  field.doc + choices);
  }

  const std::string& name_;
  std::string text_;
  std::set<std::string> told_;
};

}  // namespace

std::string study_template(const std::string& name) {
  const Constraint<std::string> allowed = folder_name();
  if (!satisfies(name, allowed)) {
    throw InputError(must_be("study.name", quoted(name), allowed.words));
  }
  Study study = study_with_lists();
  study.simulator.name = "pendulum";
  study.methods.front().algorithm.kind = inference::Algorithm::npe_c;
  TemplateWriter writer(name);
  for (const Field& field : fields_of(study)) {
    writer.write(field, std::ranges::count(kLeftOut, field.key) > 0);
  }
  return writer.text();
}

}  // namespace npdr::pipeline
