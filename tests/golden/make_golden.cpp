// Writes the golden frames that are missing: make_golden FOLDER. Never touches one that is there.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "golden/frames.hpp"

int main(int argc, char** argv) {
  using namespace sweepcast;
  if (argc != 2) {
    std::fputs("usage: make_golden FOLDER\n", stderr);
    return 2;
  }
  for (const test::GoldenSource& source : test::golden_sources()) {
    const std::filesystem::path stem = std::filesystem::path(argv[1]) / source.name;
    const std::filesystem::path path = stem.string() + ".frame";
    if (std::filesystem::exists(path)) continue;
    auto encoder = Encoder::create(source.options);
    if (!encoder) return 1;
    const auto frame = encoder->encode(source.cloud, {42, 1'700'000'000'000'000'000, source.name});
    PointCloud cloud;
    if (!frame || !Decoder().decode(*frame, cloud)) return 1;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(frame->data()),
               static_cast<std::streamsize>(frame->size()));
    std::ofstream text(stem.string() + ".txt");
    text << "points " << cloud.size() << "\nxyz_crc32 " << test::checksum_of(cloud)
         << "\nattributes_crc32 " << test::attributes_checksum_of(cloud) << "\n";
    if (!text.good()) return 1;
    std::printf("%s: %zu bytes, %zu points\n", path.c_str(), frame->size(), cloud.size());
  }
  return 0;
}
