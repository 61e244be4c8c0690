// Runs the built tool as a user does, in a fresh folder, on clouds that the test writes itself.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sweepcast::test {

/// x, y, z, intensity, as a .bin file holds them.
using BinPoint = std::array<float, 4>;

/// What a program left behind.
struct Outcome {
  int exit_status = -1;
  std::string out;
  std::string err;

  /// Standard output as JSON; a value of type "discarded" where it is none.
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out, nullptr, false); }
};

/// A small room, 16 x 180 points on walls 4 to 7 m away; `shift` moves the walls, metres.
std::vector<BinPoint> make_room(float shift);

class ToolTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Runs a line of shell in the test's folder; `$SWEEPCAST` is the tool.
  Outcome shell(const std::string& line) const;
  /// Runs the tool with these arguments, which the shell splits.
  Outcome run(const std::string& arguments) const { return shell("\"$SWEEPCAST\" " + arguments); }

  /// Runs the tool, sends it a signal as soon as `begun` says so, and returns the signal that ended
  /// it; 0 where it exited by itself.
  int interrupt(std::vector<std::string> arguments, int signal,
                const std::function<bool()>& begun) const;

  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::uintmax_t size(const std::string& name) const;
  [[nodiscard]] bool exists(const std::string& name) const;

  /// Writes and reads whole files, without the library's help. Folders are made.
  void write(const std::string& name, const std::string& bytes) const;
  [[nodiscard]] std::string read(const std::string& name) const;
  void write_bin(const std::string& name, const std::vector<BinPoint>& points) const;
  [[nodiscard]] std::vector<BinPoint> read_bin(const std::string& name) const;

  /// Names of the files in a folder, sorted, those that begin with a dot among them.
  [[nodiscard]] std::vector<std::string> list(const std::string& name) const;

  /// Writes rooms as sweeps/000000.bin and so on, and encodes them as room.sweep.
  void make_recording(int sweeps) const;

 private:
  std::filesystem::path folder_;
};

/// Checks exit status and that standard error holds every word.
void expect_failure(const Outcome& outcome, int exit_status, const std::vector<std::string>& words);

}  // namespace sweepcast::test
