#include "lab/peers/run_program.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>

namespace sweepcast::lab {
namespace {

constexpr rlim_t kMostSeconds = 600;

std::string last_line(const std::filesystem::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last.substr(0, 200);
}

/// Where a program's input comes from and its output goes to.
class Redirection {
 public:
  explicit Redirection(const std::filesystem::path& log) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
  }
  ~Redirection() { posix_spawn_file_actions_destroy(&actions_); }
  Redirection(const Redirection&) = delete;
  Redirection& operator=(const Redirection&) = delete;

  [[nodiscard]] const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

double milliseconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_usec) * 1e-3;
}

}  // namespace

bool has_program(const std::string& name) {
  if (name.find('/') != std::string::npos) return access(name.c_str(), X_OK) == 0;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path program = std::filesystem::path(folder) / name;
    std::error_code ignored;
    if (access(program.c_str(), X_OK) == 0 && !std::filesystem::is_directory(program, ignored)) {
      return true;
    }
  }
  return false;
}

Result<double> run_program(const std::vector<std::string>& arguments,
                           const std::filesystem::path& log) {
  const std::string& name = arguments.front();
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const Redirection redirection(log);
  pid_t child = 0;
  const int refused =
      posix_spawnp(&child, words.front(), redirection.get(), nullptr, words.data(), environ);
  if (refused != 0) {
    return fail(refused == ENOENT ? ErrorCode::not_found : ErrorCode::io,
                fmt::format("{}: cannot be run: {}; put a program that runs here on the PATH", name,
                            std::generic_category().message(refused)));
  }
  const rlimit limit{kMostSeconds, kMostSeconds};
  prlimit(child, RLIMIT_CPU, &limit, nullptr);
  int status = 0;
  rusage usage{};
  while (wait4(child, &status, 0, &usage) < 0) {
    if (errno != EINTR) return fail(ErrorCode::io, name + ": cannot be waited for");
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    return milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime);
  }
  const std::string how = WIFSIGNALED(status) ? fmt::format("signal {}", WTERMSIG(status))
                                              : fmt::format("exit status {}", WEXITSTATUS(status));
  return fail(ErrorCode::io, fmt::format("{}: ended with {}: {}", name, how, last_line(log)));
}

}  // namespace sweepcast::lab
