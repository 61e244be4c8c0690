// The commands of the live link where the libraries that it needs are absent.
#include "sweepcast/commands.hpp"

namespace sweepcast::app {
namespace {

void add_absent(CLI::App& app, Command& command, const char* name, const char* help) {
  CLI::App* sub = app.add_subcommand(name, help);
  sub->allow_extras();
  sub->callback([&command] {
    command = []() -> Status {
      return fail(ErrorCode::unsupported,
                  "this build has no live link; apt-get install libsrt-openssl-dev libsodium-dev "
                  "and build again");
    };
  });
}

}  // namespace

void add_keygen(CLI::App& app, Command& command) {
  add_absent(app, command, "keygen", "Make a robot's key (not in this build)");
}

void add_send(CLI::App& app, Command& command) {
  add_absent(app, command, "send", "Send sweeps to a receiver (not in this build)");
}

void add_receive(CLI::App& app, Command& command) {
  add_absent(app, command, "receive", "Receive sweeps from robots (not in this build)");
}

}  // namespace sweepcast::app
