/// Studies of the users' simulators, begun from the examples of experiments/external.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/store/h5.h"
#include "tests/cli/program.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {

class OwnSimulators : public CommandTest {
 protected:
  Outcome shell(const std::string& command) const {
    return run(folder_.path(), {"/bin/sh", "-c", command});
  }
  void copy_example(const std::string& name) const {
    std::filesystem::copy(std::filesystem::path(NPDR_SOURCE_DIR) / "experiments/external" / name,
                          folder_.path(), std::filesystem::copy_options::recursive);
  }
  std::filesystem::path runs(const std::string& study) const { return folder_ / "runs" / study; }

  // An artefact of the first round, below a work folder.
  h5::File first_round(const std::string& study, const std::string& name,
                       const std::string& work = "runs") const {
    return h5::File::open(folder_ / work / study / "npe/seed-1/round-1" / (name + ".h5"));
  }
  std::vector<float> trajectories(const std::string& study,
                                  const std::string& work = "runs") const {
    return first_round(study, "simulate", work).dataset("trajectories").read<float>();
  }

  // The words of a small run of an example.
  static std::vector<std::string> small(const std::string& file) {
    return {"run",   file,
            "--set", "method.num_simulations=400",
            "--set", "method.num_rounds=1",
            "--set", "method.training.max_epochs=60",
            "--set", "evaluate.num_samples=200"};
  }
};

/// Workers in Python, in place of the example's.
class PythonWorkers : public OwnSimulators {
 protected:
  void SetUp() override {
    if (python_.empty()) GTEST_SKIP() << "no Python with numpy";
    copy_example("spring");
  }

  std::string setting(const std::string& program) const {
    return "simulator.worker='" + python_ + " " + program + "'";
  }
  // The words that simulate a few rows.
  std::vector<std::string> words(const std::string& worker,
                                 const std::vector<std::string>& more = {}) const {
    return joined({"run", "worker.toml", "--until", "simulate", "--set",
                   "method.num_simulations=70", "--set", worker},
                  more);
  }

  const std::string python_ = python_with("numpy");
};

// The compiler line of the example's head, with the folder of the header of this build.
inline void compile_spring(const std::filesystem::path& folder) {
  const std::string command = "cd '" + folder.string() +
                              "' && cc -O2 -shared -fPIC -I'" NPDR_BINARY_DIR
                              "/include' spring.c -o spring.so -lm";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

}  // namespace npdr::pipeline
