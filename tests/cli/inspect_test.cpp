#include "pipeline/store/h5.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

TEST(Inspect, ShowsOtherProgramsFilesAndGroupsThatAreAlikeOnce) {
  const TempFolder folder;
  h5::File other = h5::File::create(folder.path() / "other.h5");
  for (const auto& [name, length] : {std::pair("a", 2), {"b", 2}, {"c", 2}, {"d", 3}}) {
    other.create_group(name).write("weight", Vector(Vector::Zero(length)));
  }
  other.write("between", Vector(Vector::Zero(2)));
  other.close();
  const Outcome outcome = run(folder.path(), {"npdr", "inspect", "other.h5"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "other.h5: neither an artefact, a recording (states) nor a dataset (theta, x)\n"
            "  a/\n      weight (2)\n  b/ (laid out like the one before)\n  between (2)\n"
            "  c/\n      weight (2)\n  d/\n      weight (3)\n");
  EXPECT_TRUE(says(run(folder.path(), {"npdr", "inspect", "--study", "other.h5"}).err,
                   {"npdr inspect: other.h5: isn't an artefact"}));
}

}  // namespace
}  // namespace npdr::pipeline
