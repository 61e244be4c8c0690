// What the tests of the link share.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "codec/beam/sensor.hpp"
#include "link/fragment.hpp"
#include "link/key.hpp"
#include "link/trace.hpp"
#include "sweepcast/encoder.hpp"

namespace sweepcast::test {

using Bytes = std::vector<std::byte>;

/// A key whose secret is 0, 1, 2 ...
inline LinkKey counting_key(const std::string& robot) {
  LinkKey key;
  key.robot = robot;
  for (std::size_t i = 0; i < key.secret.size(); ++i) key.secret[i] = static_cast<std::uint8_t>(i);
  return key;
}

/// Two digits a byte.
inline std::string hex(std::span<const std::byte> bytes) {
  std::string out;
  for (const std::byte byte : bytes) {
    out += "0123456789abcdef"[std::to_integer<unsigned>(byte) / 16];
    out += "0123456789abcdef"[std::to_integer<unsigned>(byte) % 16];
  }
  return out;
}

inline Bytes bytes_of(std::size_t count, unsigned seed = 0) {
  Bytes bytes;
  for (std::size_t i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::byte>(i * 31 + seed * 7 + i / 256));
  }
  return bytes;
}

/// Frames of a small sensor's sweeps, five layers each; every `model_interval`-th has the model.
inline std::vector<Bytes> small_frames(int count, int model_interval = 10) {
  std::vector<Bytes> frames;
  auto encoder = Encoder::create(beam_options(0.05, model_interval));
  for (int i = 0; i < count; ++i) {
    const PointCloud cloud = spinning_sweep(16, 360, 7 + static_cast<unsigned>(i));
    const auto frame = encoder->encode(cloud, {static_cast<std::uint64_t>(i), 5, "roof"});
    frames.emplace_back(frame->begin(), frame->end());
  }
  return frames;
}

/// A frame of about 60 kB in five layers.
inline Bytes large_frame() {
  auto encoder = Encoder::create(beam_options(0.002, 1));
  const PointCloud cloud = spinning_sweep(64, 720, 3);
  const auto frame = encoder->encode(cloud, {0, 5, "roof"});
  return {frame->begin(), frame->end()};
}

/// A trace of one rate, bytes a second.
inline Trace steady_trace(double bytes_per_s) {
  Trace trace;
  trace.name = "steady";
  const double apart_us = 1500.0 / bytes_per_s * 1e6;
  for (double at = apart_us; at <= 1e6; at += apart_us) {
    trace.opportunities_us.push_back(static_cast<std::int64_t>(at));
  }
  trace.period_us = 1'000'000;
  return trace;
}

/// All fragments of one layer, in order; payloads refer to `layer`.
inline std::vector<link::Fragment> fragments_of(const Bytes& layer, std::uint32_t sweep,
                                                std::uint8_t number, std::uint8_t layers,
                                                std::uint8_t stream = 0) {
  std::vector<link::Fragment> fragments;
  for (std::size_t i = 0; i < link::fragment_count(layer.size()); ++i) {
    link::Fragment fragment;
    fragment.stream = stream;
    fragment.layer = number;
    fragment.layers = layers;
    fragment.sweep = sweep;
    fragment.index = static_cast<std::uint16_t>(i);
    fragment.layer_bytes = static_cast<std::uint32_t>(layer.size());
    fragment.remaining_ms = 100;
    const std::size_t size = std::min(link::kFragmentPayload, layer.size() - fragment.offset());
    fragment.payload = std::span(layer).subspan(fragment.offset(), size);
    fragments.push_back(fragment);
  }
  return fragments;
}

}  // namespace sweepcast::test
