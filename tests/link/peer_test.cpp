// A receiver's side of a connection, fed with a sender's packets by hand.
#include "link/peer.hpp"

#include "codec/damage.hpp"
#include "codec/frame_edit.hpp"
#include "core/crc32.hpp"
#include "link/outbox.hpp"
#include "link/sender_report.hpp"
#include "link/support.hpp"
#include "sweepcast/decoder.hpp"

namespace sweepcast::link {
namespace {

using test::Bytes;

class PeerTest : public ::testing::Test {
 protected:
  PeerTest() {
    const Challenge ours = draw_challenge();
    peer_.take(write_hello(ours), 0);
    const SessionKeys keys = derive_session(key_, ours, peer_.challenge());
    sealer_.emplace(keys.to_receiver);
    opener_.emplace(keys.to_sender, std::initializer_list<PacketType>{PacketType::feedback});
  }

  void tell(std::uint32_t number, const SenderReport& report) {
    Bytes plain;
    write_sender_report(number, report, plain);
    peer_.take(sealer_->seal(PacketType::report, plain), 0);
  }
  /// The report that the sender is sent at `now`.
  std::optional<Report> feedback(Microseconds now, LevelWish wish) {
    std::span<const std::byte> plain;
    EXPECT_EQ(opener_->open(peer_.report(now, wish), plain), PacketFault::none);
    return read_report(plain);
  }

  /// The packets of a frame as a sender makes them.
  std::vector<Bytes> packets_of(const Bytes& frame, std::uint32_t model, Microseconds now) {
    const auto layers = cut_layers(frame, {static_cast<std::uint32_t>(now), model, "roof", "name"});
    outbox_.push(0, *layers, now + 200'000, now);
    std::vector<Bytes> packets;
    while (const auto fragment = outbox_.peek(now)) {
      Bytes plain;
      write_fragment(*fragment, plain);
      const auto packet = sealer_->seal(PacketType::fragment, plain);
      packets.emplace_back(packet.begin(), packet.end());
      outbox_.pop();
    }
    return packets;
  }
  void take_all(const std::vector<Bytes>& packets, Microseconds now) {
    for (const Bytes& packet : packets) peer_.take(packet, now);
  }

  LinkKey key_ = test::counting_key("rover");
  MemoryBudget memory_{std::size_t{1} << 22, 0};
  Peer peer_{key_, std::size_t{1} << 22, memory_, 0};
  std::optional<PacketSealer> sealer_;
  std::optional<PacketOpener> opener_;
  Outbox outbox_{SendOrder::freshest_first};
};

TEST_F(PeerTest, FramesArriveWithTheirModel) {
  const std::vector<Bytes> frames = test::small_frames(2);
  FrameHeader header;
  ASSERT_TRUE(parse_frame_header(frames[0], header));
  const std::uint32_t model = crc32(*model_part(frames[0], header));
  EXPECT_FALSE(peer_.is_authentic());
  take_all(packets_of(frames[0], model, 1000), 1500);
  EXPECT_TRUE(peer_.is_authentic());
  take_all(packets_of(frames[1], model, 101'000), 101'500);
  const auto arrived = peer_.take_arrived();
  ASSERT_EQ(arrived.size(), 2U);
  EXPECT_EQ(arrived[0].frame, frames[0]);
  EXPECT_EQ(arrived[1].layers, 5);
  EXPECT_EQ(arrived[1].label.sensor, "roof");
  PointCloud alone, in_order;
  Decoder decoder;
  ASSERT_TRUE(decoder.decode(frames[0], in_order));
  ASSERT_TRUE(decoder.decode(frames[1], in_order));
  ASSERT_TRUE(Decoder().decode(arrived[1].frame, alone));  // needs no frame before
  EXPECT_EQ(alone.x, in_order.x);
  peer_.set_round_trip(0.004);
  EXPECT_NEAR(peer_.age_of(arrived[1], 121'500), 0.022, 1e-6);
  EXPECT_EQ(peer_.take_counts().whole, 2U);
  EXPECT_EQ(peer_.take_counts().whole, 0U);
}

TEST_F(PeerTest, WithoutItsModelAFrameIsMissed) {
  const std::vector<Bytes> frames = test::small_frames(2);
  take_all(packets_of(frames[1], 12345, 0), 500);
  EXPECT_TRUE(peer_.take_arrived().empty());
  EXPECT_EQ(peer_.take_counts().missed, 1U);
}

TEST_F(PeerTest, AtTheDeadlineFewerLayersArrive) {
  const Bytes frame = test::small_frames(1).front();
  auto packets = packets_of(frame, 0, 0);
  packets.pop_back();
  take_all(packets, 1000);
  peer_.expire(1000);
  EXPECT_TRUE(peer_.take_arrived().empty());
  peer_.expire(500'000);
  const auto arrived = peer_.take_arrived();
  ASSERT_EQ(arrived.size(), 1U);
  EXPECT_EQ(arrived[0].layers, 4);
  EXPECT_EQ(arrived[0].layers_made, 5);
  DecoderOptions options;
  options.max_layers = 4;
  PointCloud truth, cloud;
  ASSERT_TRUE(Decoder(options).decode(frame, truth));
  ASSERT_TRUE(Decoder().decode(arrived[0].frame, cloud));
  EXPECT_EQ(cloud.x, truth.x);
}

TEST_F(PeerTest, ReportsTellWhatArrived) {
  take_all(packets_of(test::small_frames(1).front(), 0, 0), 1000);
  EXPECT_TRUE(peer_.report(40'000).empty());
  EXPECT_FALSE(peer_.report(60'000).empty());
  EXPECT_TRUE(peer_.report(100'000).empty());
  EXPECT_FALSE(peer_.report(110'000).empty());
}

TEST_F(PeerTest, SendersTellOfThemselvesTheNewestCounts) {
  SenderReport report;
  report.dropped = 4;
  tell(2, report);
  EXPECT_TRUE(peer_.is_authentic());
  report.dropped = 3;
  tell(1, report);  // was overtaken
  const auto told = peer_.take_sender_report();
  ASSERT_TRUE(told);
  EXPECT_EQ(told->dropped, 4U);
  EXPECT_FALSE(peer_.take_sender_report());
  EXPECT_EQ(peer_.take_counts().malformed, 0U);
  peer_.take(sealer_->seal(PacketType::report, Bytes(50)), 0);
  EXPECT_EQ(peer_.take_counts().malformed, 1U);
  EXPECT_FALSE(peer_.take_sender_report());
}

// A sender of the version before reads no wish and tells nothing of itself: it must get none.
TEST_F(PeerTest, AWishGoesToThoseAloneWhoSayThatTheyObey) {
  const LevelWish wish{4};
  take_all(packets_of(test::small_frames(1).front(), 0, 0), 1000);
  auto got = feedback(60'000, wish);
  ASSERT_TRUE(got);
  EXPECT_FALSE(got->wish);
  tell(1, {});
  got = feedback(120'000, wish);
  ASSERT_TRUE(got);
  EXPECT_FALSE(got->wish);
  SenderReport obedient;
  obedient.can_override = true;
  tell(2, obedient);
  got = feedback(180'000, wish);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->wish, wish);
  got = feedback(240'000, {});
  ASSERT_TRUE(got && got->wish);
  EXPECT_FALSE(got->wish->level);
}

// 100,000 packets, random, mutated, forged and replayed: all counted, none delivered.
TEST_F(PeerTest, HostilePacketsAreCountedAndNeverDelivered) {
  const Bytes frame = test::small_frames(1).front();
  const auto sound = packets_of(frame, 0, 0);
  std::mt19937 random(11);
  constexpr int kPackets = 100'000;
  for (int i = 0; i < kPackets; ++i) {
    Bytes packet = sound[test::random_bits(random) % sound.size()];
    if (i % 2 == 0) {
      packet.resize(static_cast<std::size_t>(test::uniform_int(random, 0, 1400)));
      for (std::byte& byte : packet) byte = static_cast<std::byte>(test::random_bits(random));
    } else {
      packet[static_cast<std::size_t>(test::uniform_int(random, 0, int(packet.size()) - 1))] ^=
          static_cast<std::byte>(1U << (test::random_bits(random) % 8));
    }
    peer_.take(packet, 1000 + i);
  }
  PeerCounts counts = peer_.take_counts();
  EXPECT_EQ(counts.forged + counts.malformed + counts.replayed, std::uint64_t{kPackets});
  EXPECT_GT(counts.forged, 10'000U);
  EXPECT_EQ(counts.packets, 0U);
  EXPECT_TRUE(peer_.take_arrived().empty());
  EXPECT_EQ(memory_.used, 0U);

  take_all(sound, 2'000'000);
  take_all(sound, 2'000'001);
  counts = peer_.take_counts();
  EXPECT_EQ(counts.packets, sound.size());
  EXPECT_EQ(counts.replayed, sound.size());
  const auto arrived = peer_.take_arrived();
  ASSERT_EQ(arrived.size(), 1U);
  EXPECT_EQ(arrived[0].frame, frame);
}

// Authentic but senseless: what a broken sender may send.
TEST_F(PeerTest, AuthenticNonsenseIsRefused) {
  std::mt19937 random(12);
  const Bytes frame = test::small_frames(1).front();
  const auto layers = cut_layers(frame, {0, 0, "roof", ""});
  for (std::uint32_t sweep = 1; sweep <= 2'000; ++sweep) {
    Bytes layer = layers->front();
    for (std::size_t k = 1; k < layers->size(); ++k) {
      layer.insert(layer.end(), (*layers)[k].begin(), (*layers)[k].end());
    }
    test::mutate(random, *layers, layer);
    if (layer.empty()) continue;
    for (const Fragment& fragment : test::fragments_of(layer, sweep, 0, 1)) {
      Bytes plain;
      write_fragment(fragment, plain);
      peer_.take(sealer_->seal(PacketType::fragment, plain), sweep);
    }
  }
  PeerCounts counts = peer_.take_counts();
  EXPECT_EQ(counts.malformed, 0U);
  EXPECT_GT(counts.missed, 1'000U);
  for (const ArrivedSweep& sweep : peer_.take_arrived()) {
    PointCloud cloud;
    (void)Decoder().decode(sweep.frame, cloud);
    FrameHeader header;
    EXPECT_TRUE(parse_frame_header(sweep.frame, header));
    EXPECT_EQ(header.frame_size, sweep.frame.size());
  }
}

}  // namespace
}  // namespace sweepcast::link
