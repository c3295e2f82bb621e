#include "core/error.h"

namespace npdr {

Error::Error(const std::string& message, ExitStatus status)
    : std::runtime_error(message), status_(status) {}

InputError::InputError(const std::string& message) : Error(message, ExitStatus::invalid_input) {}

ShapeError::ShapeError(const std::string& message) : Error(message) {}

FailedRolloutsError::FailedRolloutsError(const std::string& message)
    : Error(message, ExitStatus::failed_rollouts) {}

Checkpointed::Checkpointed(const std::string& message) : Error(message, ExitStatus::checkpointed) {}

}  // namespace npdr
