// Encoding and decoding allocate nothing once their buffers have grown. Every allocation of this
// program is counted: operator new, and malloc too where no sanitizer has taken it over.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "codec/beam/sensor.hpp"
#include "codec/scene.hpp"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) || \
    __has_feature(thread_sanitizer)
#define SWEEPCAST_MALLOC_IS_TAKEN
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define SWEEPCAST_MALLOC_IS_TAKEN
#endif

namespace {
std::size_t allocations = 0;  // one thread
}  // namespace

#ifdef SWEEPCAST_MALLOC_IS_TAKEN
// Not inlined: compilers would see malloc's memory in operator delete, and warn.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  ++allocations;
  return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
#else
// glibc's operator new calls malloc, and so does zstd.
extern "C" {
void* __libc_malloc(std::size_t size);                     // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t count, std::size_t size);  // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void* memory, std::size_t size);      // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
// NOLINTNEXTLINE(readability-inconsistent-declaration-parameter-name)
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
// NOLINTNEXTLINE(readability-inconsistent-declaration-parameter-name)
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
}
#endif

namespace sweepcast {
namespace {

TEST(Allocation, IsCounted) {
  const std::size_t before = allocations;
  ::operator delete(::operator new(1));
  EXPECT_GT(allocations, before);
}

/// Allocations of `rounds` sweeps after two for warming up.
template <class Work>
std::size_t allocations_of(int rounds, Work work) {
  work();
  work();
  const std::size_t before = allocations;
  for (int i = 0; i < rounds; ++i) work();
  return allocations - before;
}

TEST(Allocation, EncodeAndDecodeAllocateNothingInTheSteadyState) {
  const PointCloud sweep = test::street(64, 1800);
  for (const EncoderOptions& options : test::all_options()) {
    Encoder encoder = test::encoder_of(options);
    bool good = true;
    const int rounds = options.rcpcc.zstd_level > 9 ? 2 : 5;
    EXPECT_EQ(allocations_of(rounds,
                             [&] {
                               good = good && encoder.encode(sweep, {1, 2, "sensor"}).has_value();
                             }),
              0U);
    const test::Bytes frame = test::encode(encoder, sweep, {1, 2, "sensor"});
    Decoder decoder;
    PointCloud cloud;
    EXPECT_EQ(
        allocations_of(rounds, [&] { good = good && decoder.decode(frame, cloud).has_value(); }),
        0U);
    EXPECT_TRUE(good);
  }
}

TEST(Allocation, BeamAllocatesNothingInTheSteadyStateEither) {
  const PointCloud sweep = test::spinning_sweep(32, 900, 1);
  for (const Effort effort : {Effort::fast, Effort::normal, Effort::best}) {
    EncoderOptions options;
    options.beam.effort = effort;
    options.beam.max_error_m = 0.05;
    options.beam.fields = Fields::xyz;
    Encoder encoder = test::encoder_of(options);
    Decoder decoder;
    PointCloud cloud;
    test::Bytes frame = test::encode(encoder, sweep);
    bool good = decoder.decode(frame, cloud).has_value();
    EXPECT_EQ(allocations_of(3, [&] { good = good && encoder.encode(sweep, {}).has_value(); }), 0U);
    frame = test::encode(encoder, sweep);
    EXPECT_EQ(allocations_of(3, [&] { good = good && decoder.decode(frame, cloud).has_value(); }),
              0U);
    EXPECT_TRUE(good);
    EXPECT_GT(cloud.size(), 20'000U);
  }
}

TEST(Allocation, SmallerSweepsAllocateNothingEither) {
  // For as long as zstd might take to give back memory that it finds too large.
  const PointCloud large = test::street(32, 900, 1);
  const PointCloud small = test::street(4, 90, 2);
  Encoder encoder = test::encoder_of({.codec = CodecId::rcpcc});
  Decoder decoder;
  PointCloud cloud;
  const test::Bytes large_frame = test::encode(encoder, large);
  const test::Bytes small_frame = test::encode(encoder, small);
  bool good = decoder.decode(large_frame, cloud).has_value();
  EXPECT_EQ(allocations_of(200,
                           [&] {
                             good = good && encoder.encode(small, {}).has_value() &&
                                    decoder.decode(small_frame, cloud).has_value();
                           }),
            0U);
  EXPECT_TRUE(good);
}

}  // namespace
}  // namespace sweepcast
