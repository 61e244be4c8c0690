// Files and folders under temporary names, known to the whole process, so that a program that is
// told to end can remove them first.
#pragma once

#include <filesystem>
#include <mutex>

namespace sweepcast {

/// A path that is removed, with all that is in it, at the end of this object's life or by
/// `remove_unfinished`, unless it got its name or was forgotten before. Empty once that happened.
class Unfinished {
 public:
  Unfinished() = default;
  /// To be called before the path is made, so that there is no moment without an owner.
  explicit Unfinished(std::filesystem::path path);
  Unfinished(Unfinished&& other) noexcept { path_.swap(other.path_); }
  Unfinished& operator=(Unfinished&& other) noexcept {
    path_.swap(other.path_);
    return *this;
  }
  ~Unfinished();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] bool empty() const noexcept { return path_.empty(); }

  /// Gives what is finished its name, in place of what has it. Returns 0, or the error number.
  [[nodiscard]] int rename_to(const std::filesystem::path& name);

  /// Leaves the path alone.
  void forget();

 private:
  std::filesystem::path path_;
};

/// While this is held, `remove_unfinished` waits: for changes that must not be left half done.
[[nodiscard]] std::unique_lock<std::mutex> hold_unfinished();

/// Removes every unfinished path. Whoever then begins or finishes another one waits for ever: this
/// is the last thing that a program does.
void remove_unfinished();

}  // namespace sweepcast
