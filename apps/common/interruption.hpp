// Ctrl-C and its kin.
#pragma once

#include <chrono>

namespace sweepcast::app {

/// From here on, a signal that ends the program (SIGINT, SIGTERM, SIGHUP) first removes the files
/// and folders that are unfinished; the program then ends by that signal, which a shell shows as
/// status 128 + its number. Signals that the caller made us ignore stay ignored.
/// To be called once, before there are other threads: these inherit what is blocked here.
void remove_unfinished_on_signals();

/// From here on the first such signal ends nothing: `stop_requested` says that it came, for a
/// command that goes on until it is told to stop. One that comes a second later or more ends the
/// program as above. SIGINT and SIGTERM count even where the caller made us ignore them, as a shell
/// does with SIGINT for what it starts in the background. Files that reach their largest size
/// (SIGXFSZ) give an error when they are written.
void stop_on_signals();
[[nodiscard]] bool stop_requested();
/// Waits until then, or until there is a signal. True where there is one.
bool wait_for_stop(std::chrono::steady_clock::time_point until);

}  // namespace sweepcast::app
