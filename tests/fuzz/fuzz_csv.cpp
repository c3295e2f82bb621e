// CSV: recordings of labs, datasets, samples, and what commands write in place of x.
#include <fstream>

#include "core/error.h"
#include "pipeline/artefacts/dataset_file.h"
#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/outside_file.h"
#include "pipeline/import/csv_import.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/input_bytes.h"

namespace npdr::pipeline {
namespace {

// Inputs begin with the reader, and its options.
enum Reader : char { recording, dataset, samples, command_output, observation, kNumReaders };

CsvOptions options_of(InputBytes& bytes) {
  CsvOptions options;
  options.channels = {{{"theta", ""}, {"theta_dot", ""}}, {{"u", ""}}};
  const std::size_t flags = bytes.byte();
  if ((flags & 1) != 0) options.dt = 0.01;
  if ((flags & 2) != 0) options.format = {';', true};
  if ((flags & 4) != 0) options.unwrap = {"theta"};
  if ((flags & 8) != 0) options.resample = 0.02;
  if ((flags & 16) != 0) {
    options.differentiate = 5;
  }
  if ((flags & 32) != 0) options.length = static_cast<Index>(bytes.byte());
  if ((flags & 64) != 0) options.scales = {{"theta", 1e-3}, {"u", 1e300}};
  options.check_rates = (flags & 128) != 0;
  return options;
}

std::string seed(Reader reader, char options, const std::string& text) {
  return std::string{static_cast<char>(reader), options} + text;
}

std::string swing(char delimiter, bool has_rates) {
  const std::string mark(1, delimiter);
  std::string text = "time [s]" + mark + "theta [rad]" + mark +
                     (has_rates ? "theta_dot [rad/s]" + mark : "") + "u [N m]\n";
  for (int t = 0; t < 12; ++t) {
    text += "0.0" + std::to_string(t + 10) + mark + "0." + std::to_string(t) + mark +
            (has_rates ? "100" + mark : "") + "0\n";
  }
  return text;
}

}  // namespace

std::vector<std::string> csv_seeds() {
  return {seed(recording, 0, swing(',', true)),
          seed(recording, 4, "\xEF\xBB\xBF" + swing(',', true)),
          seed(recording, 16, swing(',', false)),
          seed(dataset, 0, "a,b\n1,2\n3,4\n"),
          seed(samples, 0, "a [kg],b\n0.5,1e3\n-1,2\n"),
          seed(command_output, 0, "1,2\n3,nan\n"),
          seed(command_output, 1, "b,\"a\"\r\n1,2\r\n3,4\r\n"),
          seed(observation, 0, "a,b\n0.5,1\n")};
}

void fuzz_csv(std::string_view input, const std::filesystem::path& folder) {
  InputBytes bytes(input);
  const std::size_t reader = bytes.below(kNumReaders);
  const CsvOptions options = options_of(bytes);
  const std::filesystem::path path = folder / "a.csv";
  std::ofstream(path, std::ios::binary) << bytes.rest();
  if (reader == recording) import_csv({path}, options).target.check(path);
  if (reader == dataset) import_dataset(path, path, folder / "d.h5", options.format);
  if (reader == samples)
    in_order_of(read_sample_set(path, "samples", 100), read_sample_set(path, "samples", 100));
  if (reader == observation) read_observation(path, {});
  if (reader == command_output) {
    read_features(path, FileFormat::csv, 2,
                  {.features = {{"a", "1"}, {"b", "1"}},
                   .names_from = options.dt ? NamesFrom::observation : NamesFrom::nobody,
                   .needs_line_ends = true});
  }
}

}  // namespace npdr::pipeline
