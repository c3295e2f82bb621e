// What checks say of methods: tests/golden/report.txt.
#include <map>

#include "core/text.h"
#include "tests/golden_file.h"
#include "tests/pipeline/findings/findings_fixture.h"

namespace npdr::pipeline {
namespace {

// What a report is made from, of a method without fault that statements spoil: "floor 0.04" is
// one, "prior.pole_mass={ uniform = [0, 1] }" another, of the study.
class SpoiledMethod : public Verdicts {
 public:
  SpoiledMethod(const std::string& study, const std::vector<std::string>& statements,
                const std::filesystem::path& folder) {
    std::vector<std::string> overrides;
    for (const std::string& statement : statements) {
      if (statement == "recording") {
        overrides.push_back("target.recording=" + (folder / "r.h5").string());
      } else if (statement == "refine") {
        overrides.insert(overrides.end(),
                         {"observation_noise.scale=0.1", "method.algorithm=refine"});
      } else if (is_of_study(statement)) {
        overrides.push_back(statement);
      }
    }
    plan_.study = parse_study(study, "s.toml", overrides);
    if (join(overrides).find("num_simulations") == std::string::npos) {
      plan_.study.methods.front().algorithm.num_simulations = 1'000'000;  // enough anywhere
    }
    for (const std::string& statement : statements) {
      if (is_of_study(statement)) continue;
      std::istringstream words(statement);
      std::string name;
      words >> name;
      std::vector<double> numbers;
      for (std::string word; words >> word;) numbers.push_back(std::stod(word));
      EXPECT_TRUE(spoil(name, numbers)) << "no statement: " << statement;
    }
  }

  // Words of the summary, and each check's.
  std::vector<std::string> said() const {
    const CheckSummary summary = check_summaries(data_).front();
    std::vector<std::string> lines = {words_of(summary), trust_of(summary)};
    for (const Finding& finding : findings_of(data_, kMethod)) {
      lines.push_back(finding.id + ": " + words_of_parts(finding));
    }
    for (const Finding& reason : summary.reasons) {
      if (reason.id != "unchecked") continue;
      lines.push_back(reason.where + ": " + words_of_parts(reason));
    }
    return lines;
  }

 private:
  void TestBody() override {}

  static std::string words_of_parts(const Finding& finding) {
    std::string words = name_of(finding.severity);
    for (const std::string& line : lines_of(finding)) words += "\n  " + line;
    return words;
  }

  static bool is_of_study(const std::string& statement) {
    const std::size_t sign = statement.find('=');
    return statement == "recording" || statement == "refine" ||
           (sign != std::string::npos && statement.find('.') < sign);
  }

  EvaluatedRun& last() { return data_.runs.back(); }
  inference::ImportanceCertificate& certificate() {
    if (!last().notes.certificate) {
      last().notes.certificate = {.power = 1.0,
                                  .wanted_power = 1.0,
                                  .ess = 1200.0,
                                  .wanted_ess = 1000.0,
                                  .efficiency = 0.1,
                                  .pareto_k = 0.5};
      leave_residuals({1.0, 1.0});
    }
    return *last().notes.certificate;
  }
  void widen(double excess) {
    data_.diagnoses.front().result.width = {Vector::Constant(2, excess), excess > 0.0};
  }
  void add_point(const std::string& name, double rmse) {
    data_.baseline.points.push_back({name, Vector(), {{"rmse", rmse}}});
  }
  // Samples of one parameter, or of both, around a mean.
  void move(const std::vector<double>& n) {
    const RowMatrix theta = samples_around(n.at(0), n.at(1));
    if (n.size() < 3) last().evaluation.theta = theta;
    if (n.size() >= 3) last().evaluation.theta.col(Index(n[2])) = theta.col(Index(n[2]));
  }
  void add_seed() {
    data_.runs.push_back(data_.runs.back());
    last().use.seed += 1;
    if (data_.seeds.size() < last().use.seed) data_.seeds.push_back(last().use.seed);
  }
  void add_method() {
    data_.methods.emplace_back("NPDR (MoG)");
    data_.runs.push_back(data_.runs.front());
    last().use.method = data_.methods.back();
  }
  void hold_out(const std::vector<double>& n) {
    PredictionScores& scores = last().evaluation.scores.held_out.emplace();
    scores.coverage = RowMatrix::Zero(std::ssize(kBandLevels), 2);
    scores.noisy_coverage = RowMatrix::Constant(std::ssize(kBandLevels), 2, 1.0);
    scores.noisy_coverage.row(8) << n.at(0) - 0.1, n.at(0) + 0.1;
    scores.noisy_crps = Vector::Constant(2, 0.11);
    scores.share_as_seldom_within = n.at(1);
    scores.num_compared = n.size() > 2 ? Index(n[2]) : 400;
  }
  // Powers that were tried, and the scores of two rollouts with each.
  void try_powers(const std::vector<double>& n) {
    PowerScores& scores = last().notes.powers;
    const auto count = static_cast<Index>(n.size() / 3);
    scores.power = Eigen::Map<const Vector>(n.data(), count);
    scores.crps = Eigen::Map<const RowMatrix>(n.data() + count, count, 2);
  }
  void leave_residuals(const std::vector<double>& n) {
    last().notes.residuals = {1000, Vector::Ones(2), Vector::Ones(2)};
    last().notes.residuals->memory(1) = n.at(0);
    last().notes.residuals->size(1) = n.at(1);
  }
  void make_ramp() {
    RowMatrix& states = data_.target.rollouts.front().states;
    for (Index t = 0; t < states.rows(); ++t) states.row(t).setConstant(0.1 * double(t));
  }
  void predict(double p_value) {
    PredictiveResult& found = *data_.diagnoses.front().result.predictive;
    found.check.p_value = p_value;
    found.check.summary_p_value = Vector::Constant(1, p_value);
    found.names = {"mean"};
    found.observed = Vector::Ones(1);
  }

  bool spoil(const std::string& name, const std::vector<double>& n) {
    const std::map<std::string, std::function<void()>> statements = {
        {"samples", [&] { move(n); }},
        {"prior_samples",
         [&] {
           last().evaluation.theta = sample_prior(inference::Prior(plan_.study.prior), 400, 1);
         }},
        {"num_samples",
         [&] { last().evaluation.theta.conservativeResize(Index(n.at(0)), Eigen::NoChange); }},
        {"rmse",
         [&] {
           last().evaluation.metrics["rmse"] =
               Vector::Constant(last().evaluation.theta.rows(), n.at(0));
         }},
        {"rmse_of_some", [&] { last().evaluation.metrics["rmse"].head(80).setConstant(n.at(0)); }},
        {"seed", [&] { add_seed(); }},
        {"other_method", [&] { add_method(); }},
        {"floor", [&] { add_point("floor", n.at(0)); }},
        {"misfit",
         [&] {
           RecordingMisfit& misfit = data_.baseline.misfit.emplace();
           misfit.times = n.at(0);
           misfit.limit = n.at(1);
           misfit.noise_is_given = n.at(1) < 4.0;
           misfit.num_rollouts = 1;
           misfit.left = misfit.of_noise = RowMatrix::Ones(10, 2);
           if (n.size() > 2) misfit.left.row(Index(n[2])).setConstant(10.0);
         }},
        {"late_rates",
         [&] {
           RecordingMisfit& misfit = *data_.baseline.misfit;
           misfit.cause = "rates were recorded 3 samples late";
           misfit.change = "rates 3 samples earlier";
           misfit.times_of_cause = n.at(0);
         }},
        {"truth", [&] { add_point("truth", n.at(0)); }},
        {"prior_rmse", [&] { data_.baseline.prior->metrics["rmse"].setConstant(n.at(0)); }},
        {"prior_crps",
         [&] {
           data_.baseline.prior->scores.held_out.emplace().noisy_crps =
               Vector::Constant(2, n.at(0));
         }},
        {"nominal_crps",
         [&] {
           add_point("nominal", 1.0);
           data_.baseline.points.back().scores = data_.baseline.prior->scores;
           data_.baseline.points.back().scores.held_out->noisy_crps.setConstant(n.at(0));
         }},
        {"rollouts",
         [&] {
           data_.target.rollouts.resize(std::size_t(n.at(0)), data_.target.rollouts.front());
           plan_.target.rollouts.resize(std::size_t(n.at(0)));
         }},
        {"moving", [&] { make_ramp(); }},
        {"held_out_rollout", [&] { data_.held_out.emplace(); }},
        {"covered", [&] { hold_out(n); }},
        {"r_hat",
         [&] {
           last().evaluation.sampler = {Vector::Constant(2, n.at(0)), Vector::Constant(2, 500), 1};
         }},
        {"effective",
         [&] {
           last().evaluation.sampler = {Vector(), Vector::Constant(1, n.at(0)), 1};
         }},
        {"pool",
         [&] {
           last().notes.pool = PoolNotes{{n.at(0), n.at(1)}, {n.at(2), n.at(3)}, 0.0};
         }},
        {"certificate", [&] { certificate(); }},
        {"power", [&] { certificate().power = certificate().wanted_power = n.at(0); }},
        {"power_reached", [&] { certificate().power = n.at(0); }},
        {"pareto_k", [&] { certificate().pareto_k = n.at(0); }},
        {"ess", [&] { certificate().ess = n.at(0); }},
        {"pool_ess", [&] { certificate().ess_of_all = n.at(0); }},
        {"log_evidence",
         [&] {
           certificate().log_evidence = n.at(0);
           certificate().log_evidence_error = 0.05;
         }},
        {"powers", [&] { try_powers(n); }},
        {"residuals", [&] { leave_residuals(n); }},
        {"no_residuals", [&] { last().notes.residuals.reset(); }},
        {"no_ood", [&] { data_.diagnoses.front().result.ood.reset(); }},
        {"gap", [&] { data_.diagnoses.front().result.training->generalization_gap = n.at(0); }},
        {"all_epochs",
         [&] {
           inference::TrainingCheck& check = *data_.diagnoses.front().result.training;
           check.is_converged = false;
           check.num_epochs = plan_.study.method(kMethod).training.max_epochs;
           check.recent_fall = n.at(0);
         }},
        {"ood", [&] { data_.diagnoses.front().result.ood->p_value = n.at(0); }},
        {"few_references",
         [&] {
           Diagnosis& diagnosis = data_.diagnoses.front().result;
           diagnosis.ood->num_reference = 20;
           diagnosis.predictive->check.overall.num_reference = 20;
         }},
        {"failed_predictions",
         [&] {
           data_.diagnoses.front().result.num_samples = 200;
           data_.diagnoses.front().result.predictive->num_failed = Index(n.at(0));
         }},
        {"sbc", [&] { data_.diagnoses.front().result.sbc.emplace().test.p_value = n.at(0); }},
        {"width", [&] { widen(n.at(0)); }},
        {"no_width", [&] { data_.diagnoses.front().result.width.reset(); }},
        {"predictive", [&] { predict(n.at(0)); }}};
    const auto found = statements.find(name);
    if (found == statements.end()) return false;
    found->second();
    return true;
  }
};

std::vector<std::string> statements_of(const GoldenCase& given) {
  std::vector<std::string> statements;
  for (const std::string& line : given.input) {
    for (std::size_t begin = 0, end = 0; begin < line.size(); begin = end + 2) {
      end = std::min(line.find("; ", begin), line.size());
      if (line != "as it is") statements.push_back(line.substr(begin, end - begin));
    }
  }
  return statements;
}

TEST(Golden, Report) {
  const TempFolder folder;
  folder.file("r.h5", "");
  std::vector<std::string> usual;
  expect_golden("report", [&](const GoldenCase& given) {
    const std::vector<std::string> statements = statements_of(given);
    if (usual.empty()) usual = SpoiledMethod(given.text, {}, folder.path()).said();
    std::vector<std::string> said;
    const std::string problems = message_of<InputError>(
        [&] { said = SpoiledMethod(given.text, statements, folder.path()).said(); });
    EXPECT_EQ(problems, "") << given.input.front();
    if (statements.empty()) return join(said, "\n");
    std::erase_if(said, [&](const std::string& line) {
      return std::ranges::find(usual, line) != usual.end();
    });
    return join(said, "\n");
  });
}

}  // namespace
}  // namespace npdr::pipeline
