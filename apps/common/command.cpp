#include "common/command.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <exception>

namespace sweepcast::app {

int run(CLI::App& app, const Command& command, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    const Status status = command ? command() : Status{};
    if (status) return 0;
    fmt::print(stderr, "{}: error: {}\n", app.get_name(), status.error().message);
    return 1;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {  // a library's; ours come as Status
    fmt::print(stderr, "{}: error: {}\n", app.get_name(), error.what());
    return 1;
  }
}

}  // namespace sweepcast::app
