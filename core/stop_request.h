/// Requests to stop (SIGINT, SIGTERM, SIGUSR1, SIGHUP): long work looks at them between batches.
#pragma once

namespace npdr {

/// From now on the signals set a flag, in place of ending the process; SIGHUP doesn't where it is
/// ignored (nohup). For work that looks at the flag: all else is best ended at once. A second
/// SIGINT or SIGTERM, a second after the first or later, ends the process.
void watch_for_stop_requests();

/// Whether `signal` is a request to stop.
bool is_stop_signal(int signal);

/// True once a signal has come. Thread-safe.
bool stop_requested();

/// True once this signal has come. Thread-safe.
bool stop_signal_came(int signal);

/// Throws Checkpointed when a stop was requested: the work so far is saved.
void stop_here_if_requested();

}  // namespace npdr
