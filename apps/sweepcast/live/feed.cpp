#include "sweepcast/live/feed.hpp"

#include <algorithm>
#include <utility>

#include "common/interruption.hpp"

namespace sweepcast::app {
namespace {

constexpr std::size_t kMostName = 64;  // bytes of a source's name, see OutgoingSweep
constexpr std::size_t kMostTarget = std::size_t{1} << 24;

}  // namespace

Result<Feed> Feed::open(FeedOptions options) {
  Feed feed(std::move(options));
  auto source = open_source(feed.options_.input);
  if (!source) return tl::unexpected(source.error());
  feed.source_ = std::move(*source);
  if (!feed.source_->gives_clouds() && feed.options_.allow_override) {
    return fail(ErrorCode::invalid_argument,
                feed.options_.input +
                    ": its frames are made already, at whatever level, so nobody can ask for "
                    "another; give a folder of clouds, or leave out --allow-override");
  }
  const std::string& strategy = feed.options_.strategy;
  if (!feed.source_->gives_clouds() && strategy != "budget" && !strategy.starts_with("fixed")) {
    return fail(ErrorCode::invalid_argument,
                feed.options_.input + ": its frames are made already, and --strategy " + strategy +
                    " chooses levels to make them at; give a folder of clouds, or take budget");
  }
  return feed;
}

Result<bool> Feed::next() {
  auto there = source_->next(sweep_);
  if (there && !*there && options_.loop && !stop_requested() && source_->rewind()) {
    there = source_->next(sweep_);
  }
  if (there && *there) ++count_;
  return there;
}

Result<OutgoingSweep> Feed::make(const LinkBudget& budget) {
  OutgoingSweep out;
  out.sensor = options_.sensor;
  out.name = std::string_view(sweep_.name).substr(0, kMostName);
  out.frame = sweep_.frame;
  out.most_bytes = budget.sweep_bytes;
  if (!source_->gives_clouds()) return out;
  out.level = budget.level;
  const auto frame = budget.level ? at_level(*budget.level) : fit(budget.sweep_bytes);
  if (!frame) return tl::unexpected(frame.error());
  out.frame = *frame;
  out.most_bytes = budget.level ? 0 : std::max(budget.sweep_bytes, least_bytes_);
  return out;
}

Result<std::span<const std::byte>> Feed::full() {
  if (!source_->gives_clouds()) return std::span<const std::byte>(sweep_.frame);
  return encode(full_, {});
}

/// Makes the encoder if need be.
Result<std::span<const std::byte>> Feed::encode(std::optional<Encoder>& encoder,
                                                const EncoderOptions& how) {
  if (!encoder) {
    auto made = Encoder::create(how);
    if (!made) return tl::unexpected(made.error());
    encoder = std::move(*made);
  }
  const auto stamp = static_cast<double>(count_ - 1) * 1e9 / options_.rate_hz;
  auto frame = encoder->encode(sweep_.cloud,
                               {count_ - 1, static_cast<std::int64_t>(stamp), options_.sensor});
  if (frame) return frame;
  return fail(frame.error().code, sweep_.name + ": " + frame.error().message);
}

/// A sweep that does not fit its budget even at its coarsest is allowed more, of which the link
/// then takes the layers that it can carry.
Result<std::span<const std::byte>> Feed::fit(std::size_t bytes) {
  EncoderOptions how = options_.encoder;
  for (std::size_t target = std::max({bytes, least_bytes_, std::size_t{1}});; target *= 2) {
    how.beam.target_bytes = target;
    if (fitting_) {
      if (Status set = fitting_->set_target_bytes(target); !set) return tl::unexpected(set.error());
    }
    auto frame = encode(fitting_, how);
    if (frame || frame.error().code != ErrorCode::limit || target > kMostTarget) {
      least_bytes_ = target > bytes ? target - target / 10 : 0;
      return frame;
    }
  }
}

Result<std::span<const std::byte>> Feed::at_level(std::size_t level) {
  level = std::min(level, kLevels - 1);
  EncoderOptions how = options_.encoder;
  how.beam.level = static_cast<int>(level);
  how.rcpcc.params = kRcpccLevels.at(level);
  // Encoders do not know of each other's sensor model, so every frame has its own; the sender
  // leaves it out where the receiver has it.
  how.beam.model_interval = 1;
  return encode(levels_.at(level), how);
}

}  // namespace sweepcast::app
