#include "codec/beam/prediction.hpp"

#include <algorithm>
#include <utility>

#include "core/cpu.hpp"

namespace sweepcast::beam {
namespace {

constexpr std::int32_t kTypical = 150'000;  // 15 m, where nothing is known yet

// 2^24 / range, by range / 2048.
constexpr auto kReciprocal = [] {
  std::array<std::int32_t, 1024> table{};
  for (std::int32_t i = 0; i < 1024; ++i) {
    table[static_cast<std::size_t>(i)] = 16'384 / (2 * i + 1);
  }
  return table;
}();

// 1 + 3 log2(1 + 4 m) of a mean activity m in tenths, 0 to 15; 0 only for 0.
constexpr auto kMeanLevel = [] {
  std::array<std::int32_t, 201> table{};
  for (int i = 1; i < 201; ++i) {
    // (1 + 4 i / 10)^3 >= 2^level
    const std::int64_t cube = std::int64_t{10 + 4 * i} * (10 + 4 * i) * (10 + 4 * i);
    std::int32_t level = 1;
    while (level < 15 && cube >= (std::int64_t{1'000} << level)) ++level;
    table[static_cast<std::size_t>(i)] = level;
  }
  return table;
}();

// Two levels for each doubling of the distance, by range / 8192.
constexpr auto kFarLevel = [] {
  std::array<std::int32_t, 256> table{};
  for (int i = 0; i < 256; ++i) {
    std::int32_t level = 0;
    while (level < 15 && (i + 1) * (i + 1) >= (2 << level)) ++level;
    table[static_cast<std::size_t>(i)] = level;
  }
  return table;
}();

// The functions below are for one cell and without branches, so that loops over them vectorise,
// with whatever instructions the function around them may use.

[[gnu::always_inline]] inline std::int32_t magnitude(std::int32_t v) {
  return v < 0 ? -v : v;
}

// 1 where v is above 0; v must not be the lowest integer.
[[gnu::always_inline]] inline std::int32_t is_positive(std::int32_t v) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(-v) >> 31);
}

// Loops over levels are spelt out: compilers vectorise no loop around a loop.
using Levels = std::make_index_sequence<PredictionScale::kLevels>;

// Where cells' numbers stand.
template <class Number>
struct PredictionRows {
  explicit PredictionRows(auto& of)
      : range(of.range.data()),
        carried(of.carried.data()),
        spread(of.spread.data()),
        basis(of.basis.data()) {}
  Number *range, *carried, *spread, *basis;
};

struct ContextRows {
  explicit ContextRows(Contexts& contexts)
      : mean(contexts.mean.data()), turned(contexts.turned.data()) {
    for (std::size_t k = 0; k < of.size(); ++k) of[k] = contexts.of[k].data();
  }
  std::array<std::int32_t*, Contexts::kCount> of{};
  std::int32_t *mean, *turned;
};

template <std::size_t... K>
[[gnu::always_inline]] inline std::int32_t level_of(std::int32_t size, const PredictionScale& scale,
                                                    std::index_sequence<K...> /*levels*/) {
  return (... + (size >= scale.from[K] ? 1 : 0));
}
[[gnu::always_inline]] inline std::int32_t level_of(std::int32_t size,
                                                    const PredictionScale& scale) {
  return level_of(size, scale, Levels{});
}

template <std::size_t... K>
[[gnu::always_inline]] inline std::int32_t share_of(std::int32_t failure,
                                                    const PredictionScale& scale,
                                                    std::index_sequence<K...> /*levels*/) {
  return (... + (failure >= scale.from[K] ? scale.share[K] : 0));
}

// 0 to 9 for differences from 0 up, 10 to 19 for those below.
[[gnu::always_inline]] inline std::int32_t signed_level(std::int32_t difference,
                                                        const PredictionScale& scale) {
  return level_of(magnitude(difference), scale) + (difference < 0 ? 10 : 0);
}

// Linear interpolation; differences beyond 419 m count as that.
[[gnu::always_inline]] inline std::int32_t on_line(std::int32_t a, std::int32_t b,
                                                   std::int32_t weight) {
  constexpr std::int32_t kMost = 1 << 22;
  const std::int32_t apart = a - b;
  const std::int32_t clipped = apart > kMost ? kMost : apart < -kMost ? -kMost : apart;
  return b + ((clipped * weight) >> 8);
}

// By how much interpolation in inverse range, in which planes are linear, lies below interpolation
// in range: w (1 - w) (a - b)^2 / ((1 - w) a + w b). Differences beyond 16 m, or beyond 8 to 16
// times the range between, count as that: so products stay within 32 bits.
[[gnu::always_inline]] inline std::int32_t bow(std::int32_t a, std::int32_t b, std::int32_t middle,
                                               std::int32_t weight) {
  std::int32_t bin = middle >> 11;
  bin = bin < 0 ? 0 : bin < 1023 ? bin : 1023;
  const std::int32_t reach = (bin + 1) << 14;
  const std::int32_t most = reach < 160'000 ? reach : 160'000;
  const std::int32_t size = magnitude(a - b);
  const std::int32_t apart = (size < most ? size : most) >> 3;
  const std::int32_t reciprocal = kReciprocal[static_cast<std::size_t>(bin)];
  const std::int32_t ratio = (((apart * apart) >> 8) * reciprocal) >> 10;
  return (ratio * ((weight * (256 - weight)) >> 4)) >> 12;
}

[[gnu::always_inline]] inline void predict_cell(const Neighbours& at, const PredictionScale& levels,
                                                std::size_t i,
                                                const PredictionRows<std::int32_t>& out) {
  using N = Neighbours;
  const std::int32_t weight = at.weight;
  const std::int32_t edge = levels.edge;
  const std::int32_t a = at.range[N::a][i];
  const std::int32_t b = at.range[N::b][i];
  const std::int32_t n = at.range[N::n][i];
  const std::int32_t na = at.range[N::na][i];
  const std::int32_t nb = at.range[N::nb][i];
  const std::int32_t sa = at.range[N::sa][i];
  const std::int32_t sb = at.range[N::sb][i];
  const std::int32_t aa = at.range[N::aa][i];
  const std::int32_t bb = at.range[N::bb][i];
  const std::int32_t nn = at.range[N::nn][i];
  const std::int32_t near = at.range[N::near][i];
  const std::int32_t has_a = is_positive(a);
  const std::int32_t has_b = is_positive(b);
  const std::int32_t has_n = is_positive(n);
  const std::int32_t has_na = is_positive(na);
  const std::int32_t has_nb = is_positive(nb);

  // The line across carried on with the change seen beside it.
  const std::int32_t along_a = has_a & has_na;
  const std::int32_t along_b = has_b & has_nb;
  const std::int32_t change = (along_a != 0 ? a - na : 0) + (along_b != 0 ? b - nb : 0);
  const std::int32_t onward = n + ((along_a & along_b) != 0 ? change >> 1 : change);
  const std::int32_t carries = has_n & (along_a | along_b) & is_positive(onward - kNearest + 1);
  const std::int32_t carried = carries != 0 ? onward : 0;

  // Between both sides, blended with what is carried as far as interpolation failed across.
  const std::int32_t line = on_line(a, b, weight);
  const std::int32_t between = line - bow(a, b, line, weight);
  const std::int32_t failed = n - on_line(na, nb, weight);
  const std::int32_t failure = (has_n & has_na & has_nb) != 0 ? magnitude(failed) : levels.step;
  const std::int32_t share = share_of(failure, levels, Levels{});
  const std::int32_t pull = carried - between;
  const std::int32_t blends = carries & is_positive(edge - magnitude(pull));
  const std::int32_t blend = blends != 0 ? ((pull >> 2) * share) >> 6 : 0;

  // One side only: carried, or the line from beyond it.
  const std::int32_t side = a > 0 ? a : b;
  const std::int32_t beyond = a > 0 ? aa : bb;
  const std::int32_t fits_carried = carries & is_positive(edge - magnitude(carried - side));
  const std::int32_t fits_beyond =
      is_positive(beyond) & is_positive(edge - magnitude(beyond - side));
  const std::int32_t one =
      fits_carried != 0 ? carried : (fits_beyond != 0 ? 2 * side - beyond : side);

  // No side: from across, or anything near.
  std::int32_t guess = nn > 0 ? nn : kTypical;
  guess = near > 0 ? near : guess;
  guess = bb > 0 ? bb : guess;
  guess = aa > 0 ? aa : guess;
  guess = sb > 0 ? sb : guess;
  guess = sa > 0 ? sa : guess;
  guess = nb > 0 ? nb : guess;
  guess = na > 0 ? na : guess;

  const std::int32_t apart = magnitude(a - b);
  const std::int32_t two = has_a & has_b;
  const std::int32_t any = has_a | has_b;
  const std::int32_t jump = is_positive(apart - edge);
  const std::int32_t both = between + (jump != 0 ? 0 : blend);
  out.range[i] = two != 0 ? both : any != 0 ? one : n > 0 ? n : guess;
  out.carried[i] = carried;
  const std::int32_t spread_one = n > 0 ? magnitude(n - one) : edge;
  const std::int32_t spread_across = (has_n & is_positive(nn)) != 0 ? magnitude(n - nn) : edge;
  out.spread[i] = two != 0 ? apart : any != 0 ? spread_one : spread_across;
  out.basis[i] = two != 0 ? jump : any != 0 ? 3 : n > 0 ? 4 : 5;
}

template <bool kAll>
[[gnu::always_inline]] inline void describe_cell(const Neighbours& at,
                                                 const PredictionScale& levels,
                                                 const PredictionRows<const std::int32_t>& from,
                                                 std::size_t i, const ContextRows& out) {
  using N = Neighbours;
  const std::int32_t weight = at.weight;
  const std::int32_t a = at.range[N::a][i];
  const std::int32_t b = at.range[N::b][i];
  const std::int32_t n = at.range[N::n][i];
  const std::int32_t na = at.range[N::na][i];
  const std::int32_t nb = at.range[N::nb][i];
  const std::int32_t range = from.range[i];
  const std::int32_t carried = from.carried[i];
  const std::int32_t basis = from.basis[i];

  const std::int32_t activity =
      2 * (at.activity[N::a][i] + at.activity[N::b][i] + at.activity[N::n][i]) +
      at.activity[N::na][i] + at.activity[N::nb][i] + at.activity[N::sa][i] + at.activity[N::sb][i];
  const std::int32_t mean = kMeanLevel[static_cast<std::size_t>(activity)];
  const std::int32_t to_n = n > 0 ? signed_level(n - range, levels) : 20;
  const std::int32_t to_carried = carried > 0 ? signed_level(carried - range, levels) : 20;
  const std::int32_t has_a = is_positive(a);
  const std::int32_t has_b = is_positive(b);
  const std::int32_t across = is_positive(na) & is_positive(nb);
  const std::int32_t slope = (has_a & has_b) != 0 ? signed_level(a - b, levels) : 0;
  const std::int32_t slope_n = across != 0 ? level_of(magnitude(na - nb), levels) : 10;
  const std::int32_t bend =
      (across & is_positive(n)) != 0 ? signed_level(n - on_line(na, nb, weight), levels) : 20;
  const std::int32_t bin = range >> 13;
  const std::int32_t far = kFarLevel[static_cast<std::size_t>(bin < 0 ? 0 : bin < 255 ? bin : 255)];
  const std::int32_t firm = is_positive(basis);

  out.of[Contexts::trust][i] = (basis * 10 + level_of(from.spread[i], levels)) * 16 + mean;
  out.turned[i] = is_positive(n) & is_positive(range - n);
  if (!kAll) return;
  out.mean[i] = mean;
  out.of[Contexts::direction][i] =
      ((basis * 21 + to_n) * 2 + is_positive(a - range)) * 2 + is_positive(b - range);
  out.of[Contexts::slope][i] = ((firm * 21 + slope) * 21 + bend) * 11 + slope_n;
  out.of[Contexts::sides][i] = (basis * 21 + to_carried) * 21 + to_n;
  out.of[Contexts::distance][i] = ((firm * 16 + mean) * 21 + to_carried) * 16 + far;
}

// Loops over cells; what they use is copied, so that compilers see that no cell changes it.
[[gnu::always_inline]] inline void predict_cells(const Neighbours& neighbours,
                                                 const PredictionScale& scale, std::size_t count,
                                                 Predictions& out) {
  const Neighbours at = neighbours;
  const PredictionScale levels = scale;
  const PredictionRows<std::int32_t> rows(out);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) predict_cell(at, levels, i, rows);
}

template <bool kAll>
[[gnu::always_inline]] inline void describe_cells(const Neighbours& neighbours,
                                                  const PredictionScale& scale,
                                                  const Predictions& predictions, std::size_t count,
                                                  Contexts& out) {
  const Neighbours at = neighbours;
  const PredictionScale levels = scale;
  const PredictionRows<const std::int32_t> from(predictions);
  const ContextRows rows(out);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) describe_cell<kAll>(at, levels, from, i, rows);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void predict_avx2(const Neighbours& at, const PredictionScale& scale,
                                          std::size_t count, Predictions& out) {
  predict_cells(at, scale, count, out);
}
[[gnu::target("avx2")]] void describe_avx2(const Neighbours& at, const PredictionScale& scale,
                                           const Predictions& predictions, std::size_t count,
                                           bool all, Contexts& out) {
  if (all) {
    describe_cells<true>(at, scale, predictions, count, out);
  } else {
    describe_cells<false>(at, scale, predictions, count, out);
  }
}
#else
constexpr auto predict_avx2 = plain::predict;
constexpr auto describe_avx2 = plain::describe;
#endif

}  // namespace

void plain::predict(const Neighbours& at, const PredictionScale& scale, std::size_t count,
                    Predictions& out) {
  predict_cells(at, scale, count, out);
}

void plain::describe(const Neighbours& at, const PredictionScale& scale,
                     const Predictions& predictions, std::size_t count, bool all, Contexts& out) {
  if (all) {
    describe_cells<true>(at, scale, predictions, count, out);
  } else {
    describe_cells<false>(at, scale, predictions, count, out);
  }
}

void predict(const Neighbours& at, const PredictionScale& scale, std::size_t count,
             Predictions& out) {
  (has_avx2() ? predict_avx2 : plain::predict)(at, scale, count, out);
}

void describe(const Neighbours& at, const PredictionScale& scale, const Predictions& predictions,
              std::size_t count, bool all, Contexts& out) {
  (has_avx2() ? describe_avx2 : plain::describe)(at, scale, predictions, count, all, out);
}

void predict_one(const Neighbours& at, const PredictionScale& scale, std::size_t i,
                 Predictions& out) {
  predict_cell(at, scale, i, PredictionRows<std::int32_t>(out));
}

void describe_one(const Neighbours& at, const PredictionScale& scale,
                  const Predictions& predictions, std::size_t i, bool all, Contexts& out) {
  const PredictionRows<const std::int32_t> from(predictions);
  (all ? describe_cell<true> : describe_cell<false>)(at, scale, from, i, ContextRows(out));
}

void Predictions::resize(std::size_t count) {
  for (auto* column : {&range, &carried, &spread, &basis}) column->resize(count);
}

void Contexts::resize(std::size_t count) {
  for (auto& column : of) column.resize(count);
  mean.resize(count);
  turned.resize(count);
}

PredictionScale::PredictionScale(std::int32_t step_of_ranges)
    : step(step_of_ranges), edge(std::max(4'000, 4 * step_of_ranges)) {
  constexpr std::array<std::int64_t, kLevels> kEighths{2, 4, 8, 12, 20, 32, 56, 96, 192};
  const std::int64_t noise = step / 2 + 200;
  std::int64_t before = 0;
  for (std::size_t k = 0; k < kLevels; ++k) {
    from[k] = static_cast<std::int32_t>(std::max<std::int64_t>(1, kEighths[k] * step / 8));
    // Trust what is carried from across as far as interpolation failed there: 0.8 at most.
    const std::int64_t next = k + 1 < kLevels ? kEighths[k + 1] : 2 * kEighths[k];
    const std::int64_t failed = (kEighths[k] + next) * step / 16;
    const std::int64_t squared = failed * failed;
    const std::int64_t total = squared * 205 / (squared + 4 * noise * noise);  // 1/256
    share[k] = static_cast<std::int32_t>(total - before);
    before = total;
  }
}

}  // namespace sweepcast::beam
