#include "codec/beam/point_order.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "codec/beam/integer_coder.hpp"
#include "codec/beam/point_schedule.hpp"
#include "codec/entropy/mixer.hpp"
#include "codec/entropy/range_coder.hpp"
#include "core/bytes.hpp"

namespace sweepcast::beam {
namespace {

// Which of a list of places are still free; counts them quickly (a Fenwick tree).
class FreePlaces {
 public:
  explicit FreePlaces(const std::vector<bool>& free) : free_(free), sums_(free.size() + 1, 0) {
    for (std::size_t i = 1; i < sums_.size(); ++i) {
      sums_[i] += free[i - 1] ? 1 : 0;
      total_ += free[i - 1] ? 1 : 0;
      const std::size_t above = i + (i & (~i + 1));
      if (above < sums_.size()) sums_[above] += sums_[i];
    }
  }

  [[nodiscard]] std::int64_t total() const { return total_; }
  [[nodiscard]] std::size_t size() const { return free_.size(); }
  [[nodiscard]] bool is_free(std::size_t place) const { return free_[place]; }

  /// How many are free before a place.
  [[nodiscard]] std::int64_t before(std::size_t place) const {
    std::int64_t sum = 0;
    for (std::size_t i = place; i > 0; i &= i - 1) sum += sums_[i];
    return sum;
  }

  /// The free place before which `rank` others are free; `rank` must be below `total()`.
  [[nodiscard]] std::size_t at(std::int64_t rank) const {
    std::size_t place = 0;
    for (std::size_t step = std::bit_floor(sums_.size()); step > 0; step /= 2) {
      if (place + step >= sums_.size() || sums_[place + step] > rank) continue;
      place += step;
      rank -= sums_[place];
    }
    return place;
  }

  void take(std::size_t place) {
    free_[place] = false;
    --total_;
    for (std::size_t i = place + 1; i < sums_.size(); i += i & (~i + 1)) --sums_[i];
  }

 private:
  std::vector<bool> free_;
  std::vector<std::int32_t> sums_;
  std::int64_t total_ = 0;
};

// Walks through a list of places. The next is coded as the number of free ones passed over.
class Walk {
 public:
  explicit Walk(const std::vector<bool>& free) : free_(free) {}

  // Codes the next place; decoding, `truth` is not used. Nothing where there is no such place.
  template <class Coder>
  std::optional<std::size_t> code(Coder& coder, IntegerCoder& numbers, std::uint32_t context,
                                  std::size_t truth) {
    const std::int64_t here = free_.before(next_);
    const std::int64_t passed =
        numbers.code(coder, truth < free_.size() ? free_.before(truth) - here : 0, context);
    if (passed < -here || passed >= free_.total() - here) return std::nullopt;
    const std::size_t place = free_.at(here + passed);
    free_.take(place);
    next_ = place + 1;
    return place;
  }

  // Whether the very next place is taken or was never free.
  [[nodiscard]] bool next_is_empty() const { return next_ < free_.size() && !free_.is_free(next_); }
  void pass_one() { ++next_; }

 private:
  FreePlaces free_;
  std::size_t next_ = 0;  // the place after the last
};

// Both directions of an order's items. `Coder` is RangeEncoder or RangeDecoder.
template <class Coder>
class OrderCoder {
 public:
  OrderCoder(Coder& coder, const BeamImage& image, std::size_t extras, bool keeps_slots,
             std::vector<std::uint32_t> cells)
      : coder_(coder),
        cells_(std::move(cells)),
        extras_(extras),
        keeps_slots_(keeps_slots),
        place_of_(cells_.size()),
        in_cells_(free_cells(image)),
        in_extras_(std::vector<bool>(extras, true)) {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      place_of_[cells_[i]] = static_cast<std::uint32_t>(i);
    }
  }

  // Codes the next item; decoding, `truth` is not used. Nothing where the bytes make no order.
  std::optional<std::uint32_t> code(std::uint32_t truth) {
    if (keeps_slots_) {
      const bool empty = in_cells_.next_is_empty();
      if (decide(empty ? 1 : 0, truth == PointOrder::kDropped)) {
        if (empty) in_cells_.pass_one();
        return PointOrder::kDropped;
      }
    }
    const bool is_extra = truth >= cells_.size();
    if (extras_ > 0 && (cells_.empty() || decide(2, is_extra))) {
      const auto extra = in_extras_.code(coder_, numbers_, 0, truth - cells_.size());
      if (!extra) return std::nullopt;
      return static_cast<std::uint32_t>(cells_.size() + *extra);
    }
    if (cells_.empty()) return std::nullopt;
    const auto place = in_cells_.code(coder_, numbers_, 1, is_extra ? 0 : place_of_[truth]);
    if (!place) return std::nullopt;
    return cells_[*place];
  }

 private:
  [[nodiscard]] std::vector<bool> free_cells(const BeamImage& image) const {
    std::vector<bool> free(cells_.size());
    for (std::size_t i = 0; i < cells_.size(); ++i) free[i] = image.range[cells_[i]] != 0;
    return free;
  }

  bool decide(std::uint32_t question, bool truth) {
    const bool answer = mixer_.code(
        coder_, {hash_context(question, history_ & 7U), hash_context(question, history_ & 0xFFFU)},
        question, truth);
    history_ = history_ * 2 + (answer ? 1U : 0U);
    return answer;
  }

  Coder& coder_;
  std::vector<std::uint32_t> cells_;
  std::size_t extras_;
  bool keeps_slots_;
  std::vector<std::uint32_t> place_of_;  // by cell: where it stands in `cells_`
  Walk in_cells_, in_extras_;
  IntegerCoder numbers_;
  BitMixer<2> mixer_{14, 4};
  std::uint32_t history_ = 0;
};

std::size_t count_points(const BeamImage& image, std::size_t extras) {
  if (image.cols == 0) return extras;
  const auto empty = std::count(image.range.begin(), image.range.end(), 0);
  return extras + image.cells() - static_cast<std::size_t>(empty);
}

}  // namespace

void firing_order(const BeamImage& image, std::vector<std::uint32_t>& next,
                  std::vector<std::uint32_t>& slots) {
  const auto cols = static_cast<std::size_t>(image.cols);
  const std::size_t cells = cols > 0 ? image.cells() : 0;
  next.assign(cols + 1, 0);
  for (std::size_t row = 0; row < cells; row += cols) {
    for (std::size_t col = 0; col < cols; ++col) {
      next[col + 1] += image.range[row + col] != 0 ? 1U : 0U;
    }
  }
  for (std::size_t col = 0; col < cols; ++col) next[col + 1] += next[col];
  const std::size_t before = slots.size();
  std::size_t count = before;
  slots.resize(before + next[cols] + 1);  // room for one that is taken back
  for (std::size_t row = 0; row < cells; row += cols) {
    for (std::size_t col = 0; col < cols; ++col) {
      const bool has_point = image.range[row + col] != 0;
      slots[count] = next[col];
      next[col] += has_point ? 1U : 0U;
      count += has_point ? 1U : 0U;
    }
  }
  slots.resize(count);
}

PointOrder original_order(std::size_t points, std::uint32_t width, const BeamImage& image,
                          std::span<const std::uint32_t> extras) {
  PointOrder order;
  order.items.assign(points, PointOrder::kDropped);
  const std::size_t cells = image.cols > 0 ? image.cells() : 0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    if (image.range[cell] != 0) order.items[image.point[cell]] = static_cast<std::uint32_t>(cell);
  }
  for (std::size_t i = 0; i < extras.size(); ++i) {
    order.items[extras[i]] = static_cast<std::uint32_t>(cells + i);
  }
  if (width > 0 && points % width == 0) {
    order.width = width;
  } else {
    const auto dropped = std::remove(order.items.begin(), order.items.end(), PointOrder::kDropped);
    order.items.erase(dropped, order.items.end());
  }
  return order;
}

void slots_of(const PointOrder& order, const BeamImage& image, std::size_t extras,
              std::vector<std::uint32_t>& slots) {
  const std::size_t cells = image.cols > 0 ? image.cells() : 0;
  std::vector<std::uint32_t> slot(cells + extras, 0);
  for (std::size_t i = 0; i < order.items.size(); ++i) {
    if (order.items[i] != PointOrder::kDropped)
      slot[order.items[i]] = static_cast<std::uint32_t>(i);
  }
  for (std::size_t item = 0; item < slot.size(); ++item) {
    if (item >= cells || image.range[item] != 0) slots.push_back(slot[item]);
  }
}

void write_order(const PointOrder& order, const BeamImage& image, std::size_t extras,
                 std::vector<std::byte>& out) {
  ByteWriter head(out);
  head.put_varint(order.items.size());
  head.put_varint(order.width);
  std::vector<std::uint32_t> cells;
  if (image.cols > 0) {
    const Schedule schedule = schedule_of(order, image);
    write_schedule(schedule, head);
    cells = cells_in_order(schedule, static_cast<std::uint32_t>(image.cols));
  }
  RangeEncoder coder(out);
  OrderCoder<RangeEncoder> items(coder, image, extras, order.width > 0, std::move(cells));
  for (const std::uint32_t item : order.items) (void)items.code(item);
  coder.finish();
}

bool read_order(std::span<const std::byte> bytes, const BeamImage& image, std::size_t extras,
                std::size_t most, PointOrder& order) {
  ByteReader head(bytes);
  const std::uint64_t count = head.get_varint(most);
  order.width = static_cast<std::uint32_t>(head.get_varint(most));
  if (!head.ok() || (order.width > 0 && count % order.width != 0)) return false;
  std::size_t points = count_points(image, extras);
  if (order.width > 0 ? count < points : count != points) return false;
  std::vector<std::uint32_t> cells;
  if (image.cols > 0) {
    const auto cols = static_cast<std::uint32_t>(image.cols);
    Schedule schedule;
    if (!read_schedule(head, static_cast<std::uint32_t>(image.rows), cols, schedule)) return false;
    cells = cells_in_order(schedule, cols);
  }
  RangeDecoder coder(head.get_bytes(head.remaining()));
  OrderCoder<RangeDecoder> items(coder, image, extras, order.width > 0, std::move(cells));
  order.items.resize(count);
  for (std::uint32_t& item : order.items) {
    if (coder.overran()) return false;
    const auto decoded = items.code(0);
    if (!decoded) return false;
    item = *decoded;
    if (item != PointOrder::kDropped) --points;
  }
  return points == 0 && !coder.overran();
}

}  // namespace sweepcast::beam
