#include <memory>

#include "core/error.h"
#include "pipeline/config/checker.h"
#include "sim/policy_task.h"

namespace npdr::pipeline {
namespace {

class PolicyChecker : Checker {
 public:
  using Checker::Checker;

  void check() {
    if (!study_.policy.is_used() || !reading_.good("policy.optimizer")) return;
    must_be_left_out({"evaluate.leave_out"}, "policies are tested, not their predictions");
    must_be_left_out(unused_fields(fields_of(study_.policy), "policy"));
    const inference::PolicySearchConfig& search = study_.policy.search;
    require("policy.min_std", search.min_std, search.min_std <= search.initial_std,
            fmt::format("<= policy.initial_std = {}", search.initial_std));
    if (!info_ || !has_task()) return;
    check_initial();
    if (check_values("policy.model", study_.policy.model)) check_model();
    check_grid();
  }

 private:
  bool has_task() {
    const std::vector<std::string> able = sim::simulators_with_policy_task();
    if (study_.source().is_built_in && std::ranges::count(able, info_->name) > 0) return true;
    fail("policy", fmt::format("policy needs simulator.name = '{}', found '{}': it has no "
                               "task for a policy",
                               join(able, "' or '"), info_->name));
    return false;
  }

  void check_initial() {
    const auto task = sim::make_policy_task({.name = study_.simulator.name});
    const auto& parameters = task->info().parameters;
    std::vector<std::string> names;
    for (const sim::PolicyParameter& parameter : parameters) names.push_back(parameter.name);
    for (const auto& [name, value] : study_.policy.initial) {
      const std::string path = "policy.initial." + name;
      if (!require_known(path, "policy.initial", "parameter of the policy", name, names)) continue;
      const auto found = std::ranges::find(parameters, name, &sim::PolicyParameter::name);
      require(path, value, !found->log_scale || value > 0.0, "> 0: its logarithm is searched");
    }
  }

  void check_model() {
    if (!reading_.good("simulator.parameters")) return;
    try {
      sim::make_policy_task(study_.simulator, {.model = study_.policy.model, .num_steps = 0});
    } catch (const InputError& error) {
      fail("policy.model", fmt::format("policy.model: {}", error.what()));
    }
  }

  void check_grid() {
    const PolicyGrid& grid = study_.policy.grid;
    const bool has_x = reading_.has("policy.grid.x"), has_y = reading_.has("policy.grid.y");
    if (!has_x && !has_y) return;
    if (!has_x || !has_y) {
      return fail("policy.grid",
                  fmt::format("policy.grid has no {}, must have x and y", has_x ? "y" : "x"));
    }
    check_axis("policy.grid.x", grid.x);
    check_axis("policy.grid.y", grid.y);
    if (grid.is_used() && grid.x.parameter == grid.y.parameter) {
      reading_.reject("policy.grid.y.parameter", quoted(grid.y.parameter),
                      "another than policy.grid.x has");
    }
  }

  void check_axis(const std::string& path, const PolicyGridAxis& axis) {
    for (const char* key : {".parameter", ".range", ".values", ".steps"}) {
      if (!reading_.good(path + key)) return;
    }
    if (!axis.is_used()) {
      return fail(path, path + " has no parameter = '...', must name a domain parameter");
    }
    const sim::Parameter* parameter =
        find_parameter(path + ".parameter", path + ".parameter", axis.parameter);
    if (!require_one_of(path, !axis.range.empty(), "range = [low, high]", !axis.values.empty(),
                        "values = [...]")) {
      return;
    }
    if (axis.values.size() == 1) {
      return reading_.reject(path + ".values", "a list of 1", "a list of 2 or more");
    }
    if (!axis.values.empty() && reading_.has(path + ".steps")) {
      return must_be_left_out({path + ".steps"}, "it means nothing to values");
    }
    if (parameter == nullptr) return;
    const std::string points = axis.values.empty() ? ".range" : ".values";
    const std::vector<double> all = axis.points();
    check_value(path + points, *parameter, all.front());
    check_value(path + points, *parameter, all.back());
  }
};

}  // namespace

void check_policy(const Study& study, const sim::SimulatorInfo* info, Reading& reading) {
  PolicyChecker(study, info, reading).check();
}

}  // namespace npdr::pipeline
