#include <hdf5.h>
#include <CLI/CLI.hpp>

#include <limits>

#include "core/shell_text.h"
#include "pipeline/apps/command_line.h"
#include "pipeline/apps/commands.h"
#include "pipeline/store/artefact.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

TEST(CommandLine, RangesAreExpandedOrRejected) {
  EXPECT_EQ(parse_ranges("0-3,7"), (std::vector<Index>{0, 1, 2, 3, 7}));
  EXPECT_EQ(parse_ranges("5"), (std::vector<Index>{5}));
  constexpr Index largest = std::numeric_limits<Index>::max();
  EXPECT_EQ(parse_ranges("9223372036854775807"), (std::vector<Index>{largest}));
  for (const char* text : {"", "a", "3-1", "-1", "1-", "1,,2", "1;2", "0-99999999999"}) {
    EXPECT_THROW(parse_ranges(text), InputError) << text;
  }
}

TEST(CommandLine, WordsNameTheSameStudyAgain) {
  StudyArguments arguments;
  arguments.file = "a.toml";
  arguments.overrides = {"x=1"};
  arguments.work = "elsewhere";
  arguments.methods = {"NPDR (MAF)"};
  arguments.seeds = {1, 2};
  EXPECT_EQ(shell_text(arguments.words()),
            "a.toml --set x=1 --work elsewhere --only 'NPDR (MAF)' --seeds 1,2");
}

TEST(CommandLine, EveryErrorHasItsExitStatus) {
  const auto status_of = [](auto error) {
    return guarded_main("test", [&]() -> ExitStatus { throw error; });
  };
  EXPECT_EQ(status_of(InputError("x")), 2);
  EXPECT_EQ(status_of(Error("x")), 1);
  EXPECT_EQ(status_of(FailedRolloutsError("x")), 3);
  EXPECT_EQ(status_of(Checkpointed("x")), 75);
  EXPECT_EQ(status_of(std::runtime_error("x")), 1);
  EXPECT_EQ(guarded_main("test", [] { return ExitStatus::done; }), 0);
}

TEST(List, HasALineForEachName) {
  for (const std::string name :
       {"methods", "embeddings", "estimators", "priors", "integrators", "metrics", "checks"}) {
    CLI::App app;
    int result = 0;
    add_command(app, {"list", "", &list_command}, result);
    testing::internal::CaptureStdout();
    app.parse("list " + name);
    EXPECT_NE(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(result, 0) << name;
  }
}

// An artefact with a group 'g' and a dataset 'x', which `change` may spoil.
template <class Change>
std::string inspected(const Change& change) {
  const TempFolder folder;
  const std::filesystem::path path = folder / "a.h5";
  ArtefactWriter writer(path, {"thing", 1, "make"}, {{{"stage", "make"}}, {}, {{"name", "s"}}, 1});
  writer.file().create_group("g").write("inner", Vector(Vector::Ones(2)));
  writer.file().write("x", Vector(Vector::Ones(3)));
  change(writer.file().id());
  writer.finish();

  CLI::App app;
  int result = 0;
  add_command(app, {"inspect", "", &inspect_command}, result);
  testing::internal::CaptureStdout();
  app.parse("inspect " + path.string());
  const std::string output = testing::internal::GetCapturedStdout();
  EXPECT_EQ(result, 0) << output;
  return output;
}

void add_attribute(hid_t object, const char* name, hid_t type, const void* value) {
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_GE(H5Awrite(attribute, type, value), 0);
  H5Aclose(attribute);
  H5Sclose(space);
}

TEST(Inspect, WhatIsOfOtherTypesIsNamedAsSuch) {
  const std::string output = inspected([](hid_t file) {
    const hid_t boolean = H5Tenum_create(H5T_NATIVE_INT8);
    const std::int8_t values[] = {0, 1};
    H5Tenum_insert(boolean, "FALSE", &values[0]);
    H5Tenum_insert(boolean, "TRUE", &values[1]);
    add_attribute(file, "flag", boolean, &values[1]);
    const hid_t x = H5Dopen2(file, "x", H5P_DEFAULT), space = H5Screate(H5S_NULL);
    hobj_ref_t reference = 0;
    EXPECT_GE(H5Rcreate(&reference, file, "x", H5R_OBJECT, -1), 0);
    add_attribute(x, "DIMENSION_LIST", H5T_STD_REF_OBJ, &reference);
    H5Dclose(x);
    H5Dclose(
        H5Dcreate2(file, "nothing", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
  });
  EXPECT_TRUE(has(output, {"@flag = (another type)\n", "@DIMENSION_LIST = (another type)\n",
                           "x (3)\n", "nothing (another type)\n"}));
}

TEST(Inspect, LinksToNowhereAreLeftOutAndGroupsThatHoldEachOtherShownOnce) {
  const std::string output = inspected([](hid_t file) {
    H5Lcreate_soft("/nowhere", file, "dangling", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("nowhere.h5", "/", file, "elsewhere", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/g", file, "g/a", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_hard(file, "/", file, "g/root", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_FALSE(has(output, "dangling"));
  EXPECT_FALSE(has(output, "elsewhere"));
  EXPECT_TRUE(has(output,
                  "    g/\n        a/ (shown already)\n        inner (2)\n"
                  "        root/ (shown already)\n    provenance/\n"));
}

}  // namespace
}  // namespace npdr::pipeline
