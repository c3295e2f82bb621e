/// Errors of the library. Libraries throw; only the outermost main prints and picks the exit
/// status.
///
/// A message says where, what was found, what is allowed and what to do:
///   furuta.toml:14:9: training.learning_rate = -0.1, must be > 0
///   simulations.h5: schema 2, this build reads 3; rerun stage 'simulate'
#pragma once

#include <stdexcept>
#include <string>

namespace npdr {

/// Exit statuses of every executable of the project.
enum class ExitStatus : int {
  done = 0,
  failed = 1,
  invalid_input = 2,    ///< usage, study file, recording or artefact that can't be accepted
  failed_rollouts = 3,  ///< finished, with failed rollouts beyond the study's limit
  failed_checks = 4,    ///< finished, with posteriors that failed a check (npdr run --strict)
  checkpointed = 75,    ///< stopped on request with its state saved: run it again
};

/// Base of all errors of the project: something failed that the input is not to blame for.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, ExitStatus status = ExitStatus::failed);
  ExitStatus status() const { return status_; }

 private:
  ExitStatus status_;
};

/// Bad input from a user: study file, command line, recording, artefact of another schema.
class InputError : public Error {
 public:
  explicit InputError(const std::string& message);
};

/// Arrays whose shapes don't go together: a bug in the caller, or a file that lied about its shape.
class ShapeError : public Error {
 public:
  explicit ShapeError(const std::string& message);
};

/// More rollouts failed than the study allows.
class FailedRolloutsError : public Error {
 public:
  explicit FailedRolloutsError(const std::string& message);
};

/// Work stopped on request after its state was saved; running it again goes on from there.
class Checkpointed : public Error {
 public:
  explicit Checkpointed(const std::string& message);
};

}  // namespace npdr
