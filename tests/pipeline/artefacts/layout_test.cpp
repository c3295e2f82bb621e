#include "pipeline/artefacts/layout.h"

#include <optional>

#include "core/constants.h"
#include "tests/document_tables.h"
#include "tests/pipeline/store/written_h5.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

struct Example {
  RowMatrix theta = RowMatrix::Constant(3, 2, 0.5);
  VectorF weights = VectorF::Ones(3);
  std::optional<double> density;
  std::vector<std::string> names = {"a", "b"};
  bool is_done = true;
};

void describe(Layout f, Example& e) {
  f.attribute("is_done", e.is_done, "1 or 0");
  f("theta", e.theta, {kRow, kParameter}, "parameters", kFinite);
  Layout group = f.group("group");
  group("weights", e.weights, {kRow}, "of the rows");
  group("density", e.density, {}, "may be missing");
  group("names", e.names, {{"D"}}, "of the columns");
}

class LayoutFile : public FolderTest {
 protected:
  Example reread(Example example) const {
    const h5::File file = h5::File::open(written_h5(
        folder_ / "a.h5", [&](h5::File& written) { describe(Layout::writer(written), example); }));
    Example found{{}, {}, {}, {}, false};
    describe(Layout::reader(file), found);
    return found;
  }
  std::string message_after(void (*change)(Example&)) const {
    Example example;
    change(example);
    return problem([&] { reread(example); });
  }
};

TEST_F(LayoutFile, ComesBackAsItWas) {
  Example example;
  const Example without = reread(example);
  EXPECT_EQ(without.theta, example.theta);
  EXPECT_EQ(without.weights, example.weights);
  EXPECT_EQ(without.names, example.names);
  EXPECT_TRUE(without.is_done);
  EXPECT_FALSE(without.density);
  example.density = 2.5;
  EXPECT_EQ(reread(example).density, 2.5);
}

TEST_F(LayoutFile, SizesOfTheSameNameMustBeEqualAndWhatMustBeFiniteIs) {
  EXPECT_TRUE(says(message_after([](Example& e) { e.weights = VectorF::Ones(4); }),
                   {"a.h5: dataset 'group/weights' has shape (4), must be (3)"}));
  EXPECT_TRUE(says(message_after([](Example& e) { e.names.pop_back(); }),
                   {"a.h5: dataset 'group/names' has shape (1), must be (2)"}));
  EXPECT_TRUE(says(message_after([](Example& e) { e.theta(1, 0) = kInfinity; }),
                   {"a.h5: dataset 'theta'", "must be finite"}));
}

TEST(LayoutTables, AreThoseOfTheDocument) {
  const std::filesystem::path document =
      std::filesystem::path(NPDR_SOURCE_DIR) / "docs" / "file-formats.md";
  const auto tables = document_tables(text_of(document), "layout");
  for (const std::string& name : layout_names()) {
    ASSERT_TRUE(tables.contains(name)) << name;
    EXPECT_EQ(tables.at(name), layout_table(name)) << "run scripts/docs";
  }
  EXPECT_EQ(tables.size(), layout_names().size());
}

}  // namespace
}  // namespace npdr::pipeline
