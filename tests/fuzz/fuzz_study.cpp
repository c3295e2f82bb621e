// Study files: as TOML, and as settings of keys that there are.
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include "pipeline/config/study_json.h"
#include "pipeline/config/study_keys.h"
#include "pipeline/config/study_reader.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/input_bytes.h"

namespace npdr::pipeline {
namespace {

constexpr std::array kValues = {"0",     "-1",     "1",   "1000000000000", "9223372036854775807",
                                "1e308", "5e-324", "nan", "inf",           "-inf",
                                "''",    "[]",     "{}",  "[1, 2]",        "true",
                                "'a'",   "[[]]",   "0.5", "2024-01-01",    "{ uniform = [0, 1] }"};

// "key=value": a value of the list, or text.
std::string setting(InputBytes& bytes, const Fields& keys) {
  const std::string key = bytes.one_of(keys).path;
  const std::size_t value = bytes.below(2 * kValues.size());
  return key + "=" + (value < kValues.size() ? kValues[value] : bytes.text());
}

// Files that studies name must be there.
void make_files(const std::string& study, const std::filesystem::path& folder) {
  static const std::regex name("[\" ]([A-Za-z0-9_]+\\.(h5|csv|xml|so|py|sh))(?=[\" ])");
  for (std::sregex_iterator found(study.begin(), study.end(), name), end; found != end; ++found) {
    std::ofstream(folder / (*found)[1].str(), std::ios::app);
  }
}

std::string as_settings(const std::string& of_study) { return "\xff" + of_study; }

const std::vector<std::string>& studies() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> texts = {study_template("small")};
    for (const char* folder : {"experiments", "experiments/external"}) {
      for (const auto& entry :
           std::filesystem::directory_iterator(std::string(NPDR_SOURCE_DIR "/") + folder)) {
        if (entry.path().extension() != ".toml") continue;
        std::ifstream stream(entry.path(), std::ios::binary);
        texts.emplace_back(std::istreambuf_iterator<char>(stream),
                           std::istreambuf_iterator<char>());
      }
    }
    std::ranges::sort(texts);  // folders have no order
    return texts;
  }();
  return all;
}

}  // namespace

std::vector<std::string> study_seeds() {
  std::vector<std::string> seeds = studies();
  for (std::size_t i = 0; i < studies().size(); ++i) {
    seeds.push_back(as_settings(std::string(1, static_cast<char>(i))));
  }
  return seeds;
}

void fuzz_study(std::string_view input, const std::filesystem::path& folder) {
  static const Fields keys = study_keys();
  static std::filesystem::path made_in;
  if (made_in != folder) {
    for (const std::string& study : studies()) make_files(study, folder);
    made_in = folder;
  }
  std::string text(input);
  std::vector<std::string> settings;
  if (input.starts_with('\xff')) {
    InputBytes bytes(input.substr(1));
    text = bytes.one_of(studies());
    while (!bytes.empty()) settings.push_back(setting(bytes, keys));
  }
  const Study study = parse_study(text, folder / "s.toml", settings);
  to_json(study).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace npdr::pipeline
