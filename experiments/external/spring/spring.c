/* A mass on a spring with viscous damping and dry friction, a force acting on it:
 *     mass q'' = force - stiffness q - damping q' - friction sign(q')
 * in ten substeps of semi-implicit Euler, as spring.py. Compile it with
 *     cc -O3 -march=native -shared -fPIC -I../../../build/release/include spring.c -o spring.so -lm
 */
#include <math.h>

#include "npdr_simulator.h"

static const npdr_parameter parameters[] = {
    {"mass", "kg", 1.0, 1e-6, INFINITY, 0.0, "what moves"},
    {"stiffness", "N/m", 20.0, 0.0, INFINITY, 0.0, "of the spring"},
    {"damping", "N s/m", 0.3, 0.0, INFINITY, 0.0, "viscous"},
    {"friction", "N", 0.2, 0.0, INFINITY, 0.0, "dry"},
};
static const npdr_channel states[] = {{"q", "m"}, {"v", "m/s"}};
static const npdr_channel actions[] = {{"force", "N"}};

/* Nothing has to be kept between two batches. */
static int open_spring(const char* settings, const char* folder, npdr_instance** instance,
                       char* error) {
  (void)settings, (void)folder, (void)error;
  *instance = (npdr_instance*)parameters;
  return 0;
}

static int describe(npdr_instance* instance, npdr_description* d, char* error) {
  (void)instance, (void)error;
  d->name = "spring";
  d->text = "a mass on a spring";
  d->num_parameters = 4, d->parameters = parameters;
  d->num_states = 2, d->states = states;
  d->num_actions = 1, d->actions = actions;
  return 0;
}

static int replay(npdr_instance* instance, const npdr_batch* batch, double* out, uint8_t* status,
                  char* error) {
  (void)instance, (void)status, (void)error;
  const double h = batch->dt / 10;
  for (int64_t i = 0; i < batch->num_rows; ++i) {
    const double* theta = batch->theta + 4 * i;
    const double* force = batch->actions;
    for (int64_t s = 0; s < batch->num_segments; ++s) {
      double q = batch->first_states[2 * s], v = batch->first_states[2 * s + 1];
      for (int64_t t = 0; t < batch->steps[s]; ++t, ++force, out += 2) {
        for (int k = 0; k < 10; ++k) {
          const double pull = *force - theta[1] * q - theta[2] * v;
          v += h / theta[0] * (pull - theta[3] * tanh(100.0 * v));
          q += h * v;
        }
        out[0] = q, out[1] = v;
      }
    }
  }
  return 0;
}

static void close_spring(npdr_instance* instance) { (void)instance; }

const npdr_library* npdr_simulator(void) {
  static const npdr_library library = {NPDR_SIMULATOR_VERSION, open_spring, describe, replay,
                                       close_spring};
  return &library;
}
