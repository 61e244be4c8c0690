#include "sweepcast/live/sweep_store.hpp"

#include <system_error>

namespace sweepcast::app {

namespace fs = std::filesystem;

namespace {

Status make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return {};
  return fail(ErrorCode::io, folder.string() + ": cannot be made (" + error.message() +
                                 "); choose another folder");
}

}  // namespace

Result<SweepStore> SweepStore::open(const std::string& output) {
  const bool is_file = output == "-" || fs::path(output).extension() == ".sweep";
  SweepStore store(is_file ? fs::path() : fs::path(output));
  if (!is_file) {
    if (Status made = make_folder(output); !made) return tl::unexpected(made.error());
    return store;
  }
  auto writer =
      SweepWriter::open(output == "-" ? "/dev/stdout" : output, SweepWriter::Mode::record);
  if (!writer) return tl::unexpected(writer.error());
  store.writers_.emplace(std::pair<std::string, std::string>(), std::move(*writer));
  return store;
}

Result<SweepWriter*> SweepStore::writer_of(const std::string& robot, const std::string& sensor) {
  const auto key =
      folder_.empty() ? std::pair<std::string, std::string>() : std::pair(robot, sensor);
  const auto found = writers_.find(key);
  if (found != writers_.end()) return &found->second;
  if (Status made = make_folder(folder_ / robot); !made) return tl::unexpected(made.error());
  auto writer = SweepWriter::open(folder_ / robot / (sensor + ".sweep"), SweepWriter::Mode::record);
  if (!writer) return tl::unexpected(writer.error());
  return &writers_.emplace(key, std::move(*writer)).first->second;
}

Status SweepStore::add(const ReceivedSweep& sweep) {
  auto writer = writer_of(std::string(sweep.robot), std::string(sweep.sensor));
  if (!writer) return tl::unexpected(writer.error());
  return (*writer)->append(sweep.frame, sweep.name);
}

Status SweepStore::close() {
  Status first;
  for (auto& [key, writer] : writers_) {
    if (Status closed = writer.close(); !closed && first) first = closed;
  }
  writers_.clear();
  return first;
}

}  // namespace sweepcast::app
