// HDF5 files that others made: recordings, datasets, samples, what commands write in place of x.
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/artefacts/recording.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/h5_model.h"

namespace npdr::pipeline {
namespace {

enum Reader : char { recording, own_channels, dataset, features, kNumReaders };

H5Value texts(const std::vector<std::string>& values) {
  return {h5::ElementType::text, {std::ssize(values)}, {}, values};
}

H5Model recording_model() {
  H5Model model;
  model.add("states", {h5::ElementType::f64, {2, 4, 2}, {0.1, 0.2, -0.3}, {}});
  model.add("states@labels", texts({"theta", "theta_dot"}));
  model.add("states@units", texts({"rad", "rad/s"}));
  model.add("actions", {h5::ElementType::f32, {2, 3, 1}, {0.5}, {}});
  model.add("actions@labels", texts({"u"}));
  model.add("actions@units", texts({"N m"}));
  model.add("rollout", texts({"a", "b"}));
  model.add("@dt", {h5::ElementType::f64, {1}, {0.01}, {}});
  model.add("@source", texts({"lab"}));
  return model;
}

H5Model dataset_model() {
  H5Model model;
  model.add("theta", {h5::ElementType::f64, {3, 2}, {0.1, 0.2}, {}});
  model.add("theta@labels", texts({"a", "b"}));
  model.add("x", {h5::ElementType::f64, {3, 2}, {0.1, 0.2}, {}});
  model.add("x@labels", texts({"f", "g"}));
  model.add("x@units", texts({"1", "m"}));
  return model;
}

}  // namespace

std::vector<std::string> recording_seeds() {
  std::vector<std::string> seeds;
  for (char reader = 0; reader < kNumReaders; ++reader) seeds.emplace_back(1, reader);
  return seeds;
}

void fuzz_recording(std::string_view input, const std::filesystem::path& folder) {
  InputBytes bytes(input);
  const std::size_t reader = bytes.below(kNumReaders);
  const bool is_recording = reader == recording || reader == own_channels;
  H5Model model = is_recording ? recording_model() : dataset_model();
  model.edit(bytes);
  const std::filesystem::path path = folder / "a.h5";
  model.write(path);
  if (reader == recording) content_hash(read_rollouts(h5::File::open(path)));
  if (reader == own_channels) {
    read_rollouts(h5::File::open(path), Channels{{{"theta", "rad"}}, {{"u", "N m"}}});
  }
  if (reader == dataset) {
    const DatasetFile file(path, {"a"});
    const Index row = file.num_rows() - 1;
    file.theta({&row, 1});
    file.x({&row, 1});
  }
  if (reader == features) {
    read_sample_set(path, "theta", 2);
    read_features(path, FileFormat::hdf5, 3, {});
  }
}

}  // namespace npdr::pipeline
