#include "pipeline/artefacts/recording.h"

#include <hdf5.h>

#include <cstdlib>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"
#include "core/text.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/store/h5.h"
#include "tests/device_recordings.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

Channels furuta_channels() { return channels_of(sim::make_simulator({.name = "furuta"})->info()); }

// Three rollouts that look like those of the furuta.
Target twin() {
  Target target;
  target.dt = 0.004;
  target.source = "made by hand";
  target.state_channels = furuta_channels().states;
  target.action_channels = furuta_channels().actions;
  for (const char* name : {"first", "second", "third"}) {
    target.rollouts.push_back({name, RowMatrix::Random(51, 4), RowMatrix::Random(50, 1)});
  }
  return target;
}

void expect_equal(const Target& a, const Target& b) {
  EXPECT_EQ(a.dt, b.dt);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.state_channels, b.state_channels);
  EXPECT_EQ(a.action_channels, b.action_channels);
  ASSERT_EQ(a.rollouts.size(), b.rollouts.size());
  for (std::size_t h = 0; h < a.rollouts.size(); ++h) {
    EXPECT_EQ(a.rollouts[h].name, b.rollouts[h].name);
    EXPECT_EQ(a.rollouts[h].states, b.rollouts[h].states);
    EXPECT_EQ(a.rollouts[h].actions, b.rollouts[h].actions);
  }
}

TEST(Recording, SurvivesARoundTrip) {
  const TempFolder folder;
  const Target target = twin();
  write_recording(target, folder / "a.h5");
  const Target read = read_recording(folder / "a.h5", furuta_channels());
  expect_equal(read, target);
  EXPECT_EQ(content_hash(read), content_hash(target));
  const std::vector<std::string> labels = {"rollout", "time", "channel"};
  EXPECT_EQ(h5::File::open(folder / "a.h5").dataset("states").dimension_labels(), labels);
}

TEST(Recording, MayHaveNoActionsNoNamesAndNoSource) {
  const TempFolder folder;
  h5::File file = h5::File::create(folder / "a.h5");
  file.set_attribute("dt", 0.1);
  for (const auto& [name, steps, channels] : {std::tuple{"states", 4, 1}, {"actions", 3, 0}}) {
    h5::Dataset dataset = file.create_dataset(name, h5::ElementType::f64, {2, steps, channels});
    dataset.set_attribute("labels", std::vector<std::string>(channels, "x"));
    dataset.set_attribute("units", std::vector<std::string>(channels, "m"));
    const std::vector<double> zeros(static_cast<std::size_t>(2 * steps * channels));
    dataset.write_rows<double>(0, 2, zeros);
  }
  file.close();
  const Target target = read_recording(folder / "a.h5");
  EXPECT_EQ(target.num_actions(), 0);
  EXPECT_EQ(target.num_steps(), 3);
  EXPECT_EQ(target.rollouts[1].name, "1");
  write_recording(target, folder / "b.h5");
  expect_equal(read_recording(folder / "b.h5"), target);
}

TEST(Recording, IsWrittenAsAWholeOrNotAtAll) {
  const TempFolder folder;
  Target target = twin();
  target.rollouts[1].states(3, 2) = kNaN;
  EXPECT_THROW(write_recording(target, folder / "a.h5"), InputError);
  EXPECT_EQ(folder.size(), 0);
}

// Edits the recording of the twin by HDF5's own means and reads it again.
class EditedRecording : public ::testing::Test {
 protected:
  template <class Edit>
  std::string reading(const Edit& edit) {
    write_recording(twin(), folder_ / "a.h5");
    const hid_t file = H5Fopen((folder_ / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    edit(file);
    H5Fclose(file);
    return reading_target();
  }

  std::string reading(const Target& target) {
    h5::File file = h5::File::create(folder_ / "a.h5");
    write_target(file, target);
    file.close();
    return reading_target();
  }

  TempFolder folder_;

 private:
  std::string reading_target() {
    return message_of<InputError>([&] { read_recording(folder_ / "a.h5", furuta_channels()); },
                                  &folder_);
  }
};

void write_double(hid_t file, const char* name, double value) {
  H5Adelete(file, name);
  const hid_t space = H5Screate(H5S_SCALAR);
  const hid_t attribute = H5Acreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value);
  H5Aclose(attribute);
}

void replace_dataset(hid_t file, const char* name, hid_t type, std::vector<hsize_t> extents) {
  H5Ldelete(file, name, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
  H5Dclose(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

void copy_texts(hid_t from, hid_t to, const char* name) {
  const hid_t attribute = H5Aopen(from, name, H5P_DEFAULT);
  const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
  std::vector<char> texts(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) *
                          H5Tget_size(type));
  H5Aread(attribute, type, texts.data());
  const hid_t copy = H5Acreate2(to, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(copy, type, texts.data());
  H5Dvlen_reclaim(type, space, H5P_DEFAULT, texts.data());
  for (const hid_t id : {copy, attribute}) H5Aclose(id);
  H5Tclose(type);
  H5Sclose(space);
}

// Writes a dataset anew as other programs do: contiguous, without checksums.
void write_plainly(hid_t file, const char* name) {
  const hid_t old = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(old);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(old, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Ldelete(file, name, H5P_DEFAULT);
  const hid_t plain = H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT,  //
                                 H5P_DEFAULT);
  H5Dwrite(plain, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  for (const char* texts : {"labels", "units"}) copy_texts(old, plain, texts);
  for (const hid_t id : {plain, old}) H5Dclose(id);
  H5Sclose(space);
}

// A recording of the Furuta pendulum by another program.
Target write_foreign(const std::filesystem::path& path) {
  const Target target = furuta_recording(2);
  write_recording(target, path);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (const char* name : {"states", "actions"}) write_plainly(file, name);
  H5Fclose(file);
  return target;
}

TEST(Recording, OfAnotherProgramIsRead) {
  const TempFolder folder;
  const Target target = write_foreign(folder / "a.h5");
  expect_equal(read_recording(folder / "a.h5", furuta_channels()), target);
}

TEST_F(EditedRecording, NamesMissingParts) {
  EXPECT_TRUE(says(reading([](hid_t file) { H5Ldelete(file, "states", H5P_DEFAULT); }),
                   {"a.h5: has no dataset 'states'", "it has actions, rollout"}));
  EXPECT_EQ(reading([](hid_t file) { H5Adelete(file, "dt"); }), "a.h5: attribute 'dt' is missing");
  EXPECT_EQ(reading([](hid_t file) { H5Adelete_by_name(file, "actions", "units", H5P_DEFAULT); }),
            "a.h5: dataset 'actions' must have the attributes 'labels' and 'units', one text per "
            "channel");
}

TEST_F(EditedRecording, ChecksTheTimeStep) {
  EXPECT_TRUE(says(reading([](hid_t file) { write_double(file, "dt", 0.0); }),
                   {"a.h5: dt = 0,", "must be a positive time [s]"}));
  EXPECT_TRUE(says(reading([](hid_t file) { write_double(file, "dt", 5e-324); }),
                   {"a.h5: dt = 4.94066e-324, must be a positive time [s], and not below 1e-307"}));
  EXPECT_TRUE(says(reading([](hid_t file) { write_double(file, "dt", kNaN); }),
                   {"a.h5: dt = nan", "must be a positive time [s]"}));
}

TEST_F(EditedRecording, ChecksRankShapeAndType) {
  const auto replaced = [&](const char* name, hid_t type, const std::vector<hsize_t>& extents) {
    return reading([&](hid_t file) { replace_dataset(file, name, type, extents); });
  };
  EXPECT_TRUE(says(replaced("states", H5T_IEEE_F64LE, {51, 4}),
                   {"a.h5: dataset 'states' has shape (51, 4)", "must be (any, any, any)"}));
  EXPECT_TRUE(says(replaced("actions", H5T_IEEE_F64LE, {3, 51, 1}),
                   {"a.h5: dataset 'actions' has shape (3, 51, 1)", "must be (3, 50, any)"}));
  EXPECT_TRUE(says(replaced("actions", H5T_C_S1, {3, 50, 1}),
                   {"a.h5: dataset 'actions' holds texts", "must hold 64-bit floats"}));
  EXPECT_TRUE(says(
      replaced("actions", H5T_IEEE_F64LE, {3, 50, 1000}),
      {"a.h5: dataset 'actions' claims shape (3, 50, 1000)", "nothing was ever written to it"}));
  EXPECT_TRUE(says(replaced("rollout", H5T_C_S1, {2}),
                   {"a.h5: dataset 'rollout' has shape (2)", "must be (3)"}));
}

// A few MB of compressed zeros would take minutes to read, and all memory.
TEST_F(EditedRecording, OfMoreNumbersThanAnybodyRecordsIsntRead) {
  EXPECT_EQ(reading([](hid_t file) {
              replace_dataset(file, "states", H5T_IEEE_F64LE, {3000, 500'001, 2});
              replace_dataset(file, "actions", H5T_IEEE_F64LE, {3000, 500'000, 1});
            }),
            "a.h5: dataset 'states' has shape (3000, 500001, 2), must hold at most 125000000 "
            "numbers; cut it, or record fewer steps or rollouts");
}

TEST_F(EditedRecording, TextsWithoutAnEndAreCutInTheMessage) {
  const std::string endless(100'000, 'a');
  Target target = twin();
  target.state_channels[1].label = endless;
  EXPECT_EQ(reading(target), "a.h5: dataset 'states': a label of 100000 bytes, '" +
                                 shortened(endless) + "', must be of at most 255");
  target = twin();
  target.action_channels[0].unit = endless;
  EXPECT_TRUE(says(reading(target), {"a.h5: dataset 'actions': a unit of 100000 bytes"}));
  target = twin();
  target.rollouts[2].name = endless;
  EXPECT_TRUE(says(reading(target), {"a.h5: a name of a rollout of 100000 bytes"}));
}

TEST_F(EditedRecording, ASourceWithoutAnEndIsCut) {
  Target target = twin();
  target.source = std::string(100'000, 'a');
  write_recording(target, folder_ / "a.h5");
  EXPECT_EQ(read_recording(folder_ / "a.h5").source, shortened(target.source));
}

TEST_F(EditedRecording, TextsThatNoReaderTakesArentWritten) {
  Target target = twin();
  target.state_channels[1].label = std::string(256, 'a');
  EXPECT_TRUE(
      says(message_of<InputError>([&] { write_recording(target, folder_ / "b.h5"); }, &folder_),
           {"b.h5: a label of 256 bytes", "must be of at most 255"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "b.h5"));
}

TEST_F(EditedRecording, ChecksTheChannelsAgainstTheSimulators) {
  Target target = twin();
  const std::string must = "must be theta [rad], alpha [rad], theta_dot [rad/s], alpha_dot [rad/s]";
  target.state_channels[1].label = "beta";
  EXPECT_TRUE(says(reading(target), {"a.h5: dataset 'states': channels are theta [rad], beta "
                                     "[rad], theta_dot [rad/s], alpha_dot [rad/s]",
                                     must}));
  target = twin();
  target.state_channels[1].unit = "deg";
  EXPECT_TRUE(says(reading(target), {"a.h5: dataset 'states': channels are theta [rad], alpha "
                                     "[deg], theta_dot [rad/s], alpha_dot [rad/s]",
                                     must, "convert its columns"}));
  target = twin();
  target.action_channels[0].label = "torque";
  EXPECT_TRUE(says(reading(target),
                   {"a.h5: dataset 'actions': channels are torque [V]", "must be voltage [V]"}));
}

// A recording may hold more than the simulator knows, in any order; two of a name are a riddle.
TEST_F(EditedRecording, PicksTheSimulatorsChannels) {
  const Target expected = twin();
  Target recorded = expected;
  std::swap(recorded.state_channels[0], recorded.state_channels[3]);
  recorded.state_channels.insert(recorded.state_channels.begin(), {"battery", "V"});
  for (Rollout& rollout : recorded.rollouts) {
    RowMatrix wide(rollout.states.rows(), 5);
    wide << RowMatrix::Constant(rollout.states.rows(), 1, 12.0), rollout.states.col(3),
        rollout.states.col(1), rollout.states.col(2), rollout.states.col(0);
    rollout.states = wide;
  }
  write_recording(recorded, folder_ / "wide.h5");
  const Target picked = read_recording(folder_ / "wide.h5",
                                       Channels{expected.state_channels, expected.action_channels});
  EXPECT_EQ(picked.state_channels, expected.state_channels);
  for (std::size_t h = 0; h < expected.rollouts.size(); ++h) {
    EXPECT_EQ(picked.rollouts[h].states, expected.rollouts[h].states);
  }
  recorded.state_channels[0].label = "theta";
  EXPECT_TRUE(
      says(reading(recorded), {"a.h5: dataset 'states': two columns have the label 'theta'"}));
}

TEST_F(EditedRecording, NamesTheNanItFinds) {
  Target target = twin();
  write_recording(target, folder_ / "a.h5");
  h5::File file = h5::File::create(folder_ / "b.h5");
  file.set_attribute("dt", 0.004);
  target.rollouts[1].states(7, 2) = kNaN;
  for (const auto& [name, values, channels] :
       {std::tuple{"states", &Rollout::states, &target.state_channels},
        {"actions", &Rollout::actions, &target.action_channels}}) {
    const RowMatrix& first = target.rollouts[0].*values;
    h5::Dataset dataset =
        file.create_dataset(name, h5::ElementType::f64, {3, first.rows(), first.cols()});
    std::vector<std::string> labels, units;
    for (const Channel& channel : *channels) {
      labels.push_back(channel.label);
      units.push_back(channel.unit);
    }
    dataset.set_attribute("labels", labels);
    dataset.set_attribute("units", units);
    for (Index h = 0; h < 3; ++h) {
      const RowMatrix& rollout = target.rollouts[static_cast<std::size_t>(h)].*values;
      dataset.write_rows<double>(h, 1, {rollout.data(), static_cast<std::size_t>(rollout.size())});
    }
  }
  file.close();
  EXPECT_TRUE(says(message_of<InputError>([&] { read_recording(folder_ / "b.h5"); }, &folder_),
                   {"b.h5: state of rollout 1 ('1') of channel 'theta_dot' is nan at step 7",
                    "must be finite", "repair or leave out this recording"}));
}

// Those of other programs have no checksums.
TEST(DamagedRecording, IsReadOrRefusedWhateverBytesAreFlipped) {
  const TempFolder folder;
  write_recording(twin(), folder / "twin.h5");
  write_foreign(folder / "foreign.h5");
  Stream stream({.seed = 1, .name = "damage"});
  for (const char* name : {"twin.h5", "foreign.h5"}) {
    const std::string original = text_of(folder / name);
    for (int trial = 0; trial < 200; ++trial) {
      std::string bytes = original;
      for (int flip = 0; flip < 20; ++flip) {
        bytes[stream.below(std::min<std::uint32_t>(std::uint32_t(bytes.size()), 8192))] ^= 0x5a;
      }
      folder.file("damaged.h5", bytes);
      // In a child: the library leaks memory on files that it gives up on.
      const Ending ending = try_in_child([&] {
        try {
          read_recording(folder / "damaged.h5").check("damaged.h5");
        } catch (const InputError&) {  // what it says is tested elsewhere
        } catch (...) {
          std::abort();
        }
      });
      EXPECT_EQ(ending, Ending::came_back) << trial;
    }
  }
}

TEST(ContentHash, DependsOnValuesChannelsAndTimeStepOnly) {
  const Target target = twin();
  const std::string hash = content_hash(target);
  Target other = target;
  other.source = "elsewhere";
  other.rollouts[0].name = "other";
  EXPECT_EQ(content_hash(other), hash);
  other = target;
  other.rollouts[2].actions(49, 0) = std::nextafter(other.rollouts[2].actions(49, 0), 9.0);
  EXPECT_NE(content_hash(other), hash);
  other = target;
  other.dt = 0.005;
  EXPECT_NE(content_hash(other), hash);
  other = target;
  other.state_channels[0].unit = "deg";
  EXPECT_NE(content_hash(other), hash);
  EXPECT_NE(content_hash(target.first(2)), hash);
}

}  // namespace
}  // namespace npdr::pipeline
