/// The rules find what breaks them, on source trees made for the purpose.
#include "tests/architecture/include_rules.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "core/error.h"

namespace npdr::architecture {
namespace {

namespace fs = std::filesystem;
using Messages = std::vector<std::string>;

// A source tree that keeps to the rules until a test adds a file.
class IncludeRules : public testing::Test {
 protected:
  IncludeRules() {
    std::string name = (fs::temp_directory_path() / "npdr_tree_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Error("no scratch folder: " + name);
    root_ = name;
    for (const std::string folder : {"core", "sim", "inference", "analysis", "pipeline"}) {
      add(folder + "/a.h", "#pragma once\n#include <vector>\n");
    }
    add("tests/sim/helper.h", "");
    add("bench/helper.h", "");
  }
  IncludeRules(const IncludeRules&) = delete;
  IncludeRules& operator=(const IncludeRules&) = delete;
  ~IncludeRules() override {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }

  void add(const std::string& file, const std::string& text) const {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }

  fs::path root_;
};

TEST_F(IncludeRules, AcceptTheDataFlow) {
  add("sim/b.cpp", "#include \"sim/b.h\"\n#include \"core/a.h\"\n#include <cmath>\n");
  add("pipeline/store/b.h", "#include <hdf5.h>\n#include \"core/a.h\"\n");
  add("pipeline/config/b.cpp", "#include <toml++/toml.h>\n#include \"inference/a.h\"\n");
  add("pipeline/plan/b.h", "#include \"pipeline/store/b.h\"\n#include \"sim/a.h\"\n");
  add("pipeline/apps/programs/b.cpp", "#include \"pipeline/plan/b.h\"\n");
  EXPECT_EQ(broken_rules(root_), Messages());
}

TEST_F(IncludeRules, CoreIncludesNobody) {
  add("core/b.h", "\n  #  include \"sim/a.h\"  // why not\n");
  EXPECT_EQ(broken_rules(root_),
            Messages{"core/b.h:2: includes sim/a.h; core may include only: core"});
}

TEST_F(IncludeRules, SiblingsDontIncludeEachOther) {
  add("sim/b.cpp", "#include \"inference/a.h\"\n");
  add("inference/deeper/b.cpp", "#include <analysis/a.h>\n");
  add("analysis/b.cpp", "#include \"../sim/a.h\"\n");
  EXPECT_EQ(
      broken_rules(root_),
      (Messages{
          "sim/b.cpp:1: includes inference/a.h; sim may include only: core, sim",
          "inference/deeper/b.cpp:1: includes analysis/a.h; inference may include only: core, "
          "inference",
          "analysis/b.cpp:1: includes sim/a.h; analysis may include only: core, analysis"}));
}

TEST_F(IncludeRules, NobodyBelowIncludesThePipeline) {
  add("analysis/b.h", "#include \"pipeline/a.h\"\n");
  EXPECT_EQ(broken_rules(root_),
            Messages{"analysis/b.h:1: includes pipeline/a.h; analysis may include only: core, "
                     "analysis"});
}

TEST_F(IncludeRules, NoArrowOfThePipelineRunsUpwards) {
  add("pipeline/run/b.h", "");
  add("pipeline/plan/b.cpp", "#include \"pipeline/run/b.h\"\n");
  const Messages broken = broken_rules(root_);
  ASSERT_EQ(broken.size(), 1u);
  EXPECT_TRUE(
      broken[0].starts_with("pipeline/plan/b.cpp:1: includes pipeline/run/b.h; plan may "
                            "include only layers before it: process, store, config"))
      << broken[0];
}

TEST_F(IncludeRules, ReportsAndStagesKnowNothingOfEachOther) {
  add("pipeline/stages/b.h", "");
  add("pipeline/report/b.h", "#include \"pipeline/stages/b.h\"\n");
  add("pipeline/stages/c.h", "#include \"pipeline/report/b.h\"\n");
  EXPECT_EQ(broken_rules(root_).size(), 2u);
}

TEST_F(IncludeRules, FilesAndProcessesKnowNothingOfTheScience) {
  add("pipeline/store/b.cpp", "#include \"inference/a.h\"\n");
  EXPECT_EQ(broken_rules(root_),
            Messages{"pipeline/store/b.cpp:1: includes inference/a.h; store may include only core "
                     "and layers before it"});
}

TEST_F(IncludeRules, AFolderThatIsNoLayerIsFound) {
  add("pipeline/attic/b.cpp", "#include \"core/a.h\"\n");
  EXPECT_EQ(broken_rules(root_),
            Messages{"pipeline/attic/b.cpp:1: includes core/a.h; pipeline has no layer attic"});
}

TEST_F(IncludeRules, NobodyIncludesTestsOrBenchmarks) {
  add("sim/b.cpp", "#include \"tests/sim/helper.h\"\n");
  add("pipeline/b.cpp", "#include \"bench/helper.h\"\n");
  EXPECT_EQ(broken_rules(root_),
            (Messages{"sim/b.cpp:1: includes tests/sim/helper.h; sim may include only: core, sim",
                      "pipeline/b.cpp:1: includes bench/helper.h; pipeline may include only: core, "
                      "sim, inference, analysis, pipeline"}));
}

TEST_F(IncludeRules, OnlyTheStoreIncludesHdf5) {
  for (const std::string header : {"hdf5.h", "H5Cpp.h", "hdf5_hl.h", "hdf5/serial/H5public.h"}) {
    add("pipeline/storehouse/b.cpp", "#include <" + header + ">\n");
    EXPECT_EQ(broken_rules(root_), Messages{"pipeline/storehouse/b.cpp:1: includes " + header +
                                            "; only pipeline/store may include HDF5"});
  }
}

TEST_F(IncludeRules, OnlyConfigIncludesToml) {
  for (const std::string header : {"toml++/toml.h", "toml.hpp"}) {
    add("pipeline/store/b.cpp", "#include \"" + header + "\"\n");
    EXPECT_EQ(broken_rules(root_), Messages{"pipeline/store/b.cpp:1: includes " + header +
                                            "; only pipeline/config may include TOML"});
  }
}

TEST_F(IncludeRules, OurOwnHeadersMayBeNamedAfterALibrary) {
  add("pipeline/store/h5.h", "");
  add("pipeline/store/H5.h", "");
  add("pipeline/plan/b.cpp",
      "#include \"pipeline/store/h5.h\"\n#include \"pipeline/store/H5.h\"\n");
  EXPECT_EQ(broken_rules(root_), Messages());
}

TEST_F(IncludeRules, CommentsIncludeNothing) {
  add("core/b.cpp", "// #include \"sim/a.h\"\n/* #include \"sim/a.h\" */\n");
  EXPECT_EQ(broken_rules(root_), Messages());
}

TEST_F(IncludeRules, TheOwnHeaderComesFirst) {
  add("sim/a.cpp", "#include <vector>\n#include \"sim/a.h\"\n");
  add("analysis/a.cpp", "int nothing_included;\n");
  add("core/a.cpp", "#include \"core/a.h\"\n#include <vector>\n");
  add("core/without_header.cpp", "#include <vector>\n");
  EXPECT_EQ(late_own_headers(root_), (Messages{"sim/a.cpp: include sim/a.h first",
                                               "analysis/a.cpp: include analysis/a.h first"}));
}

TEST_F(IncludeRules, AMissingFolderIsAnError) {
  fs::remove_all(root_ / "sim");
  EXPECT_THROW(broken_rules(root_), Error);
}

}  // namespace
}  // namespace npdr::architecture
