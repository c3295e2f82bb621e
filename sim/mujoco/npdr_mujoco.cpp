// Models of MuJoCo as a simulator of npdr: a shared library with the interface of npdr_simulator.h,
// built only where MuJoCo is installed.
#include <fmt/format.h>

#include <cstdio>
#include <cstring>
#include <exception>

#include "sim/library/npdr_simulator.h"
#include "sim/mujoco/mujoco_simulator.h"

using npdr::mujoco::MujocoSimulator;

struct npdr_instance {
  explicit npdr_instance(const char* settings) : simulator(settings) {}
  MujocoSimulator simulator;
};

namespace {

// Calls `function`; an exception becomes the sentence in `error`.
template <class Function>
int guarded(char* error, const Function& function) {
  try {
    function();
    return 0;
  } catch (const std::exception& thrown) {
    std::snprintf(error, NPDR_ERROR_SIZE, "%s", thrown.what());
  } catch (...) {
    std::snprintf(error, NPDR_ERROR_SIZE, "unknown exception");
  }
  return 1;
}

int open_model(const char* settings, const char* /*folder*/, npdr_instance** instance,
               char* error) {
  return guarded(error, [&] { *instance = new npdr_instance(settings); });
}

int describe(npdr_instance* instance, npdr_description* description, char* error) {
  return guarded(error, [&] { *description = instance->simulator.description(); });
}

int replay(npdr_instance* instance, const npdr_batch* batch, double* states, uint8_t* status,
           char* error) {
  return guarded(error, [&] { instance->simulator.replay(*batch, states, status); });
}

void close_model(npdr_instance* instance) { delete instance; }

constexpr npdr_library kLibrary = {NPDR_SIMULATOR_VERSION, open_model, describe, replay,
                                   close_model};

}  // namespace

const npdr_library* npdr_simulator(void) { return &kLibrary; }
