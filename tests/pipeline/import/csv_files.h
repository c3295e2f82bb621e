/// CSV files of a pendulum, for tests of their import.
#pragma once

#include <string>
#include <vector>

#include "core/error.h"
#include "pipeline/import/csv_import.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {

inline const std::string kCsv =
    "t [s],theta [rad],theta_dot [rad/s],torque [N m]\n"
    "0.0,0.1,1,5\n"
    "0.1,0.2,2,6\n"
    "0.2,0.3,3,7\n";

inline CsvOptions pendulum_options() {
  return {.channels = channels_of(sim::make_simulator({.name = "pendulum"})->info()),
          .dt = {},
          .source = ""};
}

class CsvFiles : public ::testing::Test {
 protected:
  Target imported(const std::string& text, const CsvOptions& options = pendulum_options()) const {
    return import_csv({folder_.file("a.csv", text)}, options).target;
  }
  std::vector<std::string> notes(const std::string& text, const CsvOptions& options) const {
    return import_csv({folder_.file("a.csv", text)}, options).notes;
  }

  std::string problem(const std::string& text,
                      const CsvOptions& options = pendulum_options()) const {
    return message_of<InputError>([&] { imported(text, options); }, &folder_);
  }

  TempFolder folder_;
};

inline std::string replaced(const std::string& text, const std::string& from,
                            const std::string& to) {
  std::string result = text;
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return result.replace(text.find(from), from.size(), to);
}

}  // namespace npdr::pipeline
