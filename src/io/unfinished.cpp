#include "io/unfinished.hpp"

#include <cerrno>
#include <cstdio>
#include <set>
#include <system_error>
#include <utility>

namespace sweepcast {
namespace {

namespace fs = std::filesystem;

struct Registry {
  std::mutex mutex;
  std::multiset<fs::path> paths;  // two threads may try the same name; one of them will get it
};

/// Never destroyed, since a signal may come while the program ends.
Registry& registry() {
  static auto& instance = *new Registry;
  return instance;
}

void forget_locked(fs::path& path) {
  auto& paths = registry().paths;
  if (const auto found = paths.find(path); found != paths.end()) paths.erase(found);
  path.clear();
}

}  // namespace

Unfinished::Unfinished(fs::path path) : path_(std::move(path)) {
  const auto lock = hold_unfinished();
  registry().paths.insert(path_);
}

Unfinished::~Unfinished() {
  if (empty()) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  forget();
}

int Unfinished::rename_to(const fs::path& name) {
  const auto lock = hold_unfinished();
  if (std::rename(path_.c_str(), name.c_str()) != 0) return errno;
  forget_locked(path_);
  return 0;
}

void Unfinished::forget() {
  const auto lock = hold_unfinished();
  forget_locked(path_);
}

std::unique_lock<std::mutex> hold_unfinished() {
  return std::unique_lock(registry().mutex);
}

void remove_unfinished() {
  hold_unfinished().release();  // for good
  std::error_code ignored;
  for (const fs::path& path : registry().paths) {
    // Under another name first: other threads may still be adding files to a folder.
    fs::path doomed = path;
    doomed += ".removed";
    fs::rename(path, doomed, ignored);
    fs::remove_all(doomed, ignored);
  }
}

}  // namespace sweepcast
