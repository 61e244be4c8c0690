// Prints checksums of the frames that made-up sweeps become and of the clouds that these decode to.
// The same source, built for another processor, must print the same. Arguments: frames to decode
// as well.
#include <bit>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/bytes.hpp"
#include "core/crc32.hpp"
#include "cross/cases.hpp"
#include "sweepcast/decoder.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::test {
namespace {

std::uint32_t checksum(const PointCloud& cloud) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  out.put(cloud.width);
  for (const auto* column : {&cloud.x, &cloud.y, &cloud.z, &cloud.intensity}) {
    for (const float value : *column) {
      out.put(value == value ? std::bit_cast<std::uint32_t>(value) : 0x7FC00000U);
    }
  }
  for (const std::uint16_t ring : cloud.ring) out.put(ring);
  for (const std::int64_t time : cloud.time_ns) out.put(time);
  for (const std::uint8_t filled : cloud.filled) out.put(filled);
  return crc32(bytes);
}

unsigned long printable(std::uint32_t value) {
  return value;
}

// "NAME failed: WHY", or "NAME POINTS points CHECKSUM".
void print_decoded(const std::string& name, std::span<const std::byte> frame, Decoder& decoder) {
  PointCloud cloud;
  if (const Status status = decoder.decode(frame, cloud); !status) {
    std::printf("  %s failed: %s\n", name.c_str(), status.error().message.c_str());
    return;
  }
  std::printf("  %s %zu points %08lx\n", name.c_str(), cloud.size(), printable(checksum(cloud)));
}

// Two sweeps through one encoder, the second with what was learnt from the first.
void print_case(const CrossCase& item) {
  auto encoder = Encoder::create(item.options);
  if (!encoder) {
    std::printf("%s failed: %s\n", item.name.c_str(), encoder.error().message.c_str());
    return;
  }
  Decoder decoder;
  Decoder coarse({.max_layers = 2});
  Decoder filling({.fill = true});
  for (std::size_t i = 0; i < item.sweeps.size(); ++i) {
    const auto frame = encoder->encode(item.sweeps[i], {i, 1'000'000'000, "made up"});
    if (!frame) {
      std::printf("%s failed: %s\n", item.name.c_str(), frame.error().message.c_str());
      return;
    }
    if (item.options.codec == CodecId::beam) {
      std::printf("%s %zu: %zu bytes %08lx\n", item.name.c_str(), i, frame->size(),
                  printable(crc32(*frame)));
      print_decoded("coarse", *frame, coarse);
      if (encoder->last_counts().thinned > 0) print_decoded("filled", *frame, filling);
    } else {  // what zstd makes of its parts depends on zstd
      std::printf("%s %zu\n", item.name.c_str(), i);
    }
    print_decoded("whole", *frame, decoder);
  }
}

void print_file(const char* path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string whole(path);
  Decoder decoder;
  print_decoded(whole.substr(whole.find_last_of('/') + 1),
                std::as_bytes(std::span(text.data(), text.size())), decoder);
}

}  // namespace
}  // namespace sweepcast::test

int main(int argc, char** argv) {
  for (const auto& item : sweepcast::test::cross_cases()) sweepcast::test::print_case(item);
  for (int i = 1; i < argc; ++i) sweepcast::test::print_file(argv[i]);
  return 0;
}
