// `sweepcast keygen`: a new key for a robot.
#include <fmt/core.h>

#include <memory>

#include "sweepcast/commands.hpp"
#include "sweepcast/link.hpp"

namespace sweepcast::app {

void add_keygen(CLI::App& app, Command& command) {
  struct Options {
    std::string file;
    std::string robot;
  };
  auto options = std::make_shared<Options>();
  CLI::App* sub = app.add_subcommand("keygen", "Make a robot's key for the live link");
  sub->add_option("FILE", options->file, "The file to make; only its owner may use it")->required();
  sub->add_option("--robot", options->robot, "The robot's name")->type_name("NAME")->required();
  sub->footer(
      "Example: sweepcast keygen rover.key --robot rover\n"
      "The robot needs its own key file; the receiver those of all robots, joined with cat.");
  sub->callback([options, &command] {
    command = [options]() -> Status {
      const auto key = make_link_key(options->robot);
      if (!key) return tl::unexpected(key.error());
      return write_link_key(options->file, *key);
    };
  });
}

}  // namespace sweepcast::app
