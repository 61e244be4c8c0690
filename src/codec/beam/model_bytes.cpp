#include "codec/beam/model_bytes.hpp"

#include <algorithm>
#include <array>

#include "codec/entropy/range_coder.hpp"

namespace sweepcast::beam {
namespace {

constexpr std::array kNumbers = {&Beam::tan_elevation,  &Beam::height, &Beam::azimuth_offset,
                                 &Beam::lateral_offset, &Beam::lag,    &Beam::time_offset,
                                 &Beam::interpolated};

void write_mount(const Mount& mount, ByteWriter& out) {
  for (const std::int32_t v : mount.translation) out.put_signed(v);
  for (const std::int32_t v : mount.rotation) out.put_signed(v);
}

void read_mount(ByteReader& in, Mount& mount) {
  for (std::int32_t& v : mount.translation) v = static_cast<std::int32_t>(in.get_signed());
  for (std::int32_t& v : mount.rotation) v = static_cast<std::int32_t>(in.get_signed());
}

}  // namespace

void write_model(const SensorModel& model, ByteWriter& out) {
  out.put_varint(static_cast<std::uint64_t>(model.ticks_per_turn));
  out.put_signed(model.direction);
  out.put_varint(static_cast<std::uint64_t>(model.jitter));
  write_mount(model.mount, out);
  out.put_varint(model.beams.size());
  for (const auto number : kNumbers) {
    const std::int32_t first = model.beams.empty() ? 0 : model.beams.front().*number;
    const bool all_alike = std::all_of(model.beams.begin(), model.beams.end(),
                                       [&](const Beam& beam) { return beam.*number == first; });
    out.put(static_cast<std::uint8_t>(all_alike ? 1 : 0));
    std::int64_t last = 0;
    for (const Beam& beam : model.beams) {
      out.put_signed(beam.*number - last);
      last = beam.*number;
      if (all_alike) break;
    }
  }
}

bool read_model(ByteReader& in, SensorModel& model) {
  model.ticks_per_turn = static_cast<std::int32_t>(in.get_varint(kMaxTicks));
  model.direction = static_cast<std::int32_t>(in.get_signed());
  model.jitter = static_cast<std::int32_t>(in.get_varint(kMaxTicks));
  read_mount(in, model.mount);
  model.beams.resize(in.get_varint(kMaxBeams));
  for (const auto number : kNumbers) {
    const bool all_alike = in.get<std::uint8_t>() != 0;
    std::int64_t last = 0;
    for (Beam& beam : model.beams) {
      const bool listed = !all_alike || &beam == &model.beams.front();
      const std::int64_t difference = listed ? in.get_signed() : 0;
      if (difference > 0xFFFFFFFFLL || difference < -0xFFFFFFFFLL) return false;
      last += difference;
      if (last > 0x7FFFFFFFLL || last < -0x7FFFFFFFLL) return false;
      beam.*number = static_cast<std::int32_t>(last);
    }
  }
  return in.ok() && check(model).has_value();
}

void write_motion(const Motion& motion, ByteWriter& out) {
  for (const std::int32_t v : motion.translation) out.put_signed(v);
  for (const std::int32_t v : motion.rotation) out.put_signed(v);
  out.put_varint(static_cast<std::uint64_t>(motion.zero_tick));
  out.put_signed(motion.nod);
  write_mount(motion.mount, out);
}

Motion read_motion(ByteReader& in) {
  Motion motion;
  for (std::int32_t& v : motion.translation) v = static_cast<std::int32_t>(in.get_signed());
  for (std::int32_t& v : motion.rotation) v = static_cast<std::int32_t>(in.get_signed());
  motion.zero_tick = static_cast<std::int32_t>(in.get_varint(kMaxTicks));
  motion.nod = static_cast<std::int32_t>(in.get_signed());
  read_mount(in, motion.mount);
  return motion;
}

// In unary while small, then by plain bits.
template <class Coder>
std::uint32_t FiringCoder::code(Coder& coder, std::uint32_t step) {
  std::uint32_t value = 0;
  while (value < kUnary) {
    const BitMixer<3>::Contexts contexts{hash_context(last_[0] * 32U + last_[1], value),
                                         hash_context(history_, 100U + value),
                                         hash_context(last_[5] * 32U + last_[0], 200U + value)};
    if (!mixer_.code(coder, contexts, 0, step > value)) break;
    ++value;
  }
  if (value == kUnary) {
    std::uint32_t rest = 0;
    for (int bit = 20; bit-- > 0;) {
      const bool set = (((step - kUnary) >> bit) & 1U) != 0;
      rest = rest * 2 + (coder.code(set, 32768) ? 1U : 0U);
    }
    value += rest;
  }
  std::copy_backward(last_.begin(), last_.end() - 1, last_.end());
  last_[0] = std::min(value, 31U);
  history_ = history_ * 4U + std::min(value, 3U);
  return value;
}

// Packets have equally many firings, so that what comes next follows from the last dozen.
template <class Coder>
bool FiringCoder::code_hold(Coder& coder, bool held) {
  const BitMixer<3>::Contexts contexts{hash_context(holds_ & 7U, 1U),
                                       hash_context(holds_ & 0xFFFU, 2U), 0U};
  const bool result = hold_mixer_.code(coder, contexts, 0, held);
  holds_ = holds_ * 2U + (result ? 1U : 0U);
  return result;
}

void FiringCoder::reset() {
  mixer_.reset();
  last_.fill(0);
  history_ = 0;
  hold_mixer_.reset();
  holds_ = 0;
}

void FiringCoder::write(std::span<const std::int32_t> ticks, std::vector<std::byte>& out,
                        std::span<const std::uint8_t> held) {
  reset();
  RangeEncoder coder(out);
  std::int32_t last = -1;
  for (std::size_t j = 0; j < ticks.size(); ++j) {
    code(coder, static_cast<std::uint32_t>(ticks[j] - last - 1));
    if (!held.empty()) code_hold(coder, held[j] != 0);
    last = ticks[j];
  }
  coder.finish();
}

bool FiringCoder::read(std::span<const std::byte> bytes, std::int32_t ticks_per_turn,
                       std::span<std::int32_t> ticks, std::span<std::uint8_t> held) {
  reset();
  RangeDecoder coder(bytes);
  std::int64_t last = -1;
  for (std::size_t j = 0; j < ticks.size(); ++j) {
    last += std::int64_t{code(coder, 0)} + 1;
    if (last >= ticks_per_turn || coder.overran()) return false;
    ticks[j] = static_cast<std::int32_t>(last);
    if (!held.empty()) held[j] = code_hold(coder, false) ? 1 : 0;
  }
  return !coder.overran();
}

}  // namespace sweepcast::beam
