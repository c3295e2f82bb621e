#include "pipeline/stages/judge.h"

#include "pipeline/stages/stage_files.h"

namespace npdr::pipeline {

Judge::Judge(const Plan& plan, const Node& node) : seen_(plan, read_target(plan, node)) {
  if (std::optional<Target> held_out = read_held_out(plan, node)) {
    held_out_.emplace(plan, std::move(*held_out));
  }
}

std::map<std::string, Vector> Judge::measure(const RowMatrix& complete) const {
  return measure(complete, seen_.simulate(complete));
}

std::map<std::string, Vector> Judge::measure(const RowMatrix& complete,
                                             const sim::Trajectories& seen) const {
  std::map<std::string, Vector> values = seen_.measure(seen);
  if (!held_out_) return values;
  for (const auto& [metric, column] : held_out_->measure(held_out_->simulate(complete))) {
    values[std::string(kHeldOutPrefix) + metric] = column;
  }
  return values;
}

std::map<std::string, double> Judge::measure_one(const Vector& complete) const {
  std::map<std::string, double> values;
  for (const auto& [metric, column] : measure(complete.transpose())) values[metric] = column(0);
  return values;
}

}  // namespace npdr::pipeline
