#include <sys/wait.h>
#include <unistd.h>

#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "pipeline/artefacts/asked_rows_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/work_folder.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

Identity posterior_of(const std::string& what) {
  Identity identity;
  identity.key_document = {{"what", what}};
  return identity;
}

class AskedRowsFile : public FolderTest {
 protected:
  AskedRowsFile() { kAskedRowsSchema.write(file().path, posterior_, asked_); }

  ArtefactFile file() const { return {folder_ / asked_.file_name(), posterior_.key()}; }

  void write(const AskedShard& shard, const SimulatedRows& rows) const {
    kSimulatedRowsSchema.write(folder_ / shard.file_name, identity_of(asked_, shard, posterior_),
                               rows);
  }

  Identity posterior_ = posterior_of("a posterior");
  AskedRows asked_{.first = 40, .shard_size = 4, .theta = RowMatrix::Random(10, 3)};
};

TEST_F(AskedRowsFile, IsReadAsItIsWritten) {
  const std::optional<AskedRows> read = kAskedRowsSchema.read_if_there(file());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->first, 40);
  EXPECT_EQ(read->shard_size, 4);
  EXPECT_EQ(read->theta, asked_.theta);
  EXPECT_EQ(read->file_name(), asked_.file_name());
  EXPECT_TRUE(read->file_name().starts_with("asked-40-50-")) << read->file_name();
  EXPECT_FALSE(kAskedRowsSchema.read_if_there({folder_ / "asked-0-1-2.h5", posterior_.key()}));
}

TEST_F(AskedRowsFile, OfAnotherRefinementOrDamagedIsAnError) {
  const auto message = [&](const ArtefactFile& artefact) {
    return problem([&] { kAskedRowsSchema.read_if_there(artefact); });
  };
  EXPECT_TRUE(has(message({file().path, posterior_of("another").key()}), "key"));
  AskedRows odd = asked_;
  odd.shard_size = 0;
  kAskedRowsSchema.write(folder_ / odd.file_name(), posterior_, odd);
  EXPECT_NE(odd.file_name(), asked_.file_name());
  EXPECT_TRUE(says(message({folder_ / odd.file_name(), posterior_.key()}),
                   {odd.file_name(), "in shards of 0", "must be from 0 to", "remove this file"}));
  write_text_file(file().path, "not HDF5");
  EXPECT_TRUE(has(message(file()), asked_.file_name()));
}

TEST_F(AskedRowsFile, ThoseThatBeginFirstComeFirst) {
  const std::set<std::string> names = {"asked-100-200-a.h5", "asked-20-30-b.h5", "asked-x-2-c.h5",
                                       "asked-1-2.h5",       "rows-1-2-3.h5",    "other"};
  EXPECT_EQ(names_of_asked_rows(names),
            (std::vector<std::string>{"asked-20-30-b.h5", "asked-100-200-a.h5"}));
}

TEST_F(AskedRowsFile, ShardsCoverAllRowsAndKnowTheirTheta) {
  const std::vector<AskedShard> shards = shards_of(asked_, posterior_.key());
  ASSERT_EQ(shards.size(), 3u);
  EXPECT_EQ(shards[0].rows.begin, 0);
  EXPECT_EQ(shards[2].rows.begin, 8);
  EXPECT_EQ(shards[2].rows.end, 10);
  EXPECT_TRUE(shards[2].file_name.starts_with("rows-48-50-")) << shards[2].file_name;
  EXPECT_EQ(end_of_rows(shards[2].file_name), 50);
  EXPECT_FALSE(end_of_rows(asked_.file_name()));
  EXPECT_EQ(identity_of(asked_, shards[1], posterior_).key(), shards[1].key);

  AskedRows other = asked_;
  other.theta(5, 0) = std::nextafter(other.theta(5, 0), 2.0);
  const std::vector<AskedShard> others = shards_of(other, posterior_.key());
  EXPECT_EQ(others[0].file_name, shards[0].file_name);
  EXPECT_NE(others[1].file_name, shards[1].file_name);
  EXPECT_EQ(others[2].file_name, shards[2].file_name);
  EXPECT_NE(shards_of(asked_, "another")[0].file_name, shards[0].file_name);
}

TEST_F(AskedRowsFile, LikelihoodsAreReadAsTheyAreWritten) {
  const std::vector<AskedShard> shards = shards_of(asked_, posterior_.key());
  EXPECT_FALSE(read_simulated_rows(folder_.path(), shards[2]));
  write(shards[2], {.log_likelihood = Vector{{-1.5, -HUGE_VAL}}, .num_failed = 1});
  const std::optional<SimulatedRows> read = read_simulated_rows(folder_.path(), shards[2]);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->log_likelihood(0), -1.5);
  EXPECT_EQ(read->log_likelihood(1), -HUGE_VAL);
  EXPECT_EQ(read->num_failed, 1);
  EXPECT_EQ(read->rollouts.num_rows, 0);
}

TEST_F(AskedRowsFile, RolloutsAreThereWhereTheyAreAskedFor) {
  AskedRows wanted = asked_;
  wanted.rollouts = true;
  EXPECT_NE(shards_of(wanted, posterior_.key())[2].key, shards_of(asked_, posterior_.key())[2].key);
  const AskedShard shard = shards_of(asked_, posterior_.key())[2];
  SimulatedRows rows{.log_likelihood = Vector::Zero(2)};
  rows.rollouts.resize(2, 3, 4, 5);
  for (std::size_t i = 0; i < rows.rollouts.values.size(); ++i) {
    rows.rollouts.values[i] = static_cast<float>(i);
  }
  rows.rollouts.status[1] = sim::RolloutStatus::timed_out;
  write(shard, rows);
  const std::optional<SimulatedRows> read = read_simulated_rows(folder_.path(), shard);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->rollouts.values, rows.rollouts.values);
  EXPECT_EQ(read->rollouts.status, rows.rollouts.status);
  EXPECT_EQ(read->rollouts.num_rows, 2);
  EXPECT_EQ(read->rollouts.row_size(), 60);
}

TEST_F(AskedRowsFile, LikelihoodsThatAreNotOfTheShardAreAnError) {
  const std::vector<AskedShard> shards = shards_of(asked_, posterior_.key());
  const auto message = [&](const AskedShard& shard) {
    return problem([&] { read_simulated_rows(folder_.path(), shard); });
  };
  write(shards[2], {.log_likelihood = Vector::Zero(3), .num_failed = 0});
  EXPECT_TRUE(says(message(shards[2]), {shards[2].file_name, "3 likelihoods", "must be of 2 rows",
                                        "remove this file"}));
  write(shards[2], {.log_likelihood = Vector::Zero(2), .num_failed = 3});
  EXPECT_TRUE(has(message(shards[2]), "3 failed rows"));
  write(shards[0], {.log_likelihood = Vector::Zero(4), .num_failed = 0});
  std::filesystem::copy(folder_ / shards[0].file_name, folder_ / shards[1].file_name);
  EXPECT_TRUE(has(message(shards[1]), shards[1].file_name));
}

TEST(WorkFolder, LinksAreRelativeAndCanBeRenewed) {
  const TempFolder folder;
  folder.file("first", "1");
  folder.file("second", "2");
  const auto link = folder.path() / "readable" / "link";
  make_link(folder / "first", link);
  EXPECT_EQ(text_of(link), "1");
  EXPECT_TRUE(std::filesystem::read_symlink(link).is_relative());
  make_link(folder / "second", link);
  EXPECT_EQ(text_of(link), "2");
}

TEST(WorkFolder, WhatAKilledProcessLeftBesideALinkIsRemoved) {
  const TempFolder folder;
  folder.file("first", "1");
  const pid_t dead = ::fork();
  if (dead == 0) ::_exit(0);
  ::waitpid(dead, nullptr, 0);
  const auto readable = folder.path() / "readable";
  std::filesystem::create_directory(readable);
  const auto stale =
      readable / (".link." + process_space() + "." + std::to_string(dead) + ".0.tmp");
  std::filesystem::create_symlink("../first", stale);
  make_link(folder / "first", readable / "link");
  EXPECT_FALSE(std::filesystem::is_symlink(stale));
}

TEST(WorkFolder, ALinkThatCannotBeMadeIsAnError) {
  const TempFolder folder;
  folder.file("readable", "a file, not a folder");
  EXPECT_THROW(make_link(folder / "first", folder.path() / "readable" / "link"), Error);
}

}  // namespace
}  // namespace npdr::pipeline
