/// Studies that tests begin with, as TOML, and what each changes of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

namespace npdr {

/// `text` with `from` replaced by `to`; the test fails unless `from` occurs.
inline std::string edited(const std::string& text, const std::string& from, const std::string& to) {
  std::string result = text;
  const std::size_t begin = text.find(from);
  EXPECT_NE(begin, std::string::npos) << from;
  if (begin != std::string::npos) result.replace(begin, from.size(), to);
  return result;
}

/// A study in the making: tables in the order in which they come, each with lines "key = value".
/// Without a table [diagnose] it says that posteriors aren't checked: tests count what is made.
class StudyText {
 public:
  using Lines = std::vector<std::string>;

  explicit StudyText(const std::string& name) { with("study", {"name = \"" + name + "\""}); }

  /// Adds lines to a table, in place of those with the same keys.
  StudyText& with(const std::string& table, const Lines& lines) {
    const std::string header = "[" + table + "]";
    auto found = std::ranges::find(tables_, header, &Table::header);
    if (found == tables_.end()) found = tables_.insert(found, {header, {}});
    for (const std::string& line : lines) {
      const auto same = std::ranges::find(found->lines, key_of(line), key_of);
      if (same == found->lines.end()) {
        found->lines.push_back(line);
      } else {
        *same = line;
      }
    }
    return *this;
  }

  /// Replaces a table.
  StudyText& only(const std::string& table, const Lines& lines) {
    const auto found = std::ranges::find(tables_, "[" + table + "]", &Table::header);
    if (found != tables_.end()) found->lines.clear();
    return with(table, lines);
  }

  /// Adds one to the tables of this name.
  StudyText& add(const std::string& table, const Lines& lines) {
    tables_.push_back({"[[" + table + "]]", lines});
    return *this;
  }

  StudyText& method(const std::string& name, Lines lines = {}) {
    lines.insert(lines.begin(), "name = \"" + name + "\"");
    return add("method", lines);
  }

  operator std::string() const {
    std::string text;
    for (const Table& table : tables_) {
      text += table.header + "\n";
      for (const std::string& line : table.lines) text += line + "\n";
    }
    const bool is_checked = std::ranges::count(tables_, "[diagnose]", &Table::header) > 0;
    return text + (is_checked ? "" : "[diagnose]\nchecks = []\n");
  }
  friend std::ostream& operator<<(std::ostream& stream, const StudyText& study) {
    return stream << std::string(study);
  }

 private:
  struct Table {
    std::string header;
    Lines lines;
  };
  static std::string key_of(const std::string& line) { return line.substr(0, line.find(' ')); }

  std::vector<Table> tables_;
};

/// One rollout of a pendulum with nominal parameters; its mass and length are to be found.
inline StudyText pendulum_study(const std::string& name) {
  return StudyText(name)
      .with("target", {"truth = {}", "num_rollouts = 1"})
      .with("simulator", {"name = \"pendulum\""})
      .with("prior", {"pole_mass = { uniform = [0.3, 1.7] }",  //
                      "pole_length = { uniform = [0.3, 1.7] }"});
}

/// One swing-up of a Furuta pendulum with nominal parameters; its pole's mass is to be found.
inline StudyText furuta_study(const std::string& name) {
  return StudyText(name)
      .with("target", {"truth = {}", "num_rollouts = 1"})
      .with("simulator", {"name = \"furuta\""})
      .with("prior", {"pole_mass = { uniform = [0.0168, 0.0312] }"});
}

/// Two strikes of a mini golf with another ball, and one to test by.
inline StudyText minigolf_study(const std::string& name) {
  return StudyText(name)
      .with("target", {"truth = { ball_radius = 0.0231 }", "num_rollouts = 2", "held_out = 1"})
      .with("simulator", {"name = \"minigolf\"", "store_every = 2"})
      .with("prior", {"ball_restitution = { uniform = [0.0, 1.0] }",
                      "obstacle2_dyaw = { uniform = [-1.5707963267948966, 1.5707963267948966] }"});
}

/// A program of the user's, beside an observation.
inline StudyText command_study(const std::string& name) {
  return StudyText(name)
      .with("target", {"observation = \"x_o.csv\""})
      .with("simulator", {"command = \"sh simulate.sh {theta} {x}\""})
      .with("prior", {"a = { uniform = [0.0, 1.0] }", "b = { uniform = [0.0, 1.0] }"});
}

/// Simulations that are there already, beside an observation.
inline StudyText dataset_study(const std::string& name) {
  return command_study(name).only("simulator", {"dataset = \"data.h5\""});
}

/// The table of a search for policies that takes no time.
inline StudyText::Lines few_trials() {
  return {"num_domain_parameters = 2", "num_initial_states = 2", "num_test_states = 20",
          "initial = { energy_gain = 20.0 }"};
}

/// Lines of methods with networks that take no time.
inline const std::string kSmallFlow =
    "density_estimator = { kind = \"maf\", num_networks = 2, num_transforms = 2, "
    "hidden_features = 10 }";
inline const std::string kSmallMixture =
    "density_estimator = { kind = \"mdn\", num_networks = 1, num_components = 2, "
    "hidden_features = 10 }";

}  // namespace npdr
