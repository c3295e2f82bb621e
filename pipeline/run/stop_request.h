/// Requests to stop (SIGINT, SIGTERM, SIGUSR1): long work looks at them between batches.
#pragma once

namespace npdr::pipeline {

/// From now on the signals set a flag, in place of ending the process.
void watch_for_stop_requests();

/// True once a signal has come. Thread-safe.
bool stop_requested();

/// Throws Checkpointed when a stop was requested: the work so far is saved.
void stop_here_if_requested();

}  // namespace npdr::pipeline
