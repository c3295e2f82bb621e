#include "pipeline/store/netcdf.h"

#include <hdf5_hl.h>
#include <utility>

#include "core/error.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

class Netcdf : public FolderTest {
 protected:
  Netcdf() : file_(h5::File::create(folder_ / "a.nc")), group_(file_.create_group("posterior")) {
    group_.dimension("chain", std::vector<Index>{1, 2});
    group_.dimension("name", std::vector<std::string>{"a", "\u00e4", ""});
  }

  h5::File reopened() {
    file_.close();
    return h5::File::open(folder_ / "a.nc");
  }

  h5::File file_;
  NetcdfGroup group_;
};

TEST_F(Netcdf, EveryAxisHasTheScaleOfItsName) {
  group_.variable("x", {"chain", "name"}, std::vector<double>{1, 2, 3, 4, 5, 6}, "kg");
  group_.variable("dt", {}, std::vector<double>{0.5});
  const h5::File file = reopened();
  const h5::Group group = file.group("posterior");
  const h5::Dataset x = group.dataset("x");
  EXPECT_EQ(x.read<double>(), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(x.attribute<std::string>("units"), "kg");
  for (const auto& [axis, name] : {std::pair{0u, "chain"}, {1u, "name"}}) {
    const h5::Dataset scale = group.dataset(name);
    EXPECT_GT(H5DSis_scale(scale.id()), 0);
    EXPECT_GT(H5DSis_attached(x.id(), scale.id(), axis), 0);
  }
  EXPECT_EQ(H5DSis_attached(x.id(), group.dataset("name").id(), 0), 0);
  EXPECT_EQ(group.dataset("name").read_texts(), (std::vector<std::string>{"a", "\u00e4", ""}));
  EXPECT_EQ(group.read_scalar<double>("dt"), 0.5);
}

TEST_F(Netcdf, NamesThatItForbidsAreReplaced) {
  group_.variable("chain", {"chain"}, std::vector<float>{1, 2});
  group_.variable("a/b ", {"chain"}, std::vector<float>{1, 2});
  const h5::File file = reopened();
  EXPECT_EQ(file.group("posterior").names(),
            (std::vector<std::string>{"a_b", "chain", "chain_", "name"}));
}

TEST_F(Netcdf, ADimensionMustBeThere) {
  EXPECT_TRUE(
      says(message_of<ShapeError>([&] { group_.variable("x", {"draw"}, std::vector<double>{1}); }),
           {"x: there is no dimension draw"}));
}

}  // namespace
}  // namespace npdr::pipeline
