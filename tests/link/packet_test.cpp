#include "link/packet.hpp"

#include "core/random.hpp"
#include "link/support.hpp"

namespace sweepcast::link {
namespace {

using test::Bytes;
using test::hex;

Bytes text(const std::string& words) {
  const auto bytes = std::as_bytes(std::span(words));
  return {bytes.begin(), bytes.end()};
}

class Packets : public ::testing::Test {
 protected:
  [[nodiscard]] Bytes sealed(const std::string& words) {
    const auto packet = sealer_.seal(PacketType::fragment, text(words));
    return {packet.begin(), packet.end()};
  }
  [[nodiscard]] PacketFault open(std::span<const std::byte> packet) {
    const PacketFault fault = opener_.open(packet, plain_);
    EXPECT_TRUE(fault == PacketFault::none || plain_.empty());
    return fault;
  }

  LinkSecret key_ = test::counting_key("r").secret;
  PacketSealer sealer_{key_};
  PacketOpener opener_{key_, {PacketType::fragment}};
  std::span<const std::byte> plain_;
};

// Computed with Python's cryptography, which has OpenSSL's ChaCha20-Poly1305.
TEST_F(Packets, AreSealedAsTheFormatSays) {
  EXPECT_EQ(hex(sealed("hello")), "020100000000000000f7329f33dafb3aee94c5e50c3662ee9ea6d60775e3");
}

TEST_F(Packets, OpenOnceInAnyOrder) {
  const Bytes a = sealed("a"), b = sealed("b"), c = sealed("");
  EXPECT_EQ(open(c), PacketFault::none);
  EXPECT_TRUE(plain_.empty());
  EXPECT_EQ(open(a), PacketFault::none);
  EXPECT_EQ(hex(plain_), "61");
  EXPECT_EQ(open(b), PacketFault::none);
  EXPECT_EQ(hex(plain_), "62");
  for (const Bytes& packet : {a, b, c}) EXPECT_EQ(open(packet), PacketFault::replayed);
}

TEST_F(Packets, AnyChangedBitIsSeen) {
  const Bytes packet = sealed("a small secret");
  for (std::size_t bit = 0; bit < 8 * packet.size(); ++bit) {
    Bytes changed = packet;
    changed[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    const PacketFault expected = bit < 8    ? PacketFault::malformed
                                 : bit == 8 ? PacketFault::replayed  // the counter is now 0
                                            : PacketFault::forged;
    EXPECT_EQ(open(changed), expected) << bit;
  }
  EXPECT_EQ(open(packet), PacketFault::none);  // no forgery shuts the true one out
}

TEST_F(Packets, SizesAreChecked) {
  const Bytes packet = sealed("words");
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_EQ(open(std::span(packet).first(size)),
              size < kPacketHeadBytes + kTagBytes ? PacketFault::truncated : PacketFault::forged);
  }
  EXPECT_EQ(open(Bytes(kMostPacketBytes + 1)), PacketFault::oversized);
  const Bytes largest = sealed(std::string(kMostPlainBytes, 'x'));
  EXPECT_EQ(largest.size(), kMostPacketBytes);
  EXPECT_EQ(open(largest), PacketFault::none);
}

TEST_F(Packets, OtherKeysAndTypesAreRefused) {
  LinkSecret other = key_;
  other[31] ^= 1;
  PacketSealer stranger(other);
  EXPECT_EQ(open(stranger.seal(PacketType::fragment, text("x"))), PacketFault::forged);
  EXPECT_EQ(open(sealer_.seal(PacketType::feedback, text("x"))), PacketFault::malformed);
  EXPECT_EQ(open(sealer_.seal(PacketType::report, text("x"))), PacketFault::malformed);
}

TEST_F(Packets, TypesOfOneDirectionShareItsCounterAndCannotBeSwapped) {
  PacketOpener both(key_, {PacketType::fragment, PacketType::report});
  const Bytes fragment = sealed("a");
  const auto report = sealer_.seal(PacketType::report, text("b"));
  Bytes swapped(report.begin(), report.end());
  swapped[0] = std::byte{2};
  EXPECT_EQ(both.open(swapped, plain_), PacketFault::forged);
  EXPECT_EQ(both.open(report, plain_), PacketFault::none);
  EXPECT_EQ(both.type(), PacketType::report);
  EXPECT_EQ(both.open(fragment, plain_), PacketFault::none);
  EXPECT_EQ(both.type(), PacketType::fragment);
  EXPECT_EQ(both.open(report, plain_), PacketFault::replayed);
}

TEST_F(Packets, RandomBytesNeverOpen) {
  std::mt19937 random(5);
  for (int i = 0; i < 20'000; ++i) {
    Bytes packet(static_cast<std::size_t>(test::uniform_int(random, 0, 100)));
    for (std::byte& byte : packet) byte = static_cast<std::byte>(test::random_bits(random));
    if (!packet.empty()) packet[0] = std::byte{2};
    ASSERT_NE(open(packet), PacketFault::none);
  }
}

TEST(ReplayWindow, AgreesWithASetOfAllCounters) {
  std::mt19937 random(9);
  ReplayWindow window;
  std::vector<bool> seen(200'000);
  std::uint64_t highest = 0;
  EXPECT_FALSE(window.is_fresh(0));
  for (int i = 0; i < 100'000; ++i) {
    const int reach = test::random_bits(random) % 100 == 0 ? 9000 : 40;
    const std::int64_t wish = static_cast<std::int64_t>(highest) +
                              test::uniform_int(random, -reach / 2 - 4100 * (i % 2), reach / 20);
    const auto counter = static_cast<std::uint64_t>(std::max<std::int64_t>(wish, 1));
    if (counter >= seen.size()) break;
    const bool is_old = counter + ReplayWindow::kSize <= highest;
    ASSERT_EQ(window.is_fresh(counter), !is_old && !seen[counter]) << counter << " " << highest;
    if (is_old || seen[counter]) continue;
    window.mark(counter);
    seen[counter] = true;
    highest = std::max(highest, counter);
  }
  EXPECT_GT(highest, 10'000U);
}

TEST(Hello, ComesBackAndNothingElseDoes) {
  Challenge challenge{};
  challenge[0] = 7;
  challenge[15] = 9;
  Bytes hello = write_hello(challenge);
  EXPECT_EQ(hex(hello), "010107" + std::string(28, '0') + "09");
  EXPECT_EQ(read_hello(hello), challenge);
  hello[1] = std::byte{2};
  EXPECT_FALSE(read_hello(hello));
  hello[1] = std::byte{1};
  hello.push_back(std::byte{0});
  EXPECT_FALSE(read_hello(hello));
  hello.resize(17);
  EXPECT_FALSE(read_hello(hello));
}

}  // namespace
}  // namespace sweepcast::link
