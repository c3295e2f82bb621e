/// The rules find what breaks them, on source trees made for the purpose.
#include "tests/architecture/include_rules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "core/error.h"
#include "core/text.h"
#include "tests/temp_folder.h"

namespace npdr::architecture {
namespace {

namespace fs = std::filesystem;
using Messages = std::vector<std::string>;

// A source tree that keeps to the rules until a test adds a file.
class IncludeRules : public testing::Test {
 protected:
  IncludeRules() {
    for (const std::string folder : {"core", "sim", "inference", "analysis", "pipeline"}) {
      add(folder + "/a.h", "#pragma once\n#include <vector>\n");
    }
    add("tests/sim/helper.h", "");
    add("bench/helper.h", "");
  }

  void add(const std::string& file, const std::string& text) const {
    fs::create_directories((root() / file).parent_path());
    std::ofstream(root() / file) << text;
  }
  const fs::path& root() const { return folder_.path(); }

 private:
  TempFolder folder_;
};

// "process, store" of "config".
std::string layers_before(const std::string& layer) {
  const Messages all = known_layers();
  return join({all.begin(), std::ranges::find(all, layer)});
}

// Lines that a file of the tree includes, and what is said of them.
struct Case {
  std::string file, text;
  Messages broken;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      // what flows with the data
      {"sim/b.cpp", "#include \"sim/a.h\"\n#include \"core/a.h\"\n#include <cmath>\n", {}},
      {"pipeline/store/b.h", "#include <hdf5.h>\n#include \"core/a.h\"\n", {}},
      {"pipeline/config/b.cpp", "#include <toml++/toml.h>\n#include \"inference/a.h\"\n", {}},
      {"pipeline/plan/b.h", "#include \"pipeline/store/s.h\"\n#include \"sim/a.h\"\n", {}},
      {"pipeline/apps/programs/b.cpp", "#include \"pipeline/store/s.h\"\n", {}},
      // comments, and our own headers that are named after a library
      {"core/b.cpp", "// #include \"sim/a.h\"\n/* #include \"sim/a.h\" */\n", {}},
      {"pipeline/plan/b.cpp", "#include \"pipeline/store/H5.h\"\n", {}},
      // core includes nobody, siblings not each other, nobody below the pipeline
      {"core/b.h",
       "\n  #  include \"sim/a.h\"  // why not\n",
       {"core/b.h:2: includes sim/a.h; core may include only: core"}},
      {"sim/b.cpp",
       "#include \"inference/a.h\"\n",
       {"sim/b.cpp:1: includes inference/a.h; sim may include only: core, sim"}},
      {"inference/deeper/b.cpp",
       "#include <analysis/a.h>\n",
       {"inference/deeper/b.cpp:1: includes analysis/a.h; inference may include only: core, "
        "inference"}},
      {"analysis/b.cpp",
       "#include \"../sim/a.h\"\n#include \"pipeline/a.h\"\n",
       {"analysis/b.cpp:1: includes sim/a.h; analysis may include only: core, analysis",
        "analysis/b.cpp:2: includes pipeline/a.h; analysis may include only: core, analysis"}},
      // nobody includes tests or benchmarks
      {"sim/b.cpp",
       "#include \"tests/sim/helper.h\"\n",
       {"sim/b.cpp:1: includes tests/sim/helper.h; sim may include only: core, sim"}},
      {"pipeline/b.cpp",
       "#include \"bench/helper.h\"\n",
       {"pipeline/b.cpp:1: includes bench/helper.h; pipeline may include only: core, sim, "
        "inference, analysis, pipeline"}},
      // layers of the pipeline
      {"pipeline/plan/b.cpp",
       "#include \"pipeline/run/r.h\"\n",
       {"pipeline/plan/b.cpp:1: includes pipeline/run/r.h; plan may include only layers before "
        "it: " +
        layers_before("plan")}},
      {"pipeline/report/b.h",
       "#include \"pipeline/stages/s.h\"\n",
       {"pipeline/report/b.h:1: includes pipeline/stages/s.h; report may include only layers "
        "before it: " +
        layers_before("report")}},
      {"pipeline/stages/b.h",
       "#include \"pipeline/report/r.h\"\n",
       {"pipeline/stages/b.h:1: includes pipeline/report/r.h; stages may include only layers "
        "before it: " +
        layers_before("stages")}},
      {"pipeline/store/b.cpp",
       "#include \"inference/a.h\"\n",
       {"pipeline/store/b.cpp:1: includes inference/a.h; store may include only core and layers "
        "before it"}},
      {"pipeline/attic/b.cpp",
       "#include \"core/a.h\"\n",
       {"pipeline/attic/b.cpp:1: includes core/a.h; pipeline has no layer attic"}},
      // libraries stay in one layer
      {"pipeline/storehouse/b.cpp",
       "#include <hdf5/serial/H5public.h>\n#include <hdf5_hl.h>\n#include <H5Cpp.h>\n",
       {"pipeline/storehouse/b.cpp:1: includes hdf5/serial/H5public.h; only pipeline/store may "
        "include HDF5",
        "pipeline/storehouse/b.cpp:2: includes hdf5_hl.h; only pipeline/store may include HDF5",
        "pipeline/storehouse/b.cpp:3: includes H5Cpp.h; only pipeline/store may include HDF5"}},
      {"pipeline/store/b.cpp",
       "#include \"toml++/toml.h\"\n#include \"toml.hpp\"\n",
       {"pipeline/store/b.cpp:1: includes toml++/toml.h; only pipeline/config may include TOML",
        "pipeline/store/b.cpp:2: includes toml.hpp; only pipeline/config may include TOML"}},
  };
  return all;
}

TEST_F(IncludeRules, SayWhatBreaksThem) {
  for (const char* header : {"store/s.h", "store/H5.h", "run/r.h", "stages/s.h", "report/r.h"}) {
    add(std::string("pipeline/") + header, "");
  }
  for (const Case& c : cases()) {
    add(c.file, c.text);
    EXPECT_EQ(broken_rules(root()), c.broken) << c.file << ":\n" << c.text;
    fs::remove(root() / c.file);
  }
}

TEST_F(IncludeRules, TheOwnHeaderComesFirst) {
  add("sim/a.cpp", "#include <vector>\n#include \"sim/a.h\"\n");
  add("analysis/a.cpp", "int nothing_included;\n");
  add("core/a.cpp", "#include \"core/a.h\"\n#include <vector>\n");
  add("core/without_header.cpp", "#include <vector>\n");
  EXPECT_EQ(late_own_headers(root()), (Messages{"sim/a.cpp: include sim/a.h first",
                                                "analysis/a.cpp: include analysis/a.h first"}));
}

TEST_F(IncludeRules, AMissingFolderIsAnError) {
  fs::remove_all(root() / "sim");
  EXPECT_THROW(broken_rules(root()), Error);
}

}  // namespace
}  // namespace npdr::architecture
