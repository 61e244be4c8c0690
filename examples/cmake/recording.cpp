// Records three sweeps into a .sweep file as a robot would, and reads them back.
#include <filesystem>
#include <iostream>
#include <sweepcast/cloud.hpp>
#include <sweepcast/decoder.hpp>
#include <sweepcast/encoder.hpp>
#include <sweepcast/sweep_file.hpp>
#include <vector>

namespace {

// A wall 8 m ahead, 4 m wide; `shift` moves it.
sweepcast::PointCloud wall(float shift) {
  sweepcast::PointCloud cloud;
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 40; ++column) {
      cloud.x.push_back(8.0F + shift);
      cloud.y.push_back(0.1F * static_cast<float>(column) - 2.0F);
      cloud.z.push_back(0.1F * static_cast<float>(row) - 1.0F);
    }
  }
  return cloud;
}

sweepcast::Status record(const std::filesystem::path& path) {
  auto encoder = sweepcast::Encoder::create({});
  if (!encoder) return tl::make_unexpected(encoder.error());
  auto writer = sweepcast::SweepWriter::open(path, sweepcast::SweepWriter::Mode::record);
  if (!writer) return tl::make_unexpected(writer.error());
  for (std::uint64_t i = 0; i < 3; ++i) {
    const auto frame = encoder->encode(wall(static_cast<float>(i)), {.sequence = i});
    if (!frame) return tl::make_unexpected(frame.error());
    const auto status = writer->append(*frame, {});
    if (!status) return status;
  }
  return writer->close();
}

// The number of sweeps in the file that decode to a cloud.
sweepcast::Result<std::size_t> replay(const std::filesystem::path& path) {
  auto reader = sweepcast::SweepReader::open(path);
  if (!reader) return tl::make_unexpected(reader.error());
  sweepcast::Decoder decoder;
  sweepcast::PointCloud cloud;
  std::vector<std::byte> frame;
  std::size_t sweeps = 0;
  for (std::size_t i = 0; i < reader->entries().size(); ++i) {
    auto status = reader->read(i, frame);
    if (status) status = decoder.decode(frame, cloud);
    if (!status) return tl::make_unexpected(status.error());
    if (!cloud.empty() && decoder.last_header().sequence == i) ++sweeps;
  }
  return sweeps;
}

}  // namespace

int main() {
  const std::filesystem::path path = "walls.sweep";
  std::filesystem::remove(path);
  const auto status = record(path);
  if (!status) return std::cerr << status.error().message << '\n', 1;
  const auto sweeps = replay(path);
  if (!sweeps) return std::cerr << sweeps.error().message << '\n', 1;
  std::cout << *sweeps << " sweeps recorded and read back\n";
  return *sweeps == 3 ? 0 : 1;
}
