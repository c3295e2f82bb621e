/* The C interface of a simulator that npdr loads as a shared library.
 *
 * A library is one file, compiled by one line, without anything of npdr but this header:
 *
 *   cc -O3 -march=native -shared -fPIC -I<folder of this header> mine.c -o mine.so
 *
 * It exports one function, npdr_simulator(), which returns a table of functions. npdr opens one
 * simulator per thread. It never calls one simulator from two threads at the same time, but does
 * call different ones: what they share must be constant. Strings are UTF-8 and belong to the
 * library; they stay valid until the simulator is closed.
 *
 * A row's result must depend on nothing but its theta, its seed and the segments: not on the other
 * rows, the order of calls, time or random numbers of the library's own. Then posteriors are the
 * same, bit for bit, for any number of threads and after any restart.
 *
 * A library shares the memory of npdr: it can corrupt it. One that crashes, or doesn't return
 * within the study's simulator.time_limit, ends the program that simulates. Who can't rule that out
 * has a worker, which is a process of its own.
 */
#ifndef NPDR_SIMULATOR_H
#define NPDR_SIMULATOR_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Raised when anything in this file changes its meaning. */
#define NPDR_SIMULATOR_VERSION 1

/* Bytes behind `error`, with the final 0. */
#define NPDR_ERROR_SIZE 1024

/* A domain parameter. Limits may be -INFINITY and INFINITY: outside of them npdr doesn't simulate.
 */
typedef struct npdr_parameter {
  const char* name;
  const char* unit; /* such as "kg"; "1": without dimension */
  double nominal;
  double lower;
  double upper;
  double period; /* values this far apart are the same system; 0: none are */
  const char* description;
} npdr_parameter;

/* A column of states or actions. */
typedef struct npdr_channel {
  const char* label; /* such as "theta_dot" */
  const char* unit;  /* such as "rad/s" */
} npdr_channel;

/* What a simulator is. P parameters, C state channels, A action channels. */
typedef struct npdr_description {
  const char* name;
  const char* text; /* one line for people */
  int64_t num_parameters;
  const npdr_parameter* parameters;
  int64_t num_states; /* at least 1 */
  const npdr_channel* states;
  int64_t num_actions; /* may be 0 */
  const npdr_channel* actions;
  /* Text that changes whenever results may, beside the library's file and settings: the version of
   * an engine, a hash of the files that it reads. May be NULL. */
  const char* fingerprint;
} npdr_description;

/* n rows of domain parameters, each to be simulated over the same S segments.
 *
 * Segment s begins at first_states[s] and takes steps[s] steps of dt seconds. Its actions are those
 * of the steps, each held over its step. Segments follow each other in all arrays: T = the sum of
 * steps[] is the number of states to return, and of rows of actions. A segment that goes on in the
 * middle of a recorded rollout has past[s] > 0: that many rows of actions right before its own are
 * of the same rollout, for systems that react with a delay. */
typedef struct npdr_batch {
  int64_t num_rows;           /* n */
  int64_t num_segments;       /* S */
  int64_t num_steps;          /* T */
  double dt;                  /* [s] */
  const double* theta;        /* (n, P), row-major as all arrays are */
  const uint32_t* seeds;      /* (n), < 2^31: for rows that depend on chance; mix in s */
  const int64_t* steps;       /* (S) */
  const int64_t* past;        /* (S) */
  const double* first_states; /* (S, C) */
  const double* actions;      /* (T, A) */
} npdr_batch;

/* How a row ended. States of any other row than NPDR_OK are not looked at. */
enum {
  NPDR_OK = 0,
  NPDR_DIVERGED = 1,     /* a state became NaN or infinite; npdr finds those itself, too; or
                          * the row came to no end */
  NPDR_OUT_OF_LIMITS = 2 /* parameters that are physically impossible */
};

/* A simulator that the library has opened. */
typedef struct npdr_instance npdr_instance;

/* Functions return 0 when they succeed; else they have written a sentence to `error`, which has
 * NPDR_ERROR_SIZE bytes. Exceptions of C++ must not leave them; npdr reports those that do. */
typedef struct npdr_library {
  uint32_t version; /* NPDR_SIMULATOR_VERSION */

  /* Makes a simulator. `settings` is the study's table [simulator.settings] as a JSON object; "{}"
   * when it has none. `folder` is where the study lies: relative paths begin there. */
  int (*open)(const char* settings, const char* folder, npdr_instance** instance, char* error);

  /* Describes it; what the pointers of `description` point to lives as long as the instance. */
  int (*describe)(npdr_instance* instance, npdr_description* description, char* error);

  /* Simulates a batch: states (n, T, C), where state t of a segment is that after its action t, so
   * that first_states are never among them; status (n), all NPDR_OK at first. A failure is one of
   * the whole batch, and ends the study; rows that fail have a status. */
  int (*replay)(npdr_instance* instance, const npdr_batch* batch, double* states, uint8_t* status,
                char* error);

  /* Ends it. */
  void (*close)(npdr_instance* instance);
} npdr_library;

#define NPDR_EXPORT __attribute__((visibility("default")))

/* What a library exports: a table that lives as long as the library is loaded. */
NPDR_EXPORT const npdr_library* npdr_simulator(void);

#ifdef __cplusplus
}
#endif

#endif
