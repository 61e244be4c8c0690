// The lab's commands, from simulate to train-detector: `sweepcast-lab` has them, with the heavy
// libraries that they need.
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "sweepcast/commands.hpp"

namespace sweepcast::app {

namespace {

namespace fs = std::filesystem;

struct LabCommand {
  const char* name;
  const char* help;
};

constexpr std::array<LabCommand, 9> kLabCommands{{
    {"simulate", "Drive a simulated sensor through a simulated town"},
    {"simulate-link", "Stream sweeps over a recorded link in virtual time, by each strategy"},
    {"bench", "Measure ratio, distortion and time over settings, beside other codecs"},
    {"ablate", "Measure what each of the method's ideas is worth"},
    {"evaluate", "Report what each codec does to odometry, meshing and detection on a drive"},
    {"odometry", "Find where the sensor was, from sweeps alone"},
    {"mesh", "Make one surface of many sweeps, and compare it"},
    {"detect", "Find cars in sweeps, and say how well"},
    {"train-detector", "Train PointPillars on simulated drives"},
}};

constexpr const char* kProgram = "sweepcast-lab";

/// Where the lab's program is: beside this one, or where an installation puts it; otherwise its
/// bare name, which is then looked for on PATH.
std::string find_program() {
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return kProgram;
  for (const fs::path& folder : {here, here / "../libexec/sweepcast"}) {
    const fs::path program = folder / kProgram;
    if (access(program.c_str(), X_OK) == 0) return program.string();
  }
  return kProgram;
}

}  // namespace

void add_lab(CLI::App& app) {
  for (const LabCommand& command : kLabCommands) {
    app.add_subcommand(command.name, command.help)->group("Commands of the lab");
  }
}

bool is_lab_command(const std::string& word) {
  return std::any_of(kLabCommands.begin(), kLabCommands.end(),
                     [&](const LabCommand& command) { return word == command.name; });
}

int run_lab(char** argv) {
  const std::string program = find_program();
  std::string name = kProgram;
  argv[0] = name.data();
  execvp(program.c_str(), argv);
  const int reason = errno;
  if (reason == ENOENT) {
    print_error(fmt::format(
        "{}: the program {} is not there; install the package sweepcast-lab, or build the target "
        "sweepcast_lab_tool",
        argv[1], kProgram));
  } else {
    print_error(fmt::format("{}: cannot run {}: {}; install the package sweepcast-lab again",
                            argv[1], program, std::strerror(reason)));
  }
  return 1;
}

}  // namespace sweepcast::app
