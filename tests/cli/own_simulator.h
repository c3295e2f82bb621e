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

  // The last evaluation's samples.
  RowMatrix samples(const std::string& study, Index round) const {
    const std::filesystem::path path =
        runs(study) / "npe/seed-1" / ("round-" + std::to_string(round));
    return h5::File::open(path / "evaluate.h5").read_matrix<double>("theta");
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

// The compiler line of the example's head, with the folder of the header of this build.
inline void compile_spring(const std::filesystem::path& folder) {
  const std::string command = "cd '" + folder.string() +
                              "' && cc -O2 -shared -fPIC -I'" NPDR_BINARY_DIR
                              "/include' spring.c -o spring.so -lm";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

}  // namespace npdr::pipeline
