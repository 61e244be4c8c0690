// The logistic domain, in integers: stretch(p) = ln(p / (1 - p)) and its inverse.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sweepcast {

/// 256 is one unit of the logistic domain; values lie in [-2047, 2047], that is +-8.
inline constexpr int kLogisticOne = 256;
inline constexpr int kLogisticLimit = 2047;

namespace logistic_detail {

// e^x for |x| <= 8, from + - * / alone, so that every compiler makes the same tables.
constexpr double exponential(double x) {
  const double part = x / 256.0;
  double sum = 1.0;
  for (int k = 12; k >= 1; --k) sum = 1.0 + part / k * sum;
  for (int i = 0; i < 8; ++i) sum *= sum;
  return sum;
}

constexpr std::array<std::uint16_t, 4096> make_squash() {
  std::array<std::uint16_t, 4096> table{};
  for (int i = 0; i < 4096; ++i) {
    const double p = 65536.0 / (1.0 + exponential(-(i - 2048) / double{kLogisticOne}));
    table[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(p < 24.0      ? 24.0
                                                                    : p > 65512.0 ? 65512.0
                                                                                  : p);
  }
  return table;
}

constexpr std::array<std::int16_t, 4096> make_stretch(
    const std::array<std::uint16_t, 4096>& squash) {
  std::array<std::int16_t, 4096> table{};
  std::size_t x = 2048 - kLogisticLimit;
  for (std::size_t p = 0; p < table.size(); ++p) {
    while (x < 2048 + kLogisticLimit && squash[x] < p * 16 + 8) ++x;
    table[p] = static_cast<std::int16_t>(static_cast<int>(x) - 2048);
  }
  return table;
}

inline constexpr auto kSquash = make_squash();
inline constexpr auto kStretch = make_stretch(kSquash);

// ln(1 + e^x) is the integral of 1 / (1 + e^-x); in 1/65536 of the logistic domain's units.
constexpr std::array<std::uint32_t, 4096> make_softplus() {
  std::array<std::uint32_t, 4096> table{};
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    sum += kSquash[i];
    table[i] = sum;
  }
  return table;
}

inline constexpr auto kSoftplus = make_softplus();

constexpr std::array<std::int16_t, 2048> make_softplus_inverse() {
  std::array<std::int16_t, 2048> table{};
  std::size_t x = 0;
  for (std::uint32_t y = 0; y < 2048; ++y) {
    while (x < 4095 && kSoftplus[x] < (y << 16)) ++x;
    table[y] = static_cast<std::int16_t>(static_cast<int>(x) - 2048);
  }
  return table;
}

inline constexpr auto kSoftplusInverse = make_softplus_inverse();

}  // namespace logistic_detail

/// 1/65536 of probability -> logistic domain. Exact to 1/4096 of probability.
[[nodiscard]] inline int stretch(std::uint32_t p) {
  return logistic_detail::kStretch[p >> 4];
}

/// Logistic domain -> 1/65536 of probability, in [24, 65512]; values outside the domain are
/// clipped.
[[nodiscard]] inline std::uint32_t squash(int x) {
  const int clipped = x > kLogisticLimit    ? kLogisticLimit
                      : x < -kLogisticLimit ? -kLogisticLimit
                                            : x;
  const auto index = static_cast<std::size_t>(2048) + static_cast<std::size_t>(clipped);
  return logistic_detail::kSquash[index];
}

/// ln(1 + e^x) of the logistic domain.
[[nodiscard]] inline int softplus(int x) {
  if (x > kLogisticLimit) return x;
  if (x < -kLogisticLimit) return 0;
  const auto index = static_cast<std::size_t>(2048 + x);
  return static_cast<int>(logistic_detail::kSoftplus[index] >> 16);
}

/// ln(e^y - 1) of the logistic domain, for y from 0 on; at least -2048.
[[nodiscard]] inline int softplus_inverse(int y) {
  return y > kLogisticLimit ? y : logistic_detail::kSoftplusInverse[static_cast<std::size_t>(y)];
}

}  // namespace sweepcast
