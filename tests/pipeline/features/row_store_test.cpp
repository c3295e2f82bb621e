#include "pipeline/features/row_store.h"

#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

// Few rows stay in memory, many go to a file: both must give back what was written.
TEST(RowStore, GivesBackWhatWasWrittenInMemoryAndInAFile) {
  const TempFolder folder;
  for (const Index width : {Index{4}, Index{2} << 20}) {  // 320 B, and 640 MiB that aren't filled
    RowStore store(80, width, folder.path());
    std::vector<float> row(static_cast<std::size_t>(width));
    for (const Index i : {Index{79}, Index{0}, Index{41}}) {
      row.front() = static_cast<float>(i);
      row.back() = static_cast<float>(-i);
      store.write(i, row);
    }
    for (const Index i : {Index{0}, Index{41}, Index{79}}) {
      store.read(i, row);
      EXPECT_EQ(row.front(), static_cast<float>(i));
      EXPECT_EQ(row.back(), static_cast<float>(-i));
    }
  }
  EXPECT_EQ(folder.size(), 0);  // the file has no name
}

}  // namespace
}  // namespace npdr::pipeline
