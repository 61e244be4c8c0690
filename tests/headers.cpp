// Nothing: this target compiles the headers of tests/CMakeLists.txt once for all tests.
