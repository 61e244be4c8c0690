#include "apps/tool_fixture.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

namespace sweepcast::test {

namespace fs = std::filesystem;

std::vector<BinPoint> make_room(float shift) {
  constexpr int kRings = 16;
  constexpr int kColumns = 180;
  constexpr float kDegree = 3.14159265F / 180.0F;
  std::vector<BinPoint> points;
  for (int ring = 0; ring < kRings; ++ring) {
    const float elevation = (static_cast<float>(2 * ring) - 15.0F) * kDegree;
    for (int column = 0; column < kColumns; ++column) {
      const float azimuth = (static_cast<float>(2 * column) - 179.0F) * kDegree;
      const float wall = 5.0F + shift;  // a square room: the nearer pair of walls is hit
      const float rho = wall / std::max(std::abs(std::cos(azimuth)), std::abs(std::sin(azimuth)));
      points.push_back(
          {rho * std::cos(azimuth), rho * std::sin(azimuth), rho * std::tan(elevation), 0.25F});
    }
  }
  return points;
}

void ToolTest::SetUp() {
  std::string pattern = (fs::temp_directory_path() / "sweepcast-tool-XXXXXX").string();
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  folder_ = pattern;
}

void ToolTest::TearDown() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

Outcome ToolTest::shell(const std::string& line) const {
  const fs::path captured = folder_.string() + ".output";
  fs::create_directory(captured);
  const std::string command = "export SWEEPCAST='" SWEEPCAST_TOOL "'; cd '" + folder_.string() +
                              "' && { " + line + "\n} >'" + (captured / "out").string() + "' 2>'" +
                              (captured / "err").string() + "'";
  const int status = std::system(command.c_str());
  const auto text = [](const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, text(captured / "out"),
                  text(captured / "err")};
  fs::remove_all(captured);
  return outcome;
}

int ToolTest::interrupt(std::vector<std::string> arguments, int signal,
                        const std::function<bool()>& begun) const {
  arguments.insert(arguments.begin(), SWEEPCAST_TOOL);
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder_.c_str()) == 0) execv(words.front(), words.data());
    std::_Exit(127);
  }
  int status = 0;
  pid_t ended = 0;
  while (ended == 0 && !begun()) ended = waitpid(child, &status, WNOHANG);
  if (ended == 0) {
    kill(child, signal);
    waitpid(child, &status, 0);
  }
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

std::uintmax_t ToolTest::size(const std::string& name) const {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path(name), error);
  EXPECT_FALSE(error) << name;
  return bytes;
}

bool ToolTest::exists(const std::string& name) const {
  return fs::exists(path(name));
}

void ToolTest::write(const std::string& name, const std::string& bytes) const {
  fs::create_directories(path(name).parent_path());
  std::ofstream out(path(name), std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  ASSERT_TRUE(out.good()) << name;
}

std::string ToolTest::read(const std::string& name) const {
  std::ifstream in(path(name), std::ios::binary);
  EXPECT_TRUE(in.good()) << name;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

void ToolTest::write_bin(const std::string& name, const std::vector<BinPoint>& points) const {
  std::string bytes(points.size() * sizeof(BinPoint), '\0');
  std::memcpy(bytes.data(), points.data(), bytes.size());
  write(name, bytes);
}

std::vector<BinPoint> ToolTest::read_bin(const std::string& name) const {
  const std::string bytes = read(name);
  EXPECT_EQ(bytes.size() % sizeof(BinPoint), 0U) << name;
  std::vector<BinPoint> points(bytes.size() / sizeof(BinPoint));
  std::memcpy(points.data(), bytes.data(), points.size() * sizeof(BinPoint));
  return points;
}

std::vector<std::string> ToolTest::list(const std::string& name) const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path(name))) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void ToolTest::make_recording(int sweeps) const {
  for (int i = 0; i < sweeps; ++i) {
    write_bin("sweeps/00000" + std::to_string(i) + ".bin", make_room(0.1F * static_cast<float>(i)));
  }
  const Outcome encoded = run("encode sweeps -o room.sweep");
  ASSERT_EQ(encoded.exit_status, 0) << encoded.err;
}

void expect_failure(const Outcome& outcome, int exit_status,
                    const std::vector<std::string>& words) {
  EXPECT_EQ(outcome.exit_status, exit_status) << outcome.out << outcome.err;
  for (const std::string& word : words) {
    EXPECT_NE(outcome.err.find(word), std::string::npos)
        << "\"" << word << "\" is not in: " << outcome.err;
  }
}

}  // namespace sweepcast::test
