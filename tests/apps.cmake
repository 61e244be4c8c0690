# Tests of the command-line tools, run as a user runs them.
