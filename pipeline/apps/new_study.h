/// The study that `npdr new NAME` writes for a simulator or recording of the user's.
#pragma once

#include <string>

namespace npdr::pipeline {

/// Subject of a new study; at most one simulator.
struct NewStudy {
  std::string name;
  std::string simulator;  ///< a built-in one
  std::string command;
  std::string worker;
  std::string library;      ///< a file
  std::string mjcf;         ///< a file
  std::string dataset;      ///< a file
  std::string recording;    ///< a file
  std::string observation;  ///< a file with x_o

  /// Whether anything but the name is given.
  bool is_specific() const;
};

/// The text of a study that fits: channels of the recording, parameters of the simulator with a
/// prior around their nominal values, those of a dataset with one over their ranges, an embedding
/// of all steps. What only the user can know is marked with `EDIT`. Throws InputError for files
/// that can't be read, more than one simulator, a recording or an observation without a simulator
/// that goes with it.
std::string new_study_text(const NewStudy& wanted);

}  // namespace npdr::pipeline
