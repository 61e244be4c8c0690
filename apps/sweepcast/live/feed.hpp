// A sensor of `send`: where its sweeps come from, and the frames that are made of them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "rate/qoe.hpp"
#include "sweepcast/encoder.hpp"
#include "sweepcast/link.hpp"
#include "sweepcast/live/sweep_source.hpp"

namespace sweepcast::app {

struct FeedOptions {
  std::string input;  ///< see `open_source`
  std::string sensor;
  EncoderOptions encoder;  ///< of clouds, but for their quality
  std::string strategy;
  double rate_hz = 10.0;
  bool loop = false;
  bool allow_override = false;  ///< levels may be asked for
};

class Feed {
 public:
  /// Errors: those of `open_source`; invalid_argument (levels are to be chosen or asked for, where
  /// frames are made already).
  [[nodiscard]] static Result<Feed> open(FeedOptions options);

  /// Goes to the next sweep. False where there is none. Errors: those of `SweepSource::next`.
  [[nodiscard]] Result<bool> next();

  /// The sweep to send, of which `budget` is all that this sensor may spend. `captured` is left to
  /// the caller. Errors: those of the encoder, with the sweep's name.
  [[nodiscard]] Result<OutgoingSweep> make(const LinkBudget& budget);

  /// The sweep at full quality, for a recording. Errors: as `make`.
  [[nodiscard]] Result<std::span<const std::byte>> full();

  [[nodiscard]] const std::string& name() const { return sweep_.name; }

 private:
  explicit Feed(FeedOptions options) : options_(std::move(options)) {}
  [[nodiscard]] Result<std::span<const std::byte>> encode(std::optional<Encoder>& encoder,
                                                          const EncoderOptions& how);
  [[nodiscard]] Result<std::span<const std::byte>> fit(std::size_t bytes);
  [[nodiscard]] Result<std::span<const std::byte>> at_level(std::size_t level);

  FeedOptions options_;
  std::unique_ptr<SweepSource> source_;
  SourceSweep sweep_;
  std::uint64_t count_ = 0;
  // Made when they are first needed.
  std::optional<Encoder> fitting_, full_;
  std::array<std::optional<Encoder>, kLevels> levels_;
  std::size_t least_bytes_ = 0;  ///< what sweeps took lately at their coarsest
};

}  // namespace sweepcast::app
