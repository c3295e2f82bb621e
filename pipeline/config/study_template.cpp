#include "pipeline/config/study_template.h"

#include <algorithm>
#include <optional>
#include <regex>
#include <set>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/study_keys.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kPlaceholder = "@NAME@";

// The template without what the fields say themselves. Lines of tables and of keys in them get
// their documentation, those of keys without a value their default; a line "# ..." stands for the
// keys from there to the next that the table's lines name.
constexpr const char* kSkeleton =
    R"toml(# A study: infer the physics parameters of a simulator from recorded motion.
# Check it with `npdr validate`, run it with `npdr run`. Lines that begin with "# key =" show a
# default. `npdr list keys` lists all keys, `npdr list simulators` the simulators' parameters.

[study]
name = "@NAME@"
seeds = [1, 2, 3]

# Either recorded rollouts, or, as here, rollouts that the simulator itself makes at a known truth:
[target]
truth = { pole_mass = 1.2, pole_length = 0.8 }
num_rollouts = 1
# ...
# Recorded rollouts take the place of truth and seed; `npdr import` makes a file of CSV files:
#   recording = "rollouts.h5"
# and some of them, in this order:
#   rollouts = [3, 4, 5, 1]
# Of a simulator that gives features x and no rollouts, x_o itself, or a truth:
#   observation = "x_o.csv"
# A truth's rollouts may have the initial states and actions of a recording:
#   inputs = "recording.h5"

[simulator]
name = "pendulum"
# parameters = { gravity = 9.81 }
# ...
# In place of a name, a simulator of your own or finished simulations: docs/external-simulators.md.
#   command = "python3 sim.py {theta} {x}"
#   worker = "python3 sim.py"
#   library = "sim.so"
#   mjcf = "robot.xml"
#   dataset = "dataset.h5"
#   states = ["q [rad]", "q_dot [rad/s]"]
#   actions = ["torque [N m]"]
#   ...
#   features = ["peak [m]", "mean"]
# Its domain parameters, each in a table of its own, and where its rollouts should come to rest:
#   [[simulator.parameter]]
#   name = "mass"
#   unit = "kg"
#   ...
#   [simulator.goal]
#   place = { q = 0.0 }
#   ...
# The simulator "minigolf" has settings of its own:
#   [simulator.minigolf]
#   ...

# What to infer: parameter = { uniform = [low, high] }, { log_uniform = [low, high] },
# { normal = [mean, std] } or { log_normal = [mean of log, std of log] }, in the simulator's units.
# The rest stay nominal.
[prior]
pole_mass = { uniform = [0.3, 1.7] }    # [kg]
pole_length = { uniform = [0.3, 1.7] }  # [m]

# When no parameter reproduces the recordings, noise of the size of what is left makes them look like
# simulations. It is Gaussian and independent from state to state, unless more is said.
[observation_noise]
# ...
#   scale_prior = [0.2, 1.0]
#   std = { theta = 0.01 }
#   correlation = 0.8
#   correlation_prior = [0.5, 1.5]
#   degrees_of_freedom = 4.0
#   degrees_of_freedom_prior = [3.7, 1.0]
# ...

[simulate]
# ...

# One [[method]] for each of the methods.
[[method]]
name = "NPDR (MAF)"
algorithm = "npe_c"
num_rounds = 2
num_simulations = 500
# ...
#   component_perturbation
# ...
#   num_iterations
#   policy_iterations
# published = { rmse = { mean = 0.263, std = 0.004 } }

[method.embedding]
kind = "bayessim"
# ...

[method.density_estimator]
kind = "maf"
# ...
num_transforms = 2
# ...
hidden_features = 20
# ...

[method.training]
learning_rate = 1e-3
# ...

# Of "nle", "nre_a" and "nre_b", whose posteriors have to be sampled:
#   [method.sampler]
#   ...

# Methods without a network. Of "abc_rejection", "abc_mcmc" and "abc_smc", in place of
# density_estimator, training and sampler:
#   [method.abc]
#   ...
# Of "linear_regression", which needs no simulations (simulator "furuta" only):
#   [method.linear_regression]
#   ...
# Of "refine", which makes the posterior of another method exact under the observation noise:
#   [method.refine]
#   ...

# Two that infer nothing, to compare policies with (studies with [policy] only): algorithm = "prior"
# is domain randomization over the prior, "nominal" takes the nominal parameters for granted.

[[method]]
name = "NPDR (MoG)"
algorithm = "npe_c"
num_rounds = 2
num_simulations = 500
embedding = { kind = "bayessim" }
density_estimator = { kind = "mdn", num_components = 5, hidden_features = 20 }

[evaluate]
num_samples = 100
# ...

# Checks of the posteriors: calibration over fresh simulations, and whether the observation is like
# what was simulated. Without this table those that cost little.
#   [diagnose]
#   checks = ["sbc", "coverage", "tarp", "local_c2st", "predictive", "ood", "training"]
#   ...

# Search for a policy that does well under the posterior, and tests of it in the target domain
# (simulator "furuta" only). Without this table there is none. A whole study to start from:
# experiments/furuta_policy.toml.
#   [policy]
#   optimizer = "power"
#   ...
# Domain parameters that policies are tested on, in [policy.grid.x] and [policy.grid.y]:
#   [policy.grid.x]
#   parameter = "pole_mass"
#   range = [0.018, 0.03]
#   ...
#   values = [0.018, 0.024]

# Named parameters to compare with, such as measured ones: a column in the tables each.
#   [[reference]]
#   name = "measured"
#   ...

[limits]
# ...

[report]
title = "Pendulum"
# ...

# What 'npdr submit' asks a cluster for; no result depends on it. Empty: the site's defaults.
#   [cluster]
#   ...
# Stages of their own: prepare, simulate, infer, baseline, evaluate, diagnose, policy, report.
#   [cluster.infer]
#   ...
)toml";

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

// Fills in a skeleton.
class TemplateWriter {
 public:
  explicit TemplateWriter(const std::string& skeleton) : lines_(split(skeleton, '\n')) {}

  std::string text() {
    for (std::size_t i = 0; i < lines_.size(); ++i) write(i);
    return text_;
  }

 private:
  using Key = std::vector<StudyKey>::const_iterator;

  void write(std::size_t i) {
    static const std::regex ellipsis(R"((# +)\.\.\.)");
    std::smatch match;
    if (const auto setting = setting_of(lines_[i])) {
      write_key(setting->prefix, setting->key, setting->value);
    } else if (std::regex_match(lines_[i], match, ellipsis)) {
      while (next_ != keys_.end() && !named_.contains(next_->name())) {
        write_key(match.str(1), next_, "");
      }
    } else {
      const std::string table = table_of(lines_[i]);
      explain(lines_[i], table);
      if (!table.empty()) begin(table, i + 1);
    }
  }

  void begin(const std::string& table, std::size_t line) {
    keys_ = keys_of_table(table);
    next_ = keys_.begin();
    named_.clear();
    for (; line < lines_.size() && table_of(lines_[line]).empty(); ++line) {
      if (const auto setting = setting_of(lines_[line])) named_.insert(setting->key->name());
    }
  }

  // Writes a line, with the documentation of a table where it begins one for the first time.
  void explain(const std::string& line, const std::string& table) {
    const auto known = std::ranges::find(tables_, table, &StudyTable::path);
    const bool is_new = known != tables_.end() && explained_.insert(table).second;
    text_ += is_new ? commented(line, known->doc) : line + "\n";
  }

  void write_key(const std::string& prefix, Key key, const std::string& value) {
    const std::string line =
        prefix + key->name() + " = " + (value.empty() ? key->default_value : value);
    const std::string choices = key->names.empty() ? "" : " (" + join(key->names) + ")";
    const bool is_new = explained_.insert(key->path).second;
    text_ += is_new ? commented(line, key->doc + choices) : line + "\n";
    next_ = key + 1;
  }

  // "[table]", "[[table]]" or one of them in a comment; "" for another line.
  static std::string table_of(const std::string& line) {
    static const std::regex header(R"((?:# +)?\[\[?([a-z_.]+)\].*)");
    std::smatch match;
    return std::regex_match(line, match, header) ? match.str(1) : "";
  }

  struct Setting {
    std::string prefix;  // "", or how a comment begins
    Key key;
    std::string value;  // "": its default
  };

  std::optional<Setting> setting_of(const std::string& line) const {
    static const std::regex setting(R"((# +)?([a-z_]+)(?: = (.+))?)");
    std::smatch match;
    if (!std::regex_match(line, match, setting)) return std::nullopt;
    const auto key = std::ranges::find(keys_, match.str(2), &StudyKey::name);
    if (key == keys_.end()) return std::nullopt;
    return Setting{match.str(1), key, match.str(3)};
  }

  std::vector<std::string> lines_;
  std::string text_;
  std::vector<StudyTable> tables_ = study_tables();
  std::vector<StudyKey> keys_;  // of the table that is being written
  Key next_ = keys_.begin();
  std::set<std::string> named_;      // keys that have a line of their own
  std::set<std::string> explained_;  // paths
};

}  // namespace

std::string study_template(const std::string& name) {
  const Constraint<std::string> allowed = folder_name();
  if (!satisfies(name, allowed)) {
    throw InputError(must_be("study.name", quoted(name), allowed.words));
  }
  std::string skeleton = kSkeleton;
  skeleton.replace(skeleton.find(kPlaceholder), std::string(kPlaceholder).size(), name);
  return TemplateWriter(skeleton).text();
}

}  // namespace npdr::pipeline
