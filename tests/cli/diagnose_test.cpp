#include <fmt/format.h>

#include <cstdlib>

#include "tests/cli/study_run.h"

namespace npdr::pipeline {
namespace {

// Checks of one method over two rounds, and of one whose posterior has to be sampled.
std::string diagnosed_study() {
  return pendulum_study("checked")
      .with("target", {"truth = { pole_mass = 1.2 }"})
      .with("observation_noise", {"scale = 0.2"})
      .method("NPE", {"algorithm = \"npe_c\"", "num_rounds = 2", "num_simulations = 150",
                      "embedding = { kind = \"all_steps\", downsample = 50 }", kSmallMixture,
                      "training = { max_epochs = 20 }"})
      .method("NRE", {"algorithm = \"nre_b\"", "num_simulations = 150",
                      "embedding = { kind = \"all_steps\", downsample = 50 }",
                      "density_estimator = { kind = \"resnet\", hidden_features = 10, "
                      "num_hidden_layers = 1 }",
                      "training = { max_epochs = 20 }",
                      "sampler = { kind = \"importance\", num_candidates = 500 }"})
      .with("evaluate", {"num_samples = 30"})
      .with("diagnose", {"num_simulations = 60", "num_samples = 50"});
}

class Diagnose : public StudyRun {
 protected:
  static void SetUpTestSuite() {
    const OmpThreads one(1);
    run_study("checked.toml", diagnosed_study());
  }
};

// 20 epochs end no training: with --strict the exit status says so.
TEST_F(Diagnose, ARunEndsWithVerdictsAndWhatToDo) {
  EXPECT_TRUE(has(run_output_, {"\nNPE: ", " of 8 checks FAIL: ", "\nNRE: ", "\n  Don't trust its ",
                                "\n    Set max_epochs = 40 in [method.training]\n"}));
  const Outcome again = npdr(0, {"run", "checked.toml"});
  EXPECT_EQ(again.out, run_output_);
  EXPECT_TRUE(has(again.err, "checked: nothing to do, all is up to date"));
  npdr(4, {"run", "checked.toml", "--strict"});
  npdr(0, {"run", "checked.toml", "--strict", "--set", "diagnose.checks=[]", "--set",
           "study.name=unchecked"});
}

TEST_F(Diagnose, SamplesOfWhatFailedCarryAWarning) {
  const auto warning = [](const std::vector<std::string>& words) {
    return npdr(0, joined({"sample", "checked.toml", "--method", "NPE", "-n", "2"}, words)).err;
  };
  const std::vector<std::string> expected = {
      "warning: NPE: ", " of 8 checks FAIL: ", "runs/checked/report.html"};
  EXPECT_TRUE(says(warning({}), expected));
  EXPECT_TRUE(says(warning({"--seeds", "1"}), expected));
  EXPECT_TRUE(says(warning({"--set", "evaluate.num_samples=31"}),
                   {"note: no report says whether the checks of NPE pass; make it: npdr run "
                    "checked.toml --set evaluate.num_samples=31"}));
  EXPECT_TRUE(
      says(npdr(0, {"export", "checked.toml", "--only", "NPE", "-o", "out.nc"}).err, expected));
}

TEST_F(Diagnose, TheReportHasATableAndFigures) {
  const std::string table = text_of(file("runs/checked/tables/diagnostics.md"));
  EXPECT_TRUE(has(
      table, {"| Check ", "| NPE ", "| NRE ", "| SBC ranks, round 1 ", "| TARP coverage, round 1 ",
              "| Local C2ST at x_o, round 1 ", "| Posterior predictive ",
              "| x_o among simulations ", "| Training ", "with a probability of at most 0.01"}));
  const std::string report = text_of(file("runs/checked/report.html"));
  EXPECT_TRUE(has(report, "Can the posteriors be trusted?"));
  for (const char* name : {"sbc_ranks.svg", "coverage.svg", "sbc_ranks.png", "coverage.png"}) {
    EXPECT_TRUE(std::filesystem::exists(file("runs/checked/figures") / name)) << name;
  }
}

// Of a shell command in the study's folder.
int status_of(const std::filesystem::path& folder, const std::string& command) {
  return std::system(("cd '" + folder.string() + "' && " + command).c_str());
}

// What programs make of the report that machines may lack; apart, since ctest doesn't show what is
// skipped within a suite.
class Rendered : public Diagnose {
 protected:
  static bool is_installed(const std::string& program) {
    return std::system(("command -v " + program + " > /dev/null").c_str()) == 0;
  }
  static void SetUpTestSuite() {
    if (is_installed("pdflatex") || is_installed("chromium")) Diagnose::SetUpTestSuite();
  }
};

TEST_F(Rendered, LatexCompilesTheTables) {
  if (!is_installed("pdflatex")) GTEST_SKIP() << "no pdflatex";
  std::ofstream all(file("all.tex"));
  all << "\\documentclass{article}\n\\usepackage{booktabs,graphicx}\n\\begin{document}\n";
  for (const std::string& table : files_ending(file("runs/checked/tables"), ".tex")) {
    all << "\\input{runs/checked/tables/" << table << "}\\clearpage\n";
  }
  all << "\\end{document}\n";
  all.close();
  EXPECT_EQ(
      status_of(file("."), "pdflatex -interaction=nonstopmode -halt-on-error all.tex > all.out"), 0)
      << text_of(file("all.out"));
}

// What chromium makes of a page, which may load nothing from elsewhere; `options` are its.
std::string dom_of(const std::filesystem::path& page, const std::string& options = "") {
  const std::filesystem::path folder = page.parent_path();
  EXPECT_EQ(
      status_of(folder,
                "timeout 60 chromium --headless --no-sandbox --disable-gpu "
                "--host-resolver-rules='MAP * ~NOTFOUND' --enable-logging=stderr --dump-dom " +
                    options + " 'file://" + page.string() + "' > dom.html 2> messages.txt"),
      0);
  const std::string messages = text_of(folder / "messages.txt");
  EXPECT_FALSE(has(messages, "CONSOLE"));
  return text_of(folder / "dom.html");
}

TEST_F(Rendered, ABrowserRunsTheReportsScript) {
  if (!is_installed("chromium")) GTEST_SKIP() << "no chromium";
  const std::string dom = dom_of(file("runs/checked/report.html"));
  EXPECT_TRUE(
      has(dom, {"<button type=\"button\" title=\"Sort\">Check</button>", "<div class=\"tools\">"}));
}

TEST_F(Rendered, AllOfTheReportCanBeReadAndReachedByKeys) {
  if (!is_installed("chromium")) GTEST_SKIP() << "no chromium";
  std::string page = text_of(file("runs/checked/report.html"));
  // The page's policy would let no other script run.
  const std::size_t policy = page.find("<meta http-equiv=\"Content-Security-Policy\"");
  ASSERT_NE(policy, std::string::npos);
  page.erase(policy, page.find('\n', policy) - policy);
  page.insert(
      page.find("</body>"),
      "<script>" + text_of(NPDR_SOURCE_DIR "/tests/cli/report_accessibility.js") + "</script>");
  std::ofstream(file("page.html")) << page;
  for (const char* width : {"1200", "500"}) {
    for (const auto& [number, theme] : {std::pair("0", "dark"), std::pair("1", "light")}) {
      const std::string dom =
          dom_of(file("page.html"), std::string("--blink-settings=preferredColorScheme=") + number +
                                        " --window-size=" + width + ",900");
      const std::string expected = std::string("<pre id=\"findings\">theme: ") + theme + "</pre>";
      EXPECT_TRUE(has(dom, expected))
          << width << " px\n"
          << dom.substr(std::min(dom.size(), dom.find("<pre id=\"findings\">")));
    }
  }
}

TEST_F(Diagnose, NothingIsMadeTwiceAndStatusShowsVerdicts) {
  // Target, baseline, report; (2 x 3 + 3) of training, 2 evaluations, 2 of calibration, 2
  // diagnoses, less what the methods share: the first proposal and simulation.
  const Outcome status = npdr({"status", "checked.toml"});
  EXPECT_TRUE(has(status.out, {"16 artefacts: 16 up to date",
                               "\nNPE: ", "\nreport: runs/checked/report.html\n"}));
  const Outcome changed = npdr({"status", "checked.toml", "--set", "diagnose.alpha=0.05"});
  EXPECT_FALSE(has(changed.out, "\nNPE: ")) << "verdicts of another report";
  EXPECT_TRUE(has(npdr({"run", "checked.toml", "--dry-run", "--set", "diagnose.alpha=0.05"}).out,
                  "# report"));
}

TEST_F(Diagnose, SameBitsForAnyThreadCountAndShardSize) {
  const OmpThreads three(3);
  npdr(0, {"run", "checked.toml", "--work", "three", "--only", "NPE", "--set",
           "simulate.shard_size=17"});
  EXPECT_EQ(content_digest(file("three/checked/npe/seed-1/diagnose.h5")),
            content_digest(file("runs/checked/npe/seed-1/diagnose.h5")));
}

TEST_F(Diagnose, RowsOfTrainingAndCalibrationAreVerifiedBitForBit) {
  for (const auto& [rows, num_rows] : {std::pair("round-1", "150"), {"calibration", "60"}}) {
    for (const char* name : {"propose", "simulate"}) {
      EXPECT_TRUE(
          has(npdr(0, {"verify", fmt::format("runs/checked/npe/seed-1/{}/{}.h5", rows, name)}).out,
              fmt::format("10 of {} rows recomputed, 0 differ", num_rows)));
    }
  }
}

TEST_F(Diagnose, CompareSaysHowFarApartSamplesAre) {
  const std::string posterior = "runs/checked/npe/seed-1/round-2/infer.h5";
  std::ofstream(file("one.csv")) << npdr({"sample", posterior, "-n", "400"}).out;
  std::ofstream(file("two.csv")) << npdr({"sample", posterior, "-n", "500", "--seed", "2"}).out;
  const Outcome same = npdr(0, {"compare", "one.csv", "two.csv", "--json"});
  const auto json = nlohmann::json::parse(same.out);
  EXPECT_EQ(json["num_rows"], 400);
  // Five standard errors of 800 rows; false-alarm rate 6e-7, and 1 % of the p-value; fixed seeds.
  EXPECT_NEAR(json["c2st"]["accuracy"].get<double>(), 0.5, 5.0 * 0.018);
  EXPECT_GT(json["mmd"]["p_value"].get<double>(), 0.01);
  EXPECT_EQ(json["parameters"][0]["name"], "pole_mass");
  const Outcome other =
      npdr(0, {"compare", "one.csv", "runs/checked/npe/seed-1/round-1/propose.h5"});
  EXPECT_TRUE(has(other.out, {"150 rows of each, picked at random", "pole_length [m]"}));
  EXPECT_FALSE(has(other.out, "warning"));
  const std::string text = text_of(file("two.csv"));
  std::ofstream(file("twice.csv")) << text << text.substr(text.find('\n') + 1);
  const Outcome repeats = npdr({"compare", "twice.csv", "one.csv", "-n", "1000"});
  EXPECT_FALSE(has(repeats.out, "of the second are copies"));
  EXPECT_TRUE(has(repeats.out, "rows picked of the first are copies of others"));
}

TEST_F(Diagnose, CompareRejectsWhatCantBeCompared) {
  const std::string evaluation = "runs/checked/npe/seed-1/round-2/evaluate.h5";
  const auto error = [&](const std::vector<std::string>& words) {
    return npdr(2, joined({"compare"}, words)).err;
  };
  std::ofstream(file("few.csv")) << "pole_mass [kg],pole_length [m]\n1,1\n1,2\n";
  EXPECT_TRUE(says(error({"few.csv", evaluation}),
                   {"npdr compare: few.csv: 2 rows", "must be at least 10"}));
  std::ofstream(file("nan.csv")) << "pole_mass [kg],pole_length [m]\n1,nan\n";
  EXPECT_TRUE(has(error({evaluation, "nan.csv"}), "nan.csv:2: column 2 'pole_length' = 'nan'"));
  std::ofstream(file("other.csv")) << "mass [kg],pole_length [m]\n1,1\n";
  EXPECT_TRUE(has(error({evaluation, "other.csv"}), "has no column 'pole_mass'"));
  EXPECT_TRUE(has(error({evaluation, evaluation, "--dataset", "bands"}), "bands"));
  EXPECT_TRUE(has(error({evaluation, "missing.h5"}), "missing.h5"));
}

}  // namespace
}  // namespace npdr::pipeline
