#include "pipeline/artefacts/recording.h"

#include <hdf5.h>

#include <cstdlib>
#include <functional>
#include <tuple>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"
#include "core/text.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/store/h5.h"
#include "tests/device_recordings.h"
#include "tests/pipeline/store/written_h5.h"
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
  EXPECT_EQ(h5::File::open(folder / "a.h5")
                .dataset("states")
                .attribute<std::vector<std::string>>("DIMENSION_LABELS"),
            labels);
}

TEST(Recording, IsWrittenAsAWholeOrNotAtAll) {
  const TempFolder folder;
  Target target = twin();
  target.rollouts[1].states(3, 2) = kNaN;
  EXPECT_THROW(write_recording(target, folder / "a.h5"), InputError);
  EXPECT_EQ(folder.size(), 0);
}

// Edits the recording of the twin by HDF5's own means and reads it again.
class EditedRecording : public FolderTest {
 protected:
  template <class Edit>
  std::string reading(const Edit& edit) {
    write_recording(twin(), folder_ / "a.h5");
    const hid_t file = H5Fopen((folder_ / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    edit(file);
    H5Fclose(file);
    return reading_target();
  }
  // After `change` of the twin.
  std::string reading_changed(const std::function<void(Target&)>& change) {
    Target target = twin();
    change(target);
    written_h5(folder_ / "a.h5", [&](h5::File& file) { write_target(file, target); });
    return reading_target();
  }

 private:
  std::string reading_target() {
    return problem([&] { read_recording(folder_ / "a.h5", furuta_channels()); });
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

// A recording as other programs write it: contiguous, without checksums and names.
void write_foreign(const Target& target, const std::filesystem::path& path) {
  written_h5(path, [&](h5::File& file) {
    file.set_attribute("dt", target.dt);
    for (const auto& [name, values, channels] :
         {std::tuple{"states", &Rollout::states, &target.state_channels},
          {"actions", &Rollout::actions, &target.action_channels}}) {
      const RowMatrix& first = target.rollouts[0].*values;
      h5::Dataset dataset = file.create_dataset(name, h5::ElementType::f64,
                                                {target.num_rollouts(), first.rows(), first.cols()},
                                                {.chunked = false});
      std::vector<std::string> labels, units;
      for (const Channel& channel : *channels) {
        labels.push_back(channel.label);
        units.push_back(channel.unit);
      }
      dataset.set_attribute("labels", labels);
      dataset.set_attribute("units", units);
      for (Index h = 0; h < target.num_rollouts(); ++h) {
        const RowMatrix& rollout = target.rollouts[static_cast<std::size_t>(h)].*values;
        dataset.write_rows<double>(h, 1,
                                   {rollout.data(), static_cast<std::size_t>(rollout.size())});
      }
    }
  });
}

TEST(Recording, MayHaveNoActionsNoNamesAndNoSource) {
  const TempFolder folder;
  Target target{0.1, {{"x", "m"}}, {}, {}, ""};
  target.rollouts.assign(2, {"", RowMatrix::Zero(4, 1), RowMatrix(3, 0)});
  write_foreign(target, folder / "a.h5");
  const Target read = read_recording(folder / "a.h5");
  EXPECT_EQ(read.num_actions(), 0);
  EXPECT_EQ(read.num_steps(), 3);
  EXPECT_EQ(read.rollouts[1].name, "1");
  write_recording(read, folder / "b.h5");
  expect_equal(read_recording(folder / "b.h5"), read);
}

TEST(Recording, KeepsLabelsThatEndInBrackets) {
  const TempFolder folder;
  Target target{0.1, {{"q [0]", "rad"}, {"q [1]", "rad"}}, {}, {}, ""};
  target.rollouts = {{"0", RowMatrix::Zero(4, 2), RowMatrix(3, 0)}};
  write_recording(target, folder / "a.h5");
  expect_equal(read_recording(folder / "a.h5"), target);
}

TEST_F(EditedRecording, NamesMissingPartsAndWrongTimeSteps) {
  EXPECT_TRUE(says(reading([](hid_t file) { H5Ldelete(file, "states", H5P_DEFAULT); }),
                   {"a.h5: has no dataset 'states'", "it has actions, rollout"}));
  EXPECT_EQ(reading([](hid_t file) { H5Adelete(file, "dt"); }), "a.h5: attribute 'dt' is missing");
  EXPECT_EQ(reading([](hid_t file) { H5Adelete_by_name(file, "actions", "units", H5P_DEFAULT); }),
            "a.h5: dataset 'actions': attribute 'units' is missing");
  for (const auto& [dt, text] : {std::pair{0.0, "0"}, {5e-324, "4.94066e-324"}, {kNaN, "nan"}}) {
    EXPECT_TRUE(says(reading([&, dt = dt](hid_t file) { write_double(file, "dt", dt); }),
                     {std::string("a.h5: dt = ") + text + ", must be a positive time [s]"}));
  }
}

TEST_F(EditedRecording, ChecksRankShapeAndType) {
  const std::vector<std::tuple<const char*, hid_t, std::vector<hsize_t>, std::string>> cases = {
      {"states", H5T_IEEE_F64LE, {51, 4}, "has shape (51, 4), must be (any, any, any)"},
      {"actions", H5T_IEEE_F64LE, {3, 51, 1}, "has shape (3, 51, 1), must be (3, 50, any)"},
      {"actions", H5T_C_S1, {3, 50, 1}, "holds texts, must hold 64-bit floats"},
      {"actions", H5T_IEEE_F64LE, {3, 50, 1000}, "claims shape (3, 50, 1000)"},
      {"rollout", H5T_C_S1, {2}, "has shape (2), must be (3)"}};
  for (const auto& [name, type, extents, said] : cases) {
    EXPECT_TRUE(says(reading([&, name = name, type = type, extents = extents](hid_t file) {
                       replace_dataset(file, name, type, extents);
                     }),
                     {std::string("a.h5: dataset '") + name + "' " + said}));
  }
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
  EXPECT_EQ(reading_changed([&](Target& target) { target.state_channels[1].label = endless; }),
            "a.h5: dataset 'states': a label of 100000 bytes, '" + shortened(endless) +
                "', must be of at most 255");
  EXPECT_TRUE(says(reading_changed([&](Target& t) { t.action_channels[0].unit = endless; }),
                   {"a.h5: dataset 'actions': a unit of 100000 bytes"}));
  EXPECT_TRUE(says(reading_changed([&](Target& target) { target.rollouts[2].name = endless; }),
                   {"a.h5: a name of a rollout of 100000 bytes"}));
  Target target = twin();
  target.source = endless;
  write_recording(target, folder_ / "a.h5");
  EXPECT_EQ(read_recording(folder_ / "a.h5").source, shortened(endless));
  target.state_channels[1].label = std::string(256, 'a');
  EXPECT_TRUE(says(problem([&] { write_recording(target, folder_ / "b.h5"); }),
                   {"b.h5: a label of 256 bytes", "must be of at most 255"}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "b.h5"));
}

TEST_F(EditedRecording, ChecksTheChannelsAgainstTheSimulators) {
  EXPECT_TRUE(
      says(reading_changed([](Target& target) { target.state_channels[1].label = "beta"; }),
           {"a.h5: dataset 'states': channels are theta [rad], beta [rad], theta_dot [rad/s]",
            "must be theta [rad], alpha [rad], theta_dot [rad/s], alpha_dot [rad/s]"}));
  EXPECT_TRUE(says(reading_changed([](Target& target) { target.state_channels[1].unit = "deg"; }),
                   {"a.h5: dataset 'states': channels are theta [rad], alpha [deg]",
                    "alpha_dot [rad/s]; rename, reorder or convert its columns"}));
  EXPECT_TRUE(
      says(reading_changed([](Target& target) { target.action_channels[0].label = "torque"; }),
           {"a.h5: dataset 'actions': channels are torque [V]", "must be voltage [V]"}));
}

// A recording may hold more than the simulator knows, in any order; two of a name are a riddle.
TEST_F(EditedRecording, PicksTheSimulatorsChannels) {
  const auto widen = [](Target& target) {
    std::swap(target.state_channels[0], target.state_channels[3]);
    target.state_channels.insert(target.state_channels.begin(), {"battery", "V"});
    for (Rollout& rollout : target.rollouts) {
      const RowMatrix narrow = rollout.states;
      rollout.states.resize(narrow.rows(), 5);
      rollout.states << RowMatrix::Constant(narrow.rows(), 1, 12.0), narrow.col(3), narrow.col(1),
          narrow.col(2), narrow.col(0);
    }
  };
  const Target expected = twin();
  Target recorded = expected;
  widen(recorded);
  write_recording(recorded, folder_ / "wide.h5");
  expect_equal(read_recording(folder_ / "wide.h5", furuta_channels()), expected);
  EXPECT_TRUE(says(reading_changed([&](Target& target) {
                     widen(target);
                     target.state_channels[0].label = "theta";
                   }),
                   {"a.h5: dataset 'states': two columns have the label 'theta'"}));
}

TEST_F(EditedRecording, OfAnotherProgramIsReadAndItsNanNamed) {
  Target target = twin();
  write_foreign(target, folder_ / "b.h5");
  const Target read = read_recording(folder_ / "b.h5", furuta_channels());
  EXPECT_EQ(content_hash(read), content_hash(target));
  EXPECT_EQ(read.rollouts[1].name, "1");
  target.rollouts[1].states(7, 2) = kNaN;
  write_foreign(target, folder_ / "b.h5");
  EXPECT_TRUE(says(problem([&] { read_recording(folder_ / "b.h5"); }),
                   {"b.h5: state of rollout 1 ('1') of channel 'theta_dot' is nan at step 7",
                    "must be finite", "repair or leave out this recording"}));
}

// Those of other programs have no checksums.
TEST(DamagedRecording, IsReadOrRefusedWhateverBytesAreFlipped) {
  const TempFolder folder;
  write_recording(twin(), folder / "twin.h5");
  write_foreign(twin(), folder / "foreign.h5");
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
  const auto changes = [&](const std::function<void(Target&)>& change) {
    Target other = target;
    change(other);
    return content_hash(other) != content_hash(target);
  };
  EXPECT_FALSE(changes([](Target& other) { other.source = other.rollouts[0].name = "elsewhere"; }));
  EXPECT_TRUE(changes([](Target& other) {
    double& action = other.rollouts[2].actions(49, 0);
    action = std::nextafter(action, 9.0);
  }));
  EXPECT_TRUE(changes([](Target& other) { other.dt = 0.005; }));
  EXPECT_TRUE(changes([](Target& other) { other.state_channels[0].unit = "deg"; }));
  EXPECT_TRUE(changes([](Target& other) { other = other.first(2); }));
}

}  // namespace
}  // namespace npdr::pipeline
