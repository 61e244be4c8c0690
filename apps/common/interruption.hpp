// Ctrl-C and its kin.
#pragma once

namespace sweepcast::app {

/// From here on, a signal that ends the program (SIGINT, SIGTERM, SIGHUP) first removes the files
/// and folders that are unfinished; the program then ends by that signal, which a shell shows as
/// status 128 + its number. Signals that the caller made us ignore stay ignored.
/// To be called once, before there are other threads: these inherit what is blocked here.
void remove_unfinished_on_signals();

}  // namespace sweepcast::app
