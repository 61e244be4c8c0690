// The live link: frames from robots to a receiver, on time. Part of library sweepcast::link.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sweepcast/frame.hpp"
#include "sweepcast/status.hpp"

namespace sweepcast {

/// Whether a text may name a robot or a sensor: 1 to 64 letters, digits, dots, dashes and
/// underscores, the first one no dot. Names become folders and files at the receiver.
[[nodiscard]] bool is_link_name(std::string_view name) noexcept;

using LinkSecret = std::array<std::uint8_t, 32>;

/// What a robot and its receiver share. Nothing is accepted from a peer without one.
struct LinkKey {
  std::string robot;
  LinkSecret secret{};
};

/// Draws a new key. Errors: invalid_argument (not a name), unsupported (no random numbers).
[[nodiscard]] Result<LinkKey> make_link_key(std::string_view robot);

/// Writes a key to a new file that only its owner may use (mode 0600). Errors: io, also where the
/// file exists.
[[nodiscard]] Status write_link_key(const std::filesystem::path& path, const LinkKey& key);

/// Reads a key file: a key a line, as `write_link_key` writes them; files may be joined.
/// Errors: not_found, io, invalid_argument (others than the owner may use the file), corrupt (with
/// the line), limit.
[[nodiscard]] Result<std::vector<LinkKey>> read_link_keys(const std::filesystem::path& path);

/// What a sender knows of its link when it has to choose how many bytes to spend.
struct LinkState {
  double time_s = 0;              ///< of a clock that never jumps
  double receive_rate = 0;        ///< bytes a second that arrived, since the report before
  double queue_delay_s = 0;       ///< one-way delay above the least of the last 10 to 20 s
  double round_trip_s = 0;        ///< of the newest report's echo
  double least_round_trip_s = 0;  ///< of the last 2 s
  double report_age_s = 0;        ///< since the newest report
  std::size_t queued_bytes = 0;   ///< not yet handed to the transport
};

/// What the sweeps of one interval may cost, all sensors together.
struct LinkBudget {
  /// Of the codec's ladder, where the strategy or the receiver's operator chose one; else
  std::optional<std::size_t> level;
  std::size_t sweep_bytes = 8000;  ///< so many bytes; 0: as many as there are
};

struct SenderOptions {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;
  LinkKey key;
  std::chrono::milliseconds deadline{250};  ///< of a sweep, from its capture; 10 ms to 10 s
  std::string strategy = "budget";  ///< or another of docs/rate.md: paper, bola, mpc, fixed:L
  CodecId codec = CodecId::beam;    ///< of the frames: "budget" is another one with each
  double rate_hz = 10.0;            ///< sweeps a second of each sensor, 0.1 to 1000
  bool allow_override = false;      ///< the receiver may ask for a level in the strategy's place
};

/// A frame to send.
struct OutgoingSweep {
  std::span<const std::byte> frame;
  std::string_view sensor;  ///< see `is_link_name`; at most 16 sensors a sender
  std::string_view name;    ///< of its source, at most 64 bytes; may be empty
  std::chrono::steady_clock::time_point captured;  ///< when its last point was measured
  /// Layers that end beyond so many bytes are left out, but for the first; 0: none are.
  std::size_t most_bytes = 0;
  std::optional<std::size_t> level{};  ///< that it was encoded at, where it is one of the ladder's
};

/// What a sender tells its receiver of itself, twice a second. Counters are since its start.
struct SenderReport {
  std::optional<std::size_t> level;  ///< of the newest sweep; none where it is no ladder's level
  std::size_t queued_frames = 0;     ///< not fully sent
  std::size_t queued_bytes = 0;
  std::uint64_t sweeps = 0;   ///< to send
  std::uint64_t sent = 0;     ///< all layers left in time
  std::uint64_t cut = 0;      ///< only some did
  std::uint64_t dropped = 0;  ///< none did
  /// Mean QoE of a sweep (docs/rate.md), of each sensor's last 100; none where sweeps are no
  /// ladder's levels.
  std::optional<double> qoe;
  bool can_override = false;                  ///< it obeys when it is asked for a level
  std::optional<std::size_t> override_level;  ///< that it was asked for and sends; none: its own
};

/// Counters since the start, and how things are now.
struct SenderStatus {
  bool connected = false;
  std::uint64_t connections = 0;
  std::uint64_t sweeps = 0;          ///< given to `send`
  std::uint64_t sweeps_sent = 0;     ///< of which all layers left
  std::uint64_t sweeps_cut = 0;      ///< of which only some layers left in time
  std::uint64_t sweeps_dropped = 0;  ///< of which none did
  std::uint64_t packets = 0;
  std::uint64_t packets_retransmitted = 0;
  std::uint64_t packets_refused = 0;  ///< from the receiver, not authentic or damaged
  std::uint64_t bytes = 0;            ///< of packets, without the transport's heads
  std::uint64_t reports = 0;
  LinkState link;
  LinkBudget budget;
  double bytes_per_second = 0;  ///< the pace at which packets leave, everything counted
  SenderReport report;          ///< what the receiver is told
  std::string error;  ///< why the last connection ended or failed; empty while all is well
};

/// Sends sweeps over one link. Connects, and connects again, by itself. All members may be called
/// from any thread.
class Sender {
 public:
  /// Begins to connect; needs no receiver to be there. Errors: invalid_argument (a name, a host
  /// that cannot be resolved, a deadline or rate out of bounds, no such strategy), unsupported.
  [[nodiscard]] static Result<Sender> start(SenderOptions options);

  Sender(Sender&&) noexcept;
  Sender& operator=(Sender&&) noexcept;
  /// Drops what has not left; `finish` first to wait for it.
  ~Sender();

  /// Queues a frame; returns at once. An older sweep of the sensor that still waits is cut to the
  /// layer at hand, or dropped where no byte of it has left.
  /// Errors: invalid_argument (names), those of `parse_frame_header`, limit (17th sensor; a layer
  /// of more than 4 MiB).
  [[nodiscard]] Status send(const OutgoingSweep& sweep);

  /// Asks the strategy what the next sweeps may take: once an interval, before they are encoded.
  [[nodiscard]] LinkBudget choose();
  [[nodiscard]] SenderStatus status() const;

  /// Waits until everything has left and arrived, or was dropped at its deadline.
  void finish();

 private:
  struct State;
  explicit Sender(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// A sweep that arrived.
struct ReceivedSweep {
  std::string_view robot;
  std::string_view sensor;
  std::string_view name;             ///< of its source; may be empty
  std::span<const std::byte> frame;  ///< whole, with its sensor's model, of the layers that arrived
  int layers = 0;                    ///< that arrived in time
  int layers_made = 0;               ///< that the frame had at the sender
  /// Seconds from capture to now. Clocks need not agree: half of the round trip is taken for what
  /// the fastest packet took.
  double age_s = 0;
};

struct ReceiverOptions {
  std::string address = "127.0.0.1";  ///< to listen at; "0.0.0.0" is every interface
  std::uint16_t port = 0;             ///< 0: any that is free
  std::vector<LinkKey> keys;
  /// Called for each sweep, a sensor's in order, in the receiver's thread: be quick.
  std::function<void(const ReceivedSweep&)> on_sweep;
  std::size_t most_peers = 64;
  std::size_t most_bytes_per_peer = std::size_t{8} << 20;  ///< of sweeps that are not yet whole
  std::size_t most_bytes = std::size_t{64} << 20;          ///< ... of all peers together
};

struct ReceiverStatus {
  std::size_t peers = 0;  ///< connected and authenticated
  std::uint64_t connections = 0;
  std::uint64_t connections_refused = 0;  ///< no key, wrong key, too many peers
  std::uint64_t sweeps_whole = 0;
  std::uint64_t sweeps_cut = 0;     ///< delivered with fewer layers than sent
  std::uint64_t sweeps_missed = 0;  ///< begun, and not one layer was whole in time
  std::uint64_t packets = 0;        ///< authentic fragments
  std::uint64_t bytes = 0;
  std::uint64_t packets_forged = 0;
  std::uint64_t packets_replayed = 0;
  std::uint64_t packets_malformed = 0;  ///< also truncated and oversized ones
  std::uint64_t packets_late = 0;       ///< of a sweep that was over
  std::uint64_t packets_over_limit = 0;
  std::size_t buffered_bytes = 0;
  double newest_age_s = 0;  ///< of the sweep that was delivered last, when it was
};

/// A robot that has connected since the receiver's start.
struct RobotStatus {
  std::string robot;
  bool connected = false;
  std::optional<SenderReport> report;  ///< the newest; none where its sender tells nothing
};

/// Receives from many robots.
class Receiver {
 public:
  /// Errors: invalid_argument (no key, no address), io (the port is taken), unsupported.
  [[nodiscard]] static Result<Receiver> start(ReceiverOptions options);

  Receiver(Receiver&&) noexcept;
  Receiver& operator=(Receiver&&) noexcept;
  /// Closes all connections; no callback runs any more when it returns.
  ~Receiver();

  [[nodiscard]] std::uint16_t port() const noexcept;
  [[nodiscard]] ReceiverStatus status() const;
  /// By name.
  [[nodiscard]] std::vector<RobotStatus> robots() const;

  /// Asks a robot to send all sweeps at a level, 0 to 5, or, with none, as its strategy chooses.
  /// Holds until it is asked for something else, across connections, while this receiver lives.
  /// Errors: invalid_argument (no such level; no robot that is connected and obeys).
  [[nodiscard]] Status ask_level(std::string_view robot, std::optional<std::size_t> level);

 private:
  struct State;
  explicit Receiver(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace sweepcast
